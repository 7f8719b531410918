#pragma once
// Case texts for the scene tests: a channel in two dimensions and a periodic box in three.
#include <string>
#include <vector>

#include "odpd/pairs/dpd.h"
#include "odpd/scene/scene.h"

namespace cases {

inline const char* channel = R"(
seed = 3
[box]
size = [10.0, 12.0]
periodic = [true, false]
[fluid]
density = 4.0
a = 18.75
gamma = 4.5
kT = 1.0
[[wall]]
side = "y-"
layers = [{ depth = 0.0, count = 50 }, { depth = 0.5, count = 20 }]
[[wall]]
side = "y+"
velocity = [1.0, 0.0]
layers = [{ depth = 0.0, count = 50 }, { depth = 0.5, count = 20 }]
)";

inline const char* periodic = R"(
[box]
size = [3.0, 4.0, 5.0]
periodic = [true, true, true]
[fluid]
density = 3.0
a = 18.75
gamma = 4.5
kT = 1.0
)";

template <int D>
odpd::SceneSettings<D> settings(const std::string& text,
                                const std::vector<std::string>& overrides = {}) {
  return odpd::read_scene_settings<D>(odpd::Config::from_text(text, "case.toml", overrides));
}

/// A periodic cube with one [[body]] of these keys.
inline std::string body_in(double edge, const std::string& keys,
                           const std::string& fluid = "density = 3.0\n") {
  const std::string e = std::to_string(edge);
  return "seed = 5\n[box]\nsize = [" + e + ", " + e + ", " + e +
         "]\nperiodic = [true, true, true]\n[fluid]\na = 18.75\ngamma = 4.5\nkT = 1.0\n" + fluid +
         "[[body]]\nname = \"b\"\n" + keys;
}
inline const odpd::BodySettings<3>& first_body(const odpd::SceneSettings<3>& s) {
  return s.bodies.at(0);
}

}  // namespace cases
