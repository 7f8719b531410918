// What a solve says of groups of particles that nothing resists in some rigid motion (operator/free_motions.h).
#include <fmt/format.h>

#include <cmath>
#include <span>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/log.h"
#include "odpd/dynamics/dynamics.h"

namespace odpd {

namespace {

// Of the forces' norm: what pair forces have along a null motion is rounding.
constexpr double no_work = 1e-9;

template <int D>
double norm_of_forces(std::span<const double> load, const Share& share,
                      const PairNetwork<D>& network) {
  double squares = 0.0;
  for (std::size_t k = 0; k < network.f_c.size(); ++k)
    if (network.counts(k)) squares += network.f_c[k] * network.f_c[k];
  return share.norm(load, D) + std::sqrt(share.ranks->sum(squares));
}

}  // namespace

/// Says once what the null motions are. Throws SolverError where R v = f has no answer, or none that is told from others.
template <int D>
void Dynamics<D>::judge_null_motions(const Stage<D>& stage) {
  const Resistance<D>& mobile = resistance_.mobile();
  if (mobile.null_motions().empty()) return;
  std::string who;
  for (const FreeGroup& group : mobile.free_groups())
    who += fmt::format("{}{} particles, among them particle {}, can {} ({} null motion(s) of R)",
                       who.empty() ? "" : "; ", group.particles, particles_.id[index(group.first)],
                       mobile.translations_are_null()
                           ? "turn as one"
                           : "move as one along what holds them, or turn about it",
                       group.motions);
  who += ", as friction along lines of centres does not resist that";
  if (box_.shear)
    throw SolverError(
        who +
            ", and under shear nothing says how fast they do. Cures: mass (fluid.mass) or friction "
            "across lines of centres (fluid.gamma_perp)",
        SolverError::Cause::singular);
  const std::string cures =
      "a drag (fluid.zeta_0), mass (fluid.mass) or friction across lines of centres "
      "(fluid.gamma_perp)";
  const Unknowns f = force(stage);
  const Share share = motion_.dofs().share();
  const double least = no_work * norm_of_forces(f, share, stage.network);
  for (const std::vector<double>& u : mobile.null_motions())
    if (std::abs(share.dot(u, f, D)) > least)
      throw SolverError(
          who + ", while forces from outside drive it: R v = f has no answer. Cures: " + cures,
          SolverError::Cause::singular);
  if (told_null_motions_) return;
  told_null_motions_ = true;
  log_warning("solver: " + who +
              ". These motions stay out of v, as forces between particles do not drive them "
              "(docs/solvers.md). Where they should not: " +
              cures);
}

template void Dynamics<2>::judge_null_motions(const Stage<2>&);
template void Dynamics<3>::judge_null_motions(const Stage<3>&);

}  // namespace odpd
