#include "odpd/analysis/contact_angle.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "odpd/core/index.h"

namespace odpd {

namespace {

// Of sin^n from 0 to the angle.
double sine_integral(int n, double angle) {
  if (n == 0) return angle;
  if (n == 1) return 1.0 - std::cos(angle);
  return ((n - 1) * sine_integral(n - 2, angle) -
          std::pow(std::sin(angle), n - 1) * std::cos(angle)) /
         n;
}

}  // namespace

template <int D>
double cap_height(double angle) {
  const double part = sine_integral(D, angle);
  const double volume = unit_ball_volume<D> * part / sine_integral(D, std::numbers::pi);
  const double centre = std::pow(std::sin(angle), D + 1) / ((D + 1) * part);
  return (centre - std::cos(angle)) / std::pow(volume, 1.0 / D);
}

template <int D>
double cap_angle(double ratio) {
  // Below 3 degrees the formulas are differences of nearly equal numbers.
  double low = 0.05, high = std::numbers::pi;
  if (!(ratio > cap_height<D>(low) && ratio <= cap_height<D>(high))) return std::nan("");
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (low + high);
    (cap_height<D>(middle) < ratio ? low : high) = middle;
  }
  return 0.5 * (low + high) * 180.0 / std::numbers::pi;
}

template <int D>
ContactAngle<D>::ContactAngle(ObserverSettings settings, ContactAngleSettings drop,
                              const Scene<D>& scene)
    : Observer<D>(std::move(settings), std::vector<std::string>{"height"}),
      drop_(drop),
      scene_(scene) {}

template <int D>
std::unique_ptr<Observer<D>> ContactAngle<D>::make(const ObserverEntry<D>& entry) {
  const SceneSettings<D>& scene = entry.scene.settings();
  ObserverSettings settings = entry.settings(5);
  if (scene.walls.empty())
    entry.config.fail("kind", "the scene has no [[wall]] for a drop to sit on");
  std::vector<std::string> sides;
  for (const auto& wall : scene.walls)
    sides.push_back(fmt::format("{}{}", "xyz"[wall.axis], wall.high ? '+' : '-'));
  const std::string side = entry.config.choice("wall", sides, sides[0]);
  ContactAngleSettings drop;
  while (sides[drop.wall] != side) ++drop.wall;
  const bool given = scene.count < 0 && scene.start != StartKind::file;
  drop.density =
      given ? entry.config.positive("density", scene.density) : entry.config.positive("density");
  drop.offset = entry.config.number("offset", 0.0);
  return std::make_unique<ContactAngle<D>>(std::move(settings), drop, entry.scene);
}

template <int D>
void ContactAngle<D>::measure(const Clock&, const Particles<D>& particles,
                              const StepRecord<D>& record) {
  const WallSettings<D>& wall = scene_.settings().walls[drop_.wall];
  const Share own = particles.owned();
  double height = 0.0;
  for (std::size_t i = 0; i < record.start.position.size(); ++i) {
    if (!particles.is_free(i) || !own.owns(i)) continue;
    const double x = record.start.position[i][wall.axis];
    height += wall.high ? scene_.fluid_high()[wall.axis] - x : x - scene_.fluid_low()[wall.axis];
  }
  this->add({own.ranks->sum(height) / static_cast<double>(particles.free_count())});
}

template <int D>
double ContactAngle<D>::angle(double height) const {
  const double volume = static_cast<double>(scene_.particles().free_count()) / drop_.density;
  return cap_angle<D>((height - drop_.offset) / std::pow(volume, 1.0 / D));
}

template <int D>
void ContactAngle<D>::add_results(Results& results) const {
  results.scalars.push_back(this->mean_of(0, this->named("height")));
  const Scalar& height = results.scalars.back();
  Scalar degrees{this->named("degrees"), angle(height.mean), std::nan("")};
  degrees.standard_error = this->average().jackknife_error(
      [this](const std::vector<double>& means) { return angle(means[0]); });
  if (this->average().samples() > 0 && std::isnan(degrees.mean))
    results.notes.push_back(fmt::format(
        "{}: {} is undefined: a height of {:.4g} is no cap's of {} particles at density {:.4g}. "
        "The "
        "drop came off the wall, spread into a film, or density or offset are another's",
        this->settings().name, degrees.name, height.mean, scene_.particles().free_count(),
        drop_.density));
  results.scalars.push_back(std::move(degrees));
}

template double cap_height<2>(double);
template double cap_height<3>(double);
template double cap_angle<2>(double);
template double cap_angle<3>(double);
template class ContactAngle<2>;
template class ContactAngle<3>;

}  // namespace odpd
