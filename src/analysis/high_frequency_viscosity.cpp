#include "odpd/analysis/high_frequency_viscosity.h"

#include <fmt/format.h>

#include "odpd/analysis/frozen.h"
#include "odpd/analysis/observer_keys.h"

namespace odpd {

namespace {

std::string name_of(const FlowPlane& plane) { return {"xyz"[plane.flow], "xyz"[plane.gradient]}; }

// The mean, then each plane.
std::vector<std::string> plane_columns(const std::vector<FlowPlane>& planes) {
  std::vector<std::string> columns{"eta"};
  for (const FlowPlane& plane : planes) columns.push_back(name_of(plane));
  return columns;
}

template <int D>
std::vector<FlowPlane> read_planes(const Config& config) {
  std::vector<FlowPlane> all, planes;
  std::vector<std::string> names, usual;
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b) {
      if (a == b) continue;
      all.push_back({a, b});
      names.push_back(name_of(all.back()));
      if (a < b) usual.push_back(names.back());
    }
  for (const std::string& name : config.texts("planes", usual)) {
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end())
      config.fail("planes", fmt::format("there is no plane '{}': use direction of the flow and of "
                                        "its gradient, one or more of {}",
                                        name, fmt::join(names, ", ")));
    planes.push_back(all[static_cast<std::size_t>(at - names.begin())]);
    if (std::count_if(planes.begin(), planes.end(),
                      [&](const FlowPlane& p) { return name_of(p) == name; }) > 1)
      config.fail("planes", fmt::format("'{}' stands there twice", name));
  }
  if (planes.empty()) config.fail("planes", "at least one is needed, as \"xy\"");
  return planes;
}

}  // namespace

template <int D>
HighFrequencyViscosity<D>::HighFrequencyViscosity(ObserverSettings settings,
                                                  HighFrequencySettings flows,
                                                  const Scene<D>& scene)
    : Observer<D>(std::move(settings), plane_columns(flows.planes)),
      flows_(std::move(flows)),
      scene_(scene) {}

template <int D>
std::unique_ptr<Observer<D>> HighFrequencyViscosity<D>::make(const ObserverEntry<D>& entry) {
  ObserverSettings settings = entry.settings(50);
  const SceneSettings<D>& s = entry.scene.settings();
  if (s.box.periodic_directions() < D || !entry.scene.conserves_momentum())
    entry.config.fail("kind",
                      "belongs to a box that is periodic in all directions, where nothing is held "
                      "and no zeta_0 drags: walls, held bodies and drag take up a part of the "
                      "stress");
  if (entry.in_time) refuse_frozen(entry);
  HighFrequencySettings flows;
  flows.planes = read_planes<D>(entry.config);
  flows.incompressible = read_incompressible(entry);
  flows.tolerance = read_frozen_tolerance(entry.config);
  return std::make_unique<HighFrequencyViscosity<D>>(std::move(settings), std::move(flows),
                                                     entry.scene);
}

template <int D>
double HighFrequencyViscosity<D>::solves() const {
  const auto solves = static_cast<double>(flows_.planes.size());
  return (flows_.incompressible ? 1.0 + solves_with_pressure * solves : solves) /
         static_cast<double>(this->settings().every);
}

template <int D>
void HighFrequencyViscosity<D>::measure(const Clock&, const Particles<D>& particles,
                                        const StepRecord<D>& record) {
  const std::optional<FrozenPressure<D>> pressure =
      pressure_on<D>(particles, record, scene_, flows_.incompressible, flows_.tolerance);
  std::vector<double> sample(1, 0.0);
  for (const FlowPlane& plane : flows_.planes) {
    const Gradient<D> E = shear_gradient<D>(plane.flow, plane.gradient);
    sample.push_back(
        answer_to_flow(particles, record, E, flows_.tolerance, pressure ? &*pressure : nullptr)
            .power /
        scene_.box().volume());
    sample[0] += sample.back() / static_cast<double>(flows_.planes.size());
  }
  this->add(std::move(sample));
}

template class HighFrequencyViscosity<2>;
template class HighFrequencyViscosity<3>;

}  // namespace odpd
