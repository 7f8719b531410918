#include "odpd/pairs/dpd.h"

#include <algorithm>

#include "edge_kernels.h"
#include "odpd/core/index.h"
#include "odpd/core/isa.h"
#include "odpd/pairs/edge_writer.h"
#include "odpd/pairs/fluid_keys.h"

namespace odpd {

namespace {

void validate(const DpdParameters& p) {
  require_parameter(p.a >= 0.0, "a", p.a, "zero or positive");
  require_parameter(p.s_bar > 0.0, "s_bar", p.s_bar, "positive");
  validate(p.friction());
}

}  // namespace

template <int D>
DpdModel<D>::DpdModel(int species, std::vector<DpdParameters> parameters, DpdFluid fluid)
    : species_(species), fluid_(std::move(fluid)) {
  require_pair_table(species, parameters);
  for (const DpdParameters& p : parameters) {
    validate(p);
    table_.push_back({p, PowerWeight(p.s_bar), PowerWeight(p.s_bar + 1.0), Friction(p.friction())});
    cutoff_ = std::max({cutoff_, p.cutoff, p.friction().reach()});
    conservative_ = conservative_ || p.a > 0.0;
    thermal_ = thermal_ || p.kT > 0.0;
    reaches_.push_back(p.friction().reach());
  }
}

template <int D>
DpdModel<D>::DpdModel(int species, std::vector<DpdParameters> parameters)
    : DpdModel(species, parameters,
               {.p = parameters.empty() ? DpdParameters{} : parameters.front()}) {}

template <int D>
PairTerms DpdModel<D>::terms(double r, Site site_i, Site site_j) const {
  const Entry& of = entry(site_i, site_j);
  const DpdParameters& p = of.p;
  PairTerms t;
  of.friction(r, t);
  const double width = p.cutoff - p.core, x = 1.0 - (r - p.core) / width;
  if (x > 0.0 && p.a > 0.0) {
    const double beyond = std::min(x, 1.0);
    t.f_c = p.a * of.w_c(beyond);
    t.k_c = r < p.core ? 0.0 : p.s_bar / width * (t.f_c / x);
    t.u = p.a * width / (p.s_bar + 1.0) * of.energy(beyond) + p.a * std::max(0.0, p.core - r);
  }
  return t;
}

template <int D>
ModelParameters DpdModel<D>::parameters() const {
  const DpdParameters& p = fluid_.p;
  return {"DPD parameters",
          {{"a", p.a},
           {"s_bar", p.s_bar},
           {"gamma", p.gamma},
           {"sigma", std::sqrt(2.0 * p.gamma * p.kT)},
           {"s", p.s}}};
}

template <int D>
void DpdModel<D>::write_edges(const PairList<D>& list, const Box<D>& box,
                              std::span<const Vec<D>> positions, const Particles<D>& particles,
                              PairNetwork<D>& network) const {
  const DpdParameters& p = table_[0].p;
  const auto quick = [](double exponent) {
    return exponent == 0.5 || exponent == 1.0 || exponent == 2.0;
  };
  const bool alike =
      std::all_of(table_.begin(), table_.end(), [&](const Entry& entry) { return entry.p == p; });
  if (!alike || p.core > 0.0 || !quick(p.s) || !quick(p.s_bar))
    return write_pair_edges([this](double r, Site i, Site j) { return terms(r, i, j); }, cutoff_,
                            list, box, positions, particles, network, reaches_);
  const bool far = p.gamma_far > 0.0, even = p.a == 0.0 || (p.s_bar == 1.0 && !far);
  network.transverse = p.gamma_perp > 0.0;
  // What is one number for all edges, or else is written by the kernel.
  const auto column = [](Column& c, bool constant, double value) {
    constant ? c.fill(value) : void(c.each());
  };
  column(network.kT, true, p.kT);
  column(network.zeta_perp, !network.transverse, 0.0);
  column(network.k_c, even, p.a * p.s_bar / p.cutoff);
  column(network.u, p.a == 0.0, 0.0);
  const auto& kernel = for_isa(kernels::edge_portable, kernels::edge_avx2, kernels::edge_avx512);
  const kernels::DpdKernelParameters parameters{p.a, p.s_bar,  p.gamma,     p.gamma_perp,
                                                p.s, p.cutoff, p.gamma_far, p.cutoff_far};
  const auto fill = [&](PairNetwork<D>& n, std::size_t begin, std::size_t end) {
    const auto from_begin = [&](Column& c) { return c.varies() ? &c.each()[begin] : nullptr; };
    kernel.dpd(parameters, static_cast<int>(end - begin), &n.r[begin],
               {from_begin(n.u), &n.f_c[begin], from_begin(n.k_c), &n.zeta_par[begin],
                from_begin(n.zeta_perp)});
  };
  network.densities.resize(0, 0);
  write_edge_geometry<D>(list, cutoff_, box, positions, particles, fill, network);
}

template class DpdModel<2>;
template class DpdModel<3>;

}  // namespace odpd
