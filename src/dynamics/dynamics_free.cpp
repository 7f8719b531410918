// What a solve says of groups of particles that nothing resists in some rigid motion (operator/free_motions.h).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/log.h"
#include "odpd/dynamics/dynamics.h"
#include "odpd/pairs/friction.h"

namespace odpd {

namespace {

// Of the forces' norm: what pair forces have along a null motion is rounding.
constexpr double no_work = 1e-9;
constexpr std::size_t most_named = 3;
constexpr const char* of_sdpd = " (of \"sdpd\" fluid.form = \"classical\" without fluid.spin)";

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
  const Resistance<D>& mobile = resistance_.velocities().mobile();
  if (mobile.null_motions().empty()) return;
  const auto told = [&](const FreeGroup& group) {
    return fmt::format("{} particles, among them particle {}, can {} ({} null motion(s) of R)",
                       group.particles, particles_.id[index(group.first)],
                       mobile.translations_are_null()
                           ? "turn as one"
                           : "move as one along what holds them, or turn about it",
                       group.motions);
  };
  const std::span<const FreeGroup> groups = mobile.free_groups();
  std::string who;
  for (const FreeGroup& group : groups.first(std::min(groups.size(), most_named)))
    who += (who.empty() ? "" : "; ") + told(group);
  if (groups.size() > most_named) who += fmt::format("; and {} more", groups.size() - most_named);
  const std::string why =
      motion_.dofs().any_spin()
          ? ", as friction of particles that turn with them does not resist that"
          : ", as friction along lines of centres does not resist that";
  if (box_.shear)
    throw SolverError(
        who + why +
            ", and under shear nothing says how fast they do. Cures: mass (fluid.mass) or " +
            transverse_cure + of_sdpd,
        SolverError::Cause::singular);
  const std::string others = std::string(", mass (fluid.mass) or ") + transverse_cure + of_sdpd;
  Unknowns f = force(stage);
  resistance_.scale_load(f);
  const Share share = motion_.dofs().share();
  const double least = no_work * norm_of_forces(f, share, stage.network);
  auto u = resistance_.system().null_motions().begin();  // group by group
  for (const FreeGroup& group : groups)
    for (const auto end = u + group.motions; u != end; ++u)
      if (std::abs(share.dot(*u, f, D)) > least)
        throw SolverError(
            told(group) + why +
                ", while forces from outside drive it: R v = f has no answer. Cures: a drag "
                "(fluid.zeta_0, with fluid.zeta_0_under_flow = true)" +
                others,
            SolverError::Cause::singular);
  if (told_null_motions_) return;
  told_null_motions_ = true;
  log_warning("solver: " + who + why +
              ". These motions stay out of v, as forces between particles do not drive them "
              "(docs/solvers.md). Where they should not: " +
              drag_cure + others);
}

template void Dynamics<2>::judge_null_motions(const Stage<2>&);
template void Dynamics<3>::judge_null_motions(const Stage<3>&);

}  // namespace odpd
