#pragma once
// A rectangular box [0, L_c) per direction c, each direction periodic or bounded; with shear, its images slide.
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "odpd/core/index.h"
#include "odpd/core/rotation.h"
#include "odpd/core/vec.h"

namespace odpd {

/// Lees-Edwards shear (Lees & Edwards 1972) of a flow u = rate(t) (y - L_y/2) along x, for flow = x and gradient = y: the
/// images of the box one box up along y are displaced along x by strain(t) L_y, and move there with rate(t) L_y.
struct Shear {
  int flow = 0;            ///< direction of the flow
  int gradient = 1;        ///< direction across which it varies
  double rate = 0.0;       ///< at t = 0 (1/time)
  double frequency = 0.0;  ///< omega (1/time): rate(t) = rate cos(omega t); 0: steady
  double start = 0.0;      ///< displacement at t = 0 (length)

  double rate_at(double t) const { return frequency > 0.0 ? rate * std::cos(frequency * t) : rate; }
  double strain_at(double t) const {
    return frequency > 0.0 ? rate / frequency * std::sin(frequency * t) : rate * t;
  }
};

template <int D>
struct Box {
  Vec<D> size{};
  std::array<bool, index(D)> periodic{};
  std::optional<Shear> shear{};  ///< both of its directions are periodic
  double offset = 0.0;   ///< displacement of the image one box up, within half a box (length)
  double sliding = 0.0;  ///< velocity of that image (length/time)

  bool is_periodic(int c) const { return periodic[index(c)]; }
  int periodic_directions() const {
    int n = 0;
    for (bool p : periodic) n += p ? 1 : 0;
    return n;
  }
  double volume() const {
    double v = 1.0;
    for (int c = 0; c < D; ++c) v *= size[c];
    return v;
  }

  /// This box with its images where they are at time t: a function of t alone.
  Box at(double t) const {
    Box box = *this;
    if (!shear) return box;
    const double height = size[shear->gradient];
    box.offset = std::remainder(shear->start + shear->strain_at(t) * height, size[shear->flow]);
    box.sliding = shear->rate_at(t) * height;
    return box;
  }
  /// Velocity of the sheared flow at r: none without shear.
  Vec<D> flow_velocity(const Vec<D>& r) const {
    Vec<D> u{};
    if (shear) u[shear->flow] = sliding * (r[shear->gradient] / size[shear->gradient] - 0.5);
    return u;
  }
  /// Half the curl of the sheared flow, as an angular velocity: what particles that spin turn with.
  Vec<D> flow_spin() const {
    if (!shear) return {};
    Vec<D> gradient{}, flow{};
    gradient[shear->gradient] = 1.0;
    flow[shear->flow] = 0.5 * sliding / size[shear->gradient];
    return torque(gradient, flow);
  }
  /// How many boxes up along the gradient the nearest image of b is seen from a, for d = a - b of positions in the box. Its
  /// velocity is that of b plus so many times `sliding`. Only with shear.
  int images_up(const Vec<D>& d) const {
    const double y = d[shear->gradient], half = 0.5 * size[shear->gradient];
    return y > half ? 1 : y < -half ? -1 : 0;
  }
  /// r in coordinates along the edges of the sheared cell, in which images are `size` apart. Inside the box as r is.
  Vec<D> straightened(const Vec<D>& r) const {
    if (!shear) return r;
    Vec<D> s = r;
    s[shear->flow] -= offset * (r[shear->gradient] / size[shear->gradient]);
    std::int32_t unused = 0;
    wrap_along(shear->flow, s, unused);
    return s;
  }

  /// a - b for the nearest images; a and b inside the box along periodic directions.
  Vec<D> separation(const Vec<D>& a, const Vec<D>& b) const {
    Vec<D> d = a - b;
    if (shear) d[shear->flow] -= images_up(d) * offset;
    for (int c = 0; c < D; ++c) {
      if (!is_periodic(c)) continue;
      if (d[c] > 0.5 * size[c]) {
        d[c] -= size[c];
      } else if (d[c] < -0.5 * size[c]) {
        d[c] += size[c];
      }
    }
    return d;
  }

  /// Moves r into the box along periodic directions; image counts the crossings, so that r + image * size stays where it
  /// was. With shear not so along the flow: what crosses along the gradient also moves by the offset (and its velocity
  /// changes by `sliding`).
  void wrap(Vec<D>& r, std::array<std::int32_t, index(D)>& image) const {
    if (shear) {
      auto& up = image[index(shear->gradient)];
      const std::int32_t before = up;
      wrap_along(shear->gradient, r, up);
      r[shear->flow] -= (up - before) * offset;
    }
    for (int c = 0; c < D; ++c)
      if (is_periodic(c)) wrap_along(c, r, image[index(c)]);
  }
  void wrap(Vec<D>& r) const {
    std::array<std::int32_t, index(D)> unused{};
    wrap(r, unused);
  }

 private:
  void wrap_along(int c, Vec<D>& r, std::int32_t& image) const {
    const double cells = std::floor(r[c] / size[c]);
    if (cells == 0.0 && r[c] >= 0.0) return;
    r[c] -= cells * size[c];
    image += static_cast<std::int32_t>(cells);
    if (r[c] >= size[c]) {  // rounding of a tiny negative coordinate
      r[c] = 0.0;
      image += 1;
    }
    if (r[c] < 0.0) r[c] = 0.0;  // rounding of the quotient
  }
};

}  // namespace odpd
