// A first flow: a force f on every particle, along +x in the lower half of a periodic box and along -x in the upper,
// drives two streams side by side, each of width H with the parabola of Poiseuille (Backer et al. 2005),
//
//   u(y) = n f/(2 eta) y (H - y),   0 < y < H,   n: particles per area, eta: viscosity
//
// A scene from a case in a string, stepped by hand; the velocities of the lower stream in eight bins.
#include <array>
#include <cmath>
#include <cstdio>

#include "odpd/core/config.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/scene/scene.h"

constexpr char streams[] = R"(
  [box]
  size = [8.0, 16.0]
  periodic = [true, true]
  [fluid]
  density = 4.0
  kT = 1.0
  a = 18.5
  gamma = 4.5
  [body_force]
  region = [{ axis = "y", from = 0.0, to = 8.0, force = [0.5, 0.0] },
            { axis = "y", from = 8.0, to = 16.0, force = [-0.5, 0.0] }]
)";

int main() {
  const odpd::Config config = odpd::Config::from_text(streams, "streams");
  odpd::Scene<2> scene(odpd::read_scene_settings<2>(config));
  config.reject_unread();  // a misspelt key is an error
  odpd::Dynamics<2> dynamics(scene.box(), scene.particles(), scene.model(), scene,
                             odpd::make_solver({.name = "pcg", .tolerance = 1e-5}), {});
  const auto integrator = odpd::make_integrator<2>("trapezoidal");

  std::array<double, 8> count{}, momentum{};
  for (odpd::Clock clock{.dt = 0.005, .total_steps = 2000}; !clock.finished(); clock.advance()) {
    const odpd::StepRecord<2>& record = integrator->step(dynamics, clock);
    for (std::size_t i = 0; i < record.v_mid.size(); ++i) {
      const auto bin = static_cast<std::size_t>(record.start.position[i][1]);
      if (bin >= 8) continue;
      count[bin] += 1.0;
      momentum[bin] += record.v_mid[i][0];
    }
  }
  const double n = 4.0, f = 0.5, H = 8.0, eta = 2.66;  // eta: docs/viscosity-table.md
  const double highest = n * f * H * H / (8.0 * eta);
  double square = 0.0;
  for (std::size_t bin = 0; bin < 8; ++bin) {
    const double y = static_cast<double>(bin) + 0.5, u = momentum[bin] / count[bin];
    const double parabola = n * f / (2.0 * eta) * y * (H - y);
    square += (u - parabola) * (u - parabola) / 8.0;
    std::printf("y = %.1f   u = %5.2f   parabola %5.2f\n", y, u, parabola);
  }
  const double off = std::sqrt(square) / highest;
  std::printf("root mean square deviation: %.1f %% of the highest velocity\n", 100.0 * off);
  return off < 0.05 ? 0 : 1;
}
