#include "odpd/pairs/mdpd.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "edge_kernels.h"
#include "odpd/core/isa.h"
#include "odpd/pairs/density_writer.h"

namespace odpd {

namespace {

// Of w_d^2 to the integral 1.
double density_norm(double r_d, int dimension) {
  return dimension == 2 ? 6.0 / (std::numbers::pi * r_d * r_d)
                        : 15.0 / (2.0 * std::numbers::pi * r_d * r_d * r_d);
}

const kernels::EdgeKernels& edge_kernels() {
  return for_isa(kernels::edge_portable, kernels::edge_avx2, kernels::edge_avx512);
}

std::vector<double> density_weights(const std::vector<MdpdPair>& pairs) {
  std::vector<double> b;
  for (const MdpdPair& pair : pairs) b.push_back(pair.b);
  return b;
}

}  // namespace

MdpdDensities::MdpdDensities(const MdpdFluid& fluid, int dimension, int species,
                             std::vector<double> b)
    : r_d_(fluid.r_d),
      norm_(density_norm(fluid.r_d, dimension)),
      c_(fluid.B * fluid.r_d / (4.0 * norm_)),
      species_(species),
      b_(std::move(b)) {}

template <int D>
MdpdModel<D>::MdpdModel(const MdpdFluid& fluid, int species, const std::vector<MdpdPair>& pairs,
                        double density)
    : fluid_(fluid),
      density_(density),
      species_(species),
      densities_(fluid, D, species, density_weights(pairs)),
      cutoff_(fluid.r_d) {
  require_pair_table(species, pairs);
  require_parameter(fluid.B >= 0.0, "B", fluid.B, "zero or positive");
  require_parameter(fluid.r_d > 0.0, "r_d", fluid.r_d, "positive");
  for (const MdpdPair& pair : pairs) {
    validate(pair.friction);
    require_parameter(pair.b >= 0.0, "b", pair.b, "zero or positive");
    table_.push_back({pair, Friction(pair.friction)});
    cutoff_ = std::max(cutoff_, pair.friction.reach());
    thermal_ = thermal_ || pair.friction.kT > 0.0;
  }
}

template <int D>
std::vector<double> MdpdModel<D>::kinks(Site site_i, Site site_j) const {
  std::vector<double> ends = entry(site_i, site_j).of.friction.kinks();
  ends.push_back(fluid_.r_d);
  std::sort(ends.begin(), ends.end());
  return ends;
}

template <int D>
void MdpdModel<D>::write_edges(const PairList<D>& list, const Box<D>& box,
                               std::span<const Vec<D>> positions, const Particles<D>& particles,
                               PairNetwork<D>& network) const {
  const MdpdPair& p = table_[0].of;
  const FrictionParameters& f = p.friction;
  const bool alike =
      std::all_of(table_.begin(), table_.end(), [&](const Entry& entry) { return entry.of == p; });
  if (!alike || f.core > 0.0 || !(f.s == 0.5 || f.s == 1.0 || f.s == 2.0))
    return write_density_terms(
        densities_, [this](double r, Site i, Site j) { return terms(r, i, j); }, cutoff_, list, box,
        positions, particles, network);
  network.transverse = f.gamma_perp > 0.0;
  network.u.each();
  network.kT.fill(f.kT);
  if (network.transverse) {
    network.zeta_perp.each();
  } else {
    network.zeta_perp.fill(0.0);
  }
  // The pair part is DPD's with s_bar = 1.
  const kernels::DpdKernelParameters parameters{p.A, 1.0,      f.gamma,     f.gamma_perp,
                                                f.s, f.cutoff, f.gamma_far, f.cutoff_far};
  const kernels::WeightParameters weight{kernels::WeightShape::square,
                                         p.b * density_norm(fluid_.r_d, D), fluid_.r_d};
  const auto weigh = [&](const PairNetwork<D>& n, std::size_t begin, std::size_t end,
                         const WeightColumns& columns) {
    edge_kernels().weights(weight, static_cast<int>(end - begin), &n.r[begin], columns);
  };
  const auto fill = [&](PairNetwork<D>& n, std::size_t begin, std::size_t end, double* W_2) {
    weigh(n, begin, end, {.W_2 = W_2});
    edge_kernels().dpd(parameters, static_cast<int>(end - begin), &n.r[begin],
                       {&n.u.each()[begin], &n.f_c[begin], &n.k_c.each()[begin], &n.zeta_par[begin],
                        n.transverse ? &n.zeta_perp.each()[begin] : nullptr});
  };
  write_density_edges<D>(densities_, weigh, fill, cutoff_, list, box, positions, particles,
                         network);
}

// At random places rho is n and the mean of the pair force that of all space. A liquid has structure, which takes most of this pressure away;
// its steps are limited by the stiffness of pairs at that density.
template <int D>
std::optional<ReferenceState> MdpdModel<D>::reference_state(double) const {
  if (density_ == 0.0) return std::nullopt;
  const MdpdPair& of = table_[0].of;
  const double n = density_, r_c = of.friction.cutoff;
  const double sphere = D == 2 ? 2.0 * std::numbers::pi : 4.0 * std::numbers::pi;
  const double virial = of.A * sphere * std::pow(r_c, D + 1) / ((D + 1.0) * (D + 2.0));
  const double pairs = n * n * virial / (2.0 * D),
               many = n * n * densities_.energy({.density = n}).first;
  ReferenceState s;
  s.density = n;
  s.pressure = pairs + many;
  s.bulk_modulus = 2.0 * pairs + 3.0 * many;
  s.accurate_step = s.stable_step = std::numeric_limits<double>::infinity();
  return s;
}

namespace {
constexpr double longest_path = 0.03;  // in r_c
}

template <int D>
double MdpdModel<D>::thermal_path() const {
  return fluid_.filled ? std::numeric_limits<double>::infinity()
                       : longest_path * table_[0].of.friction.cutoff;
}

template <int D>
ModelParameters MdpdModel<D>::parameters() const {
  const MdpdPair& of = table_[0].of;
  return {"many-body DPD",
          {{"A", of.A},
           {"B", fluid_.B},
           {"r_c", of.friction.cutoff},
           {"r_d", fluid_.r_d},
           {"gamma", of.friction.gamma},
           {"sigma", std::sqrt(2.0 * of.friction.gamma * of.friction.kT)},
           {"s", of.friction.s}}};
}

namespace {

// What a massless scene of this fluid must not have cannot be seen from its keys, so its author says it.
void refuse_free_surface(const FluidKeys& keys, const FrictionParameters& friction) {
  keys.fluid.fail(
      "mass",
      fmt::format(
          "is 0: a massless drop does not resist turning, and a particle that evaporates resists "
          "nothing, so that no step has a solution. Give a mass of at least kT (dt/({} r_c))^2 = "
          "{:.3g} dt^2, or say filled = true where the liquid fills the box and has no free "
          "surface",
          longest_path, friction.kT / std::pow(longest_path * friction.cutoff, 2)));
}

MdpdPair read_mdpd_pair(const Config& keys, MdpdPair base, bool whole) {
  base.friction = read_friction(keys, base.friction, whole);
  base.A = whole ? keys.number("A") : keys.number("A", base.A);
  if (keys.gives("a"))
    keys.fail("a",
              "is DPD's: many-body DPD has A of its pairs (A < 0 attracts) and B of densities");
  if (whole) return base;
  for (const char* key : {"B", "r_d"})
    if (keys.gives(key))
      keys.fail(
          key,
          "is of the whole fluid: a force with one for each pair of species has no energy. Give b, "
          "what unlike particles count in each other's densities");
  base.b = keys.non_negative("b", base.b);
  return base;
}

}  // namespace

template <int D>
std::shared_ptr<const PairModel<D>> read_mdpd(const FluidKeys& keys) {
  const MdpdPair fluid_pair = read_mdpd_pair(keys.fluid, MdpdPair{}, true);
  const MdpdFluid fluid{.B = keys.fluid.non_negative("B"),
                        .r_d = keys.fluid.positive("r_d"),
                        .filled = keys.fluid.boolean("filled", false)};
  if (keys.mass == 0.0 && !fluid.filled) refuse_free_surface(keys, fluid_pair.friction);
  const auto table = pair_table(keys, fluid_pair, [](const Config& pair, const MdpdPair& base) {
    return read_mdpd_pair(pair, base, false);
  });
  return std::make_shared<const MdpdModel<D>>(fluid, static_cast<int>(keys.species), table,
                                              keys.density);
}

template class MdpdModel<2>;
template class MdpdModel<3>;
template std::shared_ptr<const PairModel<2>> read_mdpd<2>(const FluidKeys&);
template std::shared_ptr<const PairModel<3>> read_mdpd<3>(const FluidKeys&);

}  // namespace odpd
