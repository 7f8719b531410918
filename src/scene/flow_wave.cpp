#include "odpd/scene/flow_wave.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace odpd {

template <int D>
double FlowWave::wave_number(const Box<D>& box, int direction) const {
  return 2.0 * std::numbers::pi * static_cast<double>(number) / box.size[direction];
}

template <int D>
double FlowWave::wave_number_squared(const Box<D>& box, const Vec<D>& amplitude) const {
  const double k = wave_number(box, along);
  if (shape == Shape::sine) return k * k;
  const double across = wave_number(box, direction_of(amplitude));
  return k * k + across * across;
}

template <int D>
double FlowWave::largest(const Box<D>& box, const Vec<D>& amplitude) const {
  const double size = norm(amplitude);
  if (shape == Shape::sine) return size;
  return size * std::max(1.0, wave_number(box, direction_of(amplitude)) / wave_number(box, along));
}

template <int D>
Vec<D> FlowWave::at(const Vec<D>& r, const Box<D>& box, const Vec<D>& amplitude) const {
  Vec<D> f = amplitude;
  if (shape == Shape::sine) {
    f *=
        std::sin(2.0 * std::numbers::pi * static_cast<double>(number) * r[along] / box.size[along]);
    return f;
  }
  const int c = direction_of(amplitude);
  const double k_c = wave_number(box, c), k_a = wave_number(box, along);
  f[c] *= std::sin(k_c * r[c]) * std::cos(k_a * r[along]);
  f[along] = -k_c / k_a * amplitude[c] * std::cos(k_c * r[c]) * std::sin(k_a * r[along]);
  return f;
}

template <int D>
int direction_of(const Vec<D>& v) {
  int c = 0;
  while (c + 1 < D && v[c] == 0.0) ++c;
  return c;
}

#define ODPD_INSTANTIATE(D)                                                             \
  template int direction_of<D>(const Vec<D>&);                                          \
  template double FlowWave::wave_number<D>(const Box<D>&, int) const;                   \
  template double FlowWave::wave_number_squared<D>(const Box<D>&, const Vec<D>&) const; \
  template double FlowWave::largest<D>(const Box<D>&, const Vec<D>&) const;             \
  template Vec<D> FlowWave::at<D>(const Vec<D>&, const Box<D>&, const Vec<D>&) const;
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
