// An integrator of your own: two-step Adams-Bashforth, of order 2, for particles without mass and noise,
//
//   R(r_k) v_k = F(r_k),   r_{k+1} = r_k + dt (3/2 v_k - 1/2 v_{k-1}),   v_{-1} = v_0
#include <cmath>
#include <cstdio>

#include "odpd/dynamics/integrator.h"
#include "odpd/pairs/dpd.h"
#include "odpd/scene/scene.h"

struct AdamsBashforth : odpd::Integrator<2> {
  std::string name() const override { return "adams-bashforth"; }
  int solves() const override { return 1; }
  const odpd::StepRecord<2>& step(odpd::Dynamics<2>& dynamics, const odpd::Clock& clock) override {
    begin(dynamics, clock);
    Unknowns v = dynamics.force(record_.start);
    dynamics.solve(record_.start, Unknowns(v), {}, v);
    const Unknowns now = v, last = last_.empty() ? v : last_.unknowns(dynamics);
    for (std::size_t k = 0; k < v.size(); ++k) v[k] = 1.5 * v[k] - 0.5 * last[k];
    finish(dynamics, clock, v, v);
    last_.keep(dynamics, now);  // with the particles, whose places in memory change now and then
    return record_;
  }
  void prepare(odpd::Dynamics<2>& dynamics) override { last_.prepare(dynamics); }
  void save(odpd::StateWriter& out) const override { last_.save(out); }
  void load(const odpd::StateReader& in) override { last_.load(in); }
  odpd::CarriedUnknowns<2> last_{"last_velocity"};
};

const odpd::Box<2> box{.size = {{5.0, 5.0}}, .periodic = {true, true}};
// Where the particles are at t = 0.4, in the order of their identities.
std::vector<odpd::Vec<2>> end_of(odpd::Integrator<2>&& integrator, int steps) {
  odpd::SceneSettings<2> settings;
  settings.box = box;
  settings.model = odpd::make_dpd<2>({.s_bar = 2.0, .s = 2.0, .kT = 0.0});  // smooth at the cutoff
  odpd::Scene<2> scene(settings);
  odpd::Dynamics<2> dynamics(scene.box(), scene.particles(), scene.model(), scene,
                             odpd::make_solver({.name = "pcg", .tolerance = 1e-12}), {});
  integrator.prepare(dynamics);
  odpd::Clock clock{.dt = 0.4 / steps, .total_steps = steps};
  for (; !clock.finished(); clock.advance()) integrator.step(dynamics, clock);
  std::vector<odpd::Vec<2>> r;
  for (const auto i : scene.particles().index_of_id()) r.push_back(scene.particles().position[i]);
  return r;
}

int main() {
  const auto exact = end_of(std::move(*odpd::make_integrator<2>("trapezoidal")), 1024);
  const auto error = [&](int steps) {
    const auto r = end_of(AdamsBashforth(), steps);
    double sum = 0.0;
    for (std::size_t i = 0; i < r.size(); ++i) sum += norm(box.separation(r[i], exact[i]));
    return sum;
  };
  const double coarse = error(32), fine = error(64), order = std::log2(coarse / fine);
  std::printf("sum of errors: %.2e in 32 steps, %.2e in 64: order %.2f\n", coarse, fine, order);
  return std::abs(order - 2.0) < 0.1 ? 0 : 1;
}
