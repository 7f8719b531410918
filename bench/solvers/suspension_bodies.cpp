#include "suspension_bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "odpd/core/config.h"
#include "odpd/core/error.h"
#include "odpd/core/random.h"
#include "odpd/scene/scene_settings.h"

namespace bench {

using odpd::Vec;

namespace {

constexpr double share_tolerance = 0.25;
constexpr double skin_of_body = 0.25;  // half the distance of a fluid's neighbours
constexpr double longest_aspect = 1.8;

template <int D>
double ball(double radius) {
  return D == 2 ? std::numbers::pi * radius * radius
                : 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3);
}

template <int D>
std::vector<Vec<D>> filled_ball(double radius, double spacing) {
  const int n = static_cast<int>(radius / spacing + 1e-9);
  std::vector<Vec<D>> points(1);
  for (int c = 0; c < D; ++c) {
    std::vector<Vec<D>> next;
    for (Vec<D> point : points)
      for (int k = -n; k <= n; ++k) {
        point[c] = spacing * k;
        if (norm(point) <= radius * (1.0 + 1e-9)) next.push_back(point);
      }
    points.swap(next);
  }
  return points;
}

template <int D>
std::vector<Vec<D>> rod(double radius, double spacing) {
  const auto n = std::max<std::int64_t>(1, std::llround(2.0 * radius / spacing));
  std::vector<Vec<D>> points;
  for (std::int64_t k = 0; k <= n; ++k) {
    Vec<D> point{};
    point[0] = radius * (2.0 * static_cast<double>(k) / static_cast<double>(n) - 1.0);
    points.push_back(point);
  }
  return points;
}

/// As a case file makes them.
template <int D>
std::vector<Vec<D>> round_shape(double radius, double spacing) {
  const double triangle = 0.5 * std::sqrt(3.0) * spacing * spacing;
  const std::string text =
      D == 2 ? fmt::format("shape = \"disk\"\nradius = {}\nrings = {}", radius,
                           std::max<std::int64_t>(1, std::llround(radius / spacing)))
             : fmt::format("shape = \"sphere\"\nradius = {}\npoints_on_sphere = {}", radius,
                           std::llround(4.0 * std::numbers::pi * radius * radius / triangle));
  odpd::SceneSettings<D> large;
  for (int c = 0; c < D; ++c) large.box.size[c] = 100.0 * radius;
  return odpd::read_body<D>(odpd::Config::from_text(text, "benchmark"), large).shape;
}

template <int D>
std::vector<Vec<D>> sites_of(const BodySpec& spec) {
  switch (spec.shape) {
    case SiteShape::filled:
      return filled_ball<D>(spec.radius, spec.spacing);
    case SiteShape::line:
      return rod<D>(spec.radius, spec.spacing);
    default:
      return round_shape<D>(spec.radius, spec.spacing);
  }
}

/// The unit cell of the densest packing of balls that are 1 apart.
template <int D>
struct Cell {
  Vec<D> size{};
  std::vector<Vec<D>> places;  // in shares of the size

  Cell() {
    const double x = D == 2 ? 1.0 : std::numbers::sqrt2;
    for (int c = 0; c < D; ++c) size[c] = D == 2 && c == 1 ? std::numbers::sqrt3 : x;
    places.emplace_back();
    for (int a = 0; a < D; ++a)
      for (int b = a + 1; b < D; ++b) {
        Vec<D> face{};
        face[a] = face[b] = 0.5;
        places.push_back(face);
      }
  }
  double volume() const { return odpd::Box<D>{size, {}}.volume(); }
};

/// Cells per direction whose bodies come closest to `wanted` and are no more than `most_bodies`, in a box that is not too long.
template <int D>
std::array<std::int64_t, D> cells_for(const Cell<D>& cell, double wanted, double most_bodies) {
  const double cells = wanted / static_cast<double>(cell.places.size());
  const auto most = std::llround(2.0 * std::pow(cells, 1.0 / D)) + 2;
  std::array<std::int64_t, D> best{};
  double least = std::numeric_limits<double>::infinity();
  std::array<std::int64_t, D> n{};
  const auto judge = [&] {
    double product = 1.0, low = 1e300, high = 0.0;
    for (int c = 0; c < D; ++c) {
      const double edge = static_cast<double>(n[odpd::index(c)]) * cell.size[c];
      product *= static_cast<double>(n[odpd::index(c)]);
      low = std::min(low, edge);
      high = std::max(high, edge);
    }
    if (high > longest_aspect * low) return;
    if (product * static_cast<double>(cell.places.size()) > most_bodies) return;
    const double off = std::abs(product / cells - 1.0) + 0.03 * (high / low - 1.0);
    if (off < least) {
      least = off;
      best = n;
    }
  };
  for (n[0] = 1; n[0] <= most; ++n[0])
    for (n[1] = 1; n[1] <= most; ++n[1]) {
      if constexpr (D == 2) {
        judge();
      } else {
        for (n[2] = 1; n[2] <= most; ++n[2]) judge();
      }
    }
  return best;
}

template <int D>
void pack(const BodySpec& spec, std::int64_t particles, double density, Suspension<D>& s) {
  const Cell<D> cell;
  const double sites = static_cast<double>(s.bodies.shape.size());
  const double all = static_cast<double>(particles);
  const auto n = cells_for<D>(cell, spec.share * all / sites, all / sites);
  std::vector<Vec<D>> corners(1);
  for (int c = 0; c < D; ++c) {
    std::vector<Vec<D>> next;
    for (Vec<D> corner : corners)
      for (std::int64_t k = 0; k < n[odpd::index(c)]; ++k) {
        corner[c] = static_cast<double>(k);
        next.push_back(corner);
      }
    corners.swap(next);
  }
  const double bodies = static_cast<double>(corners.size() * cell.places.size());
  s.free = particles - static_cast<std::int64_t>(bodies * sites);
  const double touching = std::pow(2.0 * spec.radius + spec.gap, D) * cell.volume() /
                          static_cast<double>(cell.places.size());
  const double filled = ball<D>(spec.radius) + static_cast<double>(s.free) / bodies / density;
  const double apart =
      std::pow(std::max(touching, filled) * static_cast<double>(cell.places.size()) / cell.volume(),
               1.0 / D);
  for (int c = 0; c < D; ++c)
    s.size[c] = apart * cell.size[c] * static_cast<double>(n[odpd::index(c)]);
  for (const Vec<D>& corner : corners)
    for (const Vec<D>& place : cell.places) {
      Vec<D> r{};
      for (int c = 0; c < D; ++c) r[c] = apart * cell.size[c] * (corner[c] + place[c]);
      s.bodies.positions.push_back(r);
    }
}

template <int D>
void check_suspension(const BodySpec& spec, std::int64_t particles, const Suspension<D>& s) {
  const double share = static_cast<double>(s.sites()) / static_cast<double>(particles);
  if (s.free < 0 || std::abs(share / spec.share - 1.0) > share_tolerance)
    throw odpd::ConfigError(
        fmt::format("no whole number of bodies of {} sites comes near {:g} of {} particles",
                    s.bodies.shape.size(), spec.share, particles));
  for (int c = 0; c < D; ++c)
    if (4.0 * spec.radius >= s.size[c])
      throw odpd::ConfigError(
          fmt::format("the box of {} particles is {:.3g} long; bodies of radius {:g} need more "
                      "than {:g}",
                      particles, s.size[c], spec.radius, 4.0 * spec.radius));
}

}  // namespace

