#include "odpd/analysis/mode_keys.h"

#include <fmt/format.h>

#include <algorithm>

namespace odpd {

namespace {

constexpr std::int64_t most_waves = 1000;

}  // namespace

template <int D>
std::vector<int> read_wave_axes(const ObserverEntry<D>& entry) {
  const Vec<D>& size = entry.scene.box().size;
  const double longest = *std::max_element(size.x.begin(), size.x.end());
  std::vector<int> axes;
  if (!entry.config.has("axes")) {
    for (int c = 0; c < D; ++c)
      if (size[c] == longest) axes.push_back(c);
    return axes;
  }
  for (const std::string& name : entry.config.texts("axes")) {
    const int axis = name.size() == 1 ? name[0] - 'x' : -1;
    if (axis < 0 || axis >= D || std::find(axes.begin(), axes.end(), axis) != axes.end())
      entry.config.fail("axes",
                        fmt::format("'{}' is no direction, or given twice: use a list of {}", name,
                                    D == 2 ? "x, y" : "x, y, z"));
    axes.push_back(axis);
    if (size[axis] != size[axes.front()])
      entry.config.fail("axes",
                        fmt::format("the box has edges {} and {} along them, so that their wave "
                                    "numbers differ: use an observer for each",
                                    size[axes.front()], size[axis]));
  }
  if (axes.empty()) entry.config.fail("axes", "at least one direction is needed");
  return axes;
}

std::int64_t read_extrapolation(const Config& config, std::size_t waves) {
  const auto most = static_cast<std::int64_t>(waves);
  if (!config.has("extrapolate")) return std::min<std::int64_t>(4, most);
  const std::int64_t chosen = config.integer("extrapolate");
  if (chosen < 2 || chosen > most)
    config.fail(
        "extrapolate",
        fmt::format("is {}: eta_0 + a k^2 is fitted to the smallest wave numbers, from 2 to "
                    "all {} that there are",
                    chosen, most));
  return chosen;
}

std::vector<std::int64_t> read_wave_numbers(const Config& config) {
  std::vector<std::int64_t> numbers;
  if (!config.has("numbers")) {
    const std::int64_t count = config.positive_integer("count", 8);
    if (count > most_waves)
      config.fail("count", fmt::format("is {}: at most {}", count, most_waves));
    for (std::int64_t number = 1; number <= count; ++number) numbers.push_back(number);
    return numbers;
  }
  if (config.has("count")) config.fail("count", "give either count or numbers");
  for (const double number : config.numbers("numbers")) {
    if (number > most_waves)
      config.fail("numbers",
                  fmt::format("has {}: waves in an edge are at most {}", number, most_waves));
    const auto whole = static_cast<std::int64_t>(number);
    if (static_cast<double>(whole) != number || whole <= (numbers.empty() ? 0 : numbers.back()))
      config.fail("numbers", "must be whole, positive and ascending: waves in the edge of the box");
    numbers.push_back(whole);
  }
  if (numbers.empty()) config.fail("numbers", "at least one is needed");
  return numbers;
}

template <int D>
void refuse_modes_unless_at_rest(const ObserverEntry<D>& entry) {
  const Scene<D>& scene = entry.scene;
  const SceneSettings<D>& s = scene.settings();
  const auto fail = [&](const std::string& why) { entry.config.fail("kind", "'modes' " + why); };
  if (!(scene.largest_kT() > 0.0)) fail("measures by thermal motion: kT must be positive");
  for (const PairMoments& pair : scene.pair_moments())
    if (pair.kT != scene.largest_kT())
      fail("measures an equilibrium: all pairs of species must have the same kT");
  if (s.zeta_0 > 0.0)
    fail("needs a fluid that keeps its momentum, which a drag takes up: leave out fluid.zeta_0");
  if (s.box.shear) fail("measures at rest: leave out [shear]");
  if (s.box.periodic_directions() < D || s.held())
    fail(
        "needs waves that nothing stops: a box that is periodic in all directions, without walls, "
        "obstacles or bodies of known motion");
  if (s.driven()) fail("measures at rest: no force or torque may drive anything");
}

template std::vector<int> read_wave_axes<2>(const ObserverEntry<2>&);
template std::vector<int> read_wave_axes<3>(const ObserverEntry<3>&);
template void refuse_modes_unless_at_rest<2>(const ObserverEntry<2>&);
template void refuse_modes_unless_at_rest<3>(const ObserverEntry<3>&);

}  // namespace odpd
