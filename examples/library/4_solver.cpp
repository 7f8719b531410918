// A solver of your own behind `Solver`: conjugate residuals (Stiefel 1955), which make |b - A x| least in each step,
//
//   beta = r.Ar/(r.Ar)_before,  p = r + beta p,  Ap = Ar + beta Ap,  alpha = r.Ar/|Ap|^2,  x += alpha p,  r -= alpha Ap
//
// The base class projects out the null space, measures the true residual and judges. Beside it `pcg` on the same A x = b.
#include <cmath>
#include <cstdio>
#include <utility>

#include "odpd/dynamics/dynamics.h"
#include "odpd/scene/scene.h"

struct ConjugateResiduals : odpd::Solver {
  explicit ConjugateResiduals(double tolerance) : Solver({.name = "cr", .tolerance = tolerance}) {}
  void set_up() override {}  // what is made once per matrix: here nothing
  std::int64_t memory_bytes() const override { return 4 * 8 * system_->size(); }
  Attempt attempt(std::span<const double> b, std::span<double> x, double tolerance) override {
    std::vector<double> r(b.size()), Ar(b.size()), p(b.size()), Ap(b.size());
    system_->apply(x, Ar);
    for (std::size_t k = 0; k < r.size(); ++k) r[k] = b[k] - Ar[k];
    double before = HUGE_VAL;  // r.Ar; beta is 0 at first
    for (std::int64_t done = 0;; ++done) {
      const bool good = system_->norm(r) <= tolerance * system_->norm(b);
      if (good || done == iterations_left_) return {good, done, ""};
      system_->apply(r, Ar);
      const double r_Ar = system_->inner_product(r, Ar), beta = r_Ar / std::exchange(before, r_Ar);
      for (std::size_t k = 0; k < r.size(); ++k)
        p[k] = r[k] + beta * p[k], Ap[k] = Ar[k] + beta * Ap[k];
      const double alpha = r_Ar / system_->inner_product(Ap, Ap);
      for (std::size_t k = 0; k < r.size(); ++k) x[k] += alpha * p[k], r[k] -= alpha * Ap[k];
    }
  }
};

int main() {
  odpd::SceneSettings<2> settings;
  settings.box = {.size = {{20.0, 20.0}}, .periodic = {true, true}};
  odpd::Scene<2> scene(settings);
  odpd::Dynamics<2> dynamics(scene.box(), scene.particles(), scene.model(), scene,
                             odpd::make_solver({.name = "pcg", .tolerance = 1e-8}), {});
  odpd::Stage<2> stage;
  dynamics.evaluate(scene.particles().position, 0.0, stage);
  const std::vector<double> force = dynamics.force(stage);
  const odpd::System& A = dynamics.assemble(stage, {});
  const auto velocity = [&](odpd::Solver& solver) {
    std::vector<double> v(force.size());
    solver.bind(A);
    const odpd::SolveReport report = solver.solve(force, v);
    std::printf("%-4s %3d iterations, residual %.1e %s\n", solver.name().c_str(),
                static_cast<int>(report.iterations), report.residual, report.failure.c_str());
    return v;
  };
  ConjugateResiduals own(1e-8);
  const std::vector<double> v = velocity(own), w = velocity(dynamics.solver());
  std::vector<double> apart(v);
  for (std::size_t k = 0; k < v.size(); ++k) apart[k] -= w[k];
  std::printf("their velocities differ by %.1e of their size\n", A.norm(apart) / A.norm(w));
  return A.norm(apart) < 1e-6 * A.norm(w) ? 0 : 1;
}
