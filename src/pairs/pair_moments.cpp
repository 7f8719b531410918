#include "odpd/pairs/pair_moments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "odpd/core/error.h"
#include "odpd/core/quadrature.h"

namespace odpd {

namespace {

constexpr double unknown = std::numeric_limits<double>::infinity();
constexpr double core_energy = 10.0;   // in kT
constexpr std::size_t samples = 1024;  // of r, for the largest values

// One pair of species, with the forces that densities add where both particles have that of the reference. A model that refuses a distance
// has no numbers there.
template <int D>
class PairFunction {
 public:
  PairFunction(const PairModel<D>& model, Site site_i, Site site_j)
      : model_(model), i_(site_i), j_(site_j) {
    if (const auto reference = model.reference_state(0.0)) {
      i_.density = j_.density = reference->density;
      slope_ = model.densities()->energy(i_).first + model.densities()->energy(j_).first;
    }
    for (const double r : model.kinks(site_i, site_j))
      if (r > end() && r < model.cutoff()) ends_.push_back(r);
    if (model.cutoff() > end()) ends_.push_back(model.cutoff());
  }

  PairTerms operator()(double r) const {
    try {
      PairTerms t = model_.pair(r, i_, j_);
      if (slope_ != 0.0) {
        const Derivatives w = model_.densities()->weight(r, i_, j_);
        t.f_c -= slope_ * w.first;
        t.k_c += slope_ * w.second;
      }
      return t;
    } catch (const Error&) {
      const double none = std::nan("");
      return {none, none, none, none, none, none};
    }
  }
  /// Of the stretches between kinks, the first of which begins at 0.
  const std::vector<double>& ends() const { return ends_; }

 private:
  double end() const { return ends_.empty() ? 0.0 : ends_.back(); }

  const PairModel<D>& model_;
  Site i_, j_;
  double slope_ = 0.0;  // psi'(d_i) + psi'(d_j)
  std::vector<double> ends_;
};

using Integrand = std::array<double, 5>;  // energy, virial, drag, both shears; times r^(d - 1)

template <int D>
Integrand integrand(const PairFunction<D>& pair, double r) {
  const PairTerms t = pair(r);
  const double shell = std::pow(r, D - 1);
  return {t.u * shell, r * t.f_c * shell, (t.zeta_par + (D - 1) * t.zeta_perp) * shell,
          r * r * t.zeta_par * shell, r * r * t.zeta_perp * shell};
}

// As r^-1 or worse, seen over ten doublings of r next to 0.
bool diverges(double near, double further) {
  if (!std::isfinite(near) || !std::isfinite(further)) return true;
  if (near == 0.0) return false;
  return std::log2(std::abs(further / near)) / 10.0 < -0.999;
}

// Beyond `from`, times the surface of the unit sphere.
template <int D>
Integrand integrals(const PairFunction<D>& pair, double from) {
  const double surface = 2.0 * std::pow(std::numbers::pi, 0.5 * D) / std::tgamma(0.5 * D);
  Integrand sum{};
  for (const double end : pair.ends()) {
    if (end <= from) continue;
    const Integrand part = integrate<5>([&](double r) { return integrand(pair, r); }, from, end);
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += surface * part[k];
    from = end;
  }
  return sum;
}

template <int D>
void set_integrals(const PairFunction<D>& pair, PairMoments& m) {
  if (pair.ends().empty()) return;
  const double first = pair.ends().front();
  const Integrand near = integrand(pair, std::ldexp(first, -60)),
                  further = integrand(pair, std::ldexp(first, -50));
  const Integrand all = integrals(pair, 0.0);
  const auto defined = [&](std::size_t k) -> std::optional<double> {
    if (diverges(near[k], further[k]) || !std::isfinite(all[k])) return std::nullopt;
    return all[k];
  };
  m.energy = defined(0);
  if (m.energy) m.virial = defined(1);
  m.drag = defined(2);
  m.shear_par = defined(3);
  m.shear_perp = defined(4);
}

bool is_finite(const PairTerms& t) {
  return std::isfinite(t.u) && std::isfinite(t.f_c) && std::isfinite(t.k_c);
}

// r_core, 0 where there is no hard core, nothing where nobody knows.
template <int D>
std::optional<double> core_of(const PairFunction<D>& pair, double kT) {
  if (is_finite(pair(0.0))) return 0.0;
  const double end = pair.ends().back();
  const auto reached = [&](double r) { return pair(r).u <= core_energy * kT; };
  double low = std::ldexp(end, -40), high = low;
  // Reached ever so near: it pulls without bound.
  if (!(kT > 0.0) || reached(low)) return std::nullopt;
  while (high < end && !reached(high)) {
    low = high;
    high *= 1.1;
  }
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (reached(middle) ? high : low) = middle;
  }
  return high;
}

// The largest values between `from` and the end of each stretch, and where force and friction end.
template <int D>
void set_largest(const PairFunction<D>& pair, double from, PairMoments& m) {
  struct Stretch {
    double end, force, friction;
  };
  std::vector<Stretch> stretches;
  std::vector<std::pair<double, double>> bends;  // r, |k_c|
  const std::size_t each = std::max<std::size_t>(16, samples / pair.ends().size());
  for (const double end : pair.ends()) {
    if (end <= from) continue;
    Stretch stretch{end, 0.0, 0.0};
    // Where the first begins, and inside the others: what holds at a kink may be that of either side.
    const double offset = stretches.empty() ? 0.0 : 0.5;
    for (std::size_t k = 0; k < each; ++k) {
      const double part = (static_cast<double>(k) + offset) / static_cast<double>(each);
      const double r = from + (end - from) * part;
      const PairTerms t = pair(r);
      stretch.force = std::max(stretch.force, std::abs(t.f_c));
      stretch.friction = std::max(stretch.friction, t.zeta_par);
      m.zeta_perp = std::max(m.zeta_perp, t.zeta_perp);
      if (t.k_c != 0.0) bends.emplace_back(r, std::abs(t.k_c));
    }
    m.force = std::max(m.force, stretch.force);
    m.zeta_par = std::max(m.zeta_par, stretch.friction);
    stretches.push_back(stretch);
    from = end;
  }
  for (const Stretch& stretch : stretches) {
    if (stretch.force > 0.0) m.force_range = stretch.end;
    if (stretch.force > 0.0 || (stretch.friction > 0.0 && stretch.friction >= 0.1 * m.zeta_par))
      m.range = stretch.end;
  }
  if (m.force_range == 0.0) return;
  m.stiffness = m.force / m.force_range;
  for (const auto& [r, k] : bends)
    m.stiffness = std::max(m.stiffness, k * (1.0 - r / m.force_range));
}

// One that ends as a power of the distance loses a good part of what it has from the first distance to the second. A jump of 2 % of the
// largest force has been seen to raise the configurational temperature by 9 %; what this lets pass is lost in its standard error.
template <int D>
bool jumps_at_end(const PairFunction<D>& pair, const PairMoments& m) {
  const double before = std::abs(pair(m.force_range * (1.0 - 1e-6)).f_c),
               last = std::abs(pair(m.force_range * (1.0 - 1e-12)).f_c);
  return last > 0.9 * before && last > 1e-4 * m.force;
}

}  // namespace