template <int D>
Suspension<D> suspend(const BodySpec& spec, std::int64_t particles, double density, double thin,
                      std::uint64_t seed) {
  Suspension<D> s;
  s.bodies.shape = sites_of<D>(spec);
  s.bodies.clearance = spec.gap;
  const double sites = static_cast<double>(s.bodies.shape.size());
  if (spec.packed) {
    pack(spec, particles, density, s);
  } else {
    s.bodies.count = std::llround(spec.share * static_cast<double>(particles) / sites);
    s.free = particles - s.sites();
    const double excluded = spec.anywhere ? sites / density : ball<D>(spec.radius + skin_of_body);
    const double volume =
        static_cast<double>(s.free) / density + static_cast<double>(s.bodies.count) * excluded;
    for (int c = 0; c < D; ++c)
      s.size[c] = thin == 0.0 ? std::pow(volume, 1.0 / D)
                  : c == 0    ? thin
                              : std::pow(volume / thin, 1.0 / (D - 1));
    const odpd::CounterRandom random(seed, odpd::Stream::probe);
    for (std::int64_t b = 0; spec.anywhere && b < s.bodies.count; ++b) {
      const auto u = random.uniforms(1, 0, static_cast<std::uint64_t>(b), 0);
      Vec<D> r{};
      for (int c = 0; c < D; ++c) r[c] = s.size[c] * u[odpd::index(c)];
      s.bodies.positions.push_back(r);
    }
  }
  check_suspension(spec, particles, s);
  return s;
}

template <int D>
void place_body(std::size_t body, const odpd::RigidPose<D>& pose, const odpd::Box<D>& box,
                const std::vector<std::int32_t>& index_of_id, odpd::Particles<D>& particles) {
  odpd::RigidBody<D>& b = particles.bodies[body];
  b.pose = pose;
  for (std::size_t k = 0; k < b.members.size(); ++k) {
    const auto p = odpd::index(index_of_id[odpd::index(b.members[k])]);
    place_constituent(b, pose, k, box, particles.position[p], particles.image[p]);
  }
}

template <int D>
void turn_bodies(std::uint64_t seed, const odpd::Box<D>& box, odpd::Particles<D>& particles) {
  const odpd::CounterRandom random(seed, odpd::Stream::body_poses);
  const std::vector<std::int32_t> index_of_id = particles.index_of_id();
  for (std::size_t b = 0; b < particles.bodies.size(); ++b) {
    odpd::RigidPose<D> pose = particles.bodies[b].pose;
    turn_at_random(random.uniforms(0, 1, b, 0), pose.orientation);
    place_body(b, pose, box, index_of_id, particles);
  }
}

#define ODPD_INSTANTIATE(D)                                                                        \
  template Suspension<D> suspend<D>(const BodySpec&, std::int64_t, double, double, std::uint64_t); \
  template void place_body<D>(std::size_t, const odpd::RigidPose<D>&, const odpd::Box<D>&,         \
                              const std::vector<std::int32_t>&, odpd::Particles<D>&);              \
  template void turn_bodies<D>(std::uint64_t, const odpd::Box<D>&, odpd::Particles<D>&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace bench
