#pragma once
// A rectangular box [0, L_c) per direction c, each direction periodic or bounded.
#include <array>
#include <cstdint>

#include "odpd/core/vec.h"

namespace odpd {

template <int D>
struct Box {
  Vec<D> size{};
  std::array<bool, static_cast<std::size_t>(D)> periodic{};

  bool is_periodic(int c) const { return periodic[static_cast<std::size_t>(c)]; }
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

  /// a - b for the nearest images; a and b inside the box along periodic directions.
  Vec<D> separation(const Vec<D>& a, const Vec<D>& b) const {
    Vec<D> d = a - b;
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

  /// Moves r into the box along periodic directions; image counts the crossings, so that
  /// r + image * size stays where it was.
  void wrap(Vec<D>& r, std::array<std::int32_t, static_cast<std::size_t>(D)>& image) const {
    for (int c = 0; c < D; ++c) {
      if (!is_periodic(c)) continue;
      const double cells = std::floor(r[c] / size[c]);
      if (cells == 0.0 && r[c] >= 0.0) continue;
      r[c] -= cells * size[c];
      image[static_cast<std::size_t>(c)] += static_cast<std::int32_t>(cells);
      if (r[c] >= size[c]) {  // rounding of a tiny negative coordinate
        r[c] = 0.0;
        image[static_cast<std::size_t>(c)] += 1;
      }
      if (r[c] < 0.0) r[c] = 0.0;  // rounding of the quotient
    }
  }
  void wrap(Vec<D>& r) const {
    std::array<std::int32_t, static_cast<std::size_t>(D)> unused{};
    wrap(r, unused);
  }
};

}  // namespace odpd