template <int D>
PairMoments pair_moments(const PairModel<D>& model, Site site_i, Site site_j) {
  const PairFunction<D> pair(model, site_i, site_j);
  PairMoments m;
  if (pair.ends().empty()) return m;
  m.kT = pair(0.5 * pair.ends().back()).kT;
  set_integrals(pair, m);
  const std::optional<double> core = core_of(pair, m.kT);
  set_largest(pair, core.value_or(std::ldexp(pair.ends().front(), -10)), m);
  m.force_jumps = jumps_at_end(pair, m);
  if (core) {
    m.energy_beyond_core = *core > 0.0 ? integrals(pair, *core)[0] : m.energy;
  } else {
    m.force = m.stiffness = unknown;
  }
  return m;
}

template <int D>
std::vector<PairMoments> pair_moments(const PairModel<D>& model, std::size_t species) {
  std::vector<PairMoments> all(species * species);
  for (std::size_t a = 0; a < species; ++a)
    for (std::size_t b = a; b < species; ++b)
      all[a * species + b] = all[b * species + a] = pair_moments(
          model, Site{static_cast<std::int32_t>(a)}, Site{static_cast<std::int32_t>(b)});
  return all;
}

std::optional<double> explicit_step_limit(const std::vector<PairMoments>& pairs, double mass) {
  double limit = std::numeric_limits<double>::infinity();
  for (const PairMoments& p : pairs) {
    if (!std::isfinite(p.stiffness)) return std::nullopt;
    if (p.stiffness > 0.0)
      limit = std::min(
          limit, std::max(0.2 * p.zeta_par / p.stiffness, 0.1 * std::sqrt(mass / p.stiffness)));
  }
  return limit;
}

bool some_force_jumps(const std::vector<PairMoments>& pairs) {
  return std::any_of(pairs.begin(), pairs.end(),
                     [](const PairMoments& p) { return p.force_jumps; });
}

double largest_kT(const std::vector<PairMoments>& pairs) {
  double kT = 0.0;
  for (const PairMoments& p : pairs) kT = std::max(kT, p.kT);
  return kT;
}

template PairMoments pair_moments<2>(const PairModel<2>&, Site, Site);
template PairMoments pair_moments<3>(const PairModel<3>&, Site, Site);
template std::vector<PairMoments> pair_moments<2>(const PairModel<2>&, std::size_t);
template std::vector<PairMoments> pair_moments<3>(const PairModel<3>&, std::size_t);

}  // namespace odpd
