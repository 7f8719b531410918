// A pair model of your own: the Gaussian core (Stillinger 1976), with the friction and noise of DPD,
//
//   u = A exp(-r^2/(2 w^2)),   f_c = -u' = u r/w^2,   k_c = -f_c' = u (r^2/w^2 - 1)/w^2
//
// Without correlations its pressure is n kT + n^2/(2 d) [r f_c], [f] the integral of f over space. They lower it, in a run as
// in Monte Carlo, which knows u alone: forces that are not its derivatives show in kT = <|F|^2>/<lap U> (3_observer.cpp).
#include <cmath>
#include <cstdio>

#include "odpd/analysis/thermo.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/pairs/friction.h"
#include "odpd/pairs/inline_model.h"
#include "odpd/pairs/pair_moments.h"

struct GaussianCore : odpd::InlineModel<2, GaussianCore> {
  odpd::PairTerms terms(double r, odpd::Site, odpd::Site) const {
    odpd::PairTerms t;
    friction_(r, t);  // zeta_par and kT
    t.u = r < 1.0 ? A * std::exp(-0.5 * r * r / (w * w)) : 0.0;
    t.f_c = t.u * r / (w * w);
    t.k_c = t.u * (r * r / (w * w) - 1.0) / (w * w);
    return t;
  }
  double cutoff() const override { return 1.0; }
  bool conservative() const override { return true; }
  bool thermal() const override { return true; }
  static constexpr double A = 4.0, w = 0.2;
  odpd::Friction friction_{odpd::FrictionParameters{.gamma = 4.5, .cutoff = 1.0, .kT = 1.0}};
};

odpd::Results equilibrium(const odpd::SceneSettings<2>& settings, const char* scheme, double dt) {
  odpd::Scene<2> scene(settings);
  odpd::Dynamics<2> dynamics(scene.box(), scene.particles(), scene.model(), scene,
                             odpd::make_solver({.name = "pcg", .tolerance = 1e-4}), {});
  const auto integrator = odpd::make_integrator<2>(scheme);
  odpd::Thermo<2> thermo({.kind = "thermo", .name = "thermo"}, scene);
  for (odpd::Clock clock{.dt = dt, .total_steps = 4500}; !clock.finished(); clock.advance()) {
    const odpd::StepRecord<2>& record = integrator->step(dynamics, clock);
    if (clock.step >= 500) thermo.measure(clock, scene.particles(), record);
  }
  odpd::Results results;
  thermo.add_results(results);
  return results;
}

int main() {
  odpd::SceneSettings<2> settings;
  settings.box = {.size = {{6.0, 6.0}}, .periodic = {true, true}};
  settings.model = std::make_shared<GaussianCore>();
  const double n = settings.density, virial = *pair_moments(*settings.model, {}, {}).virial;
  const odpd::Scalar run = *equilibrium(settings, "trapezoidal", 0.01).find("pressure");
  const odpd::Results exact = equilibrium(settings, "monte-carlo", 1.0);
  const odpd::Scalar p = *exact.find("pressure"), T = *exact.find("config_temperature");
  std::printf("pressure: %.2f by quadrature, %.3f +- %.3f in a run, %.3f +- %.3f by Monte Carlo\n",
              n + n * n / 4.0 * virial, run.mean, run.standard_error, p.mean, p.standard_error);
  std::printf("kT by forces and stiffness, Monte Carlo: %.3f +- %.3f\n", T.mean, T.standard_error);
  return std::abs(run.mean / p.mean - 1.0) < 0.008 && std::abs(T.mean - 1.0) < 0.03 ? 0 : 1;
}
