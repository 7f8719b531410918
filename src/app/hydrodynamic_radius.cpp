#include "odpd/app/hydrodynamic_radius.h"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

namespace odpd {

namespace {

constexpr double pi = std::numbers::pi;

double largest_radius(int dimension, double edge) { return (dimension > 2 ? 0.4 : 0.3) * edge; }

// What an error of x makes of f(x).
double propagated(const std::function<double(double)>& f, const Measured& x) {
  return 0.5 * std::abs(f(x.value + x.error) - f(x.value - x.error));
}

}  // namespace

double eta_mobility(int dimension, double a, double edge) {
  const double q = a / edge;
  if (dimension < 3) {
    const double c = pi * q * q;
    return (-0.5 * std::log(c) - 0.738 + c * (1.0 - c * (0.887 - 2.038 * c))) / (4.0 * pi);
  }
  const double c = 4.0 / 3.0 * pi * q * q * q, root = std::cbrt(c);
  const double more = std::pow(root, 8) * (3.9799 - 3.0734 * root * root);
  return (1.0 - 1.7601 * root + c - 1.5593 * c * c + more) / (6.0 * pi * a);
}

double radius_of_mobility(int dimension, double eta_mobility_asked, double edge) {
  double low = 1e-6 * edge, high = largest_radius(dimension, edge);
  if (!(eta_mobility_asked >= eta_mobility(dimension, high, edge)) ||
      !(eta_mobility_asked <= eta_mobility(dimension, low, edge)))
    return std::numeric_limits<double>::quiet_NaN();
  constexpr int halvings = 60;
  for (int k = 0; k < halvings; ++k) {
    const double middle = 0.5 * (low + high);
    (eta_mobility(dimension, middle, edge) > eta_mobility_asked ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double radius_of_rotation(int dimension, double eta_rotation, double edge) {
  if (dimension < 3) return 1.0 / std::sqrt(4.0 * pi * eta_rotation + pi / (edge * edge));
  return 1.0 / std::cbrt(8.0 * pi * eta_rotation + 4.0 * pi / (3.0 * edge * edge * edge));
}

Measured weighted_mean(std::span<const Measured> values) {
  double sum = 0.0, weights = 0.0, chi = 0.0;
  for (const Measured& m : values) {
    const double w = 1.0 / (m.error * m.error);
    sum += w * m.value;
    weights += w;
  }
  const double mean = sum / weights;
  for (const Measured& m : values) chi += std::pow((m.value - mean) / m.error, 2);
  const double spread =
      values.size() > 1 ? std::max(1.0, chi / static_cast<double>(values.size() - 1)) : 1.0;
  return {mean, std::sqrt(spread / weights)};
}

Measured extrapolated(std::span<const Measured> values, std::span<const double> edges) {
  double w0 = 0.0, w1 = 0.0, w2 = 0.0, y0 = 0.0, y1 = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double w = 1.0 / (values[k].error * values[k].error), x = 1.0 / edges[k];
    w0 += w;
    w1 += w * x;
    w2 += w * x * x;
    y0 += w * values[k].value;
    y1 += w * x * values[k].value;
  }
  const double determinant = w0 * w2 - w1 * w1;
  if (!(determinant > 1e-9 * w0 * w2))
    return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  return {(w2 * y0 - w1 * y1) / determinant, std::sqrt(w2 / determinant)};
}

double BodyInCell::volume() const { return std::pow(edge, dimension); }

Measured excluded_volume(const BodyInCell& cell) {
  const double n = cell.density.value;
  return {cell.volume() - cell.fluid() / n, cell.fluid() / (n * n) * cell.density.error};
}

namespace {

// Of radius(mobility, n).
Measured radius_with_error(const std::function<double(double, double)>& radius,
                           const Measured& mobility, const Measured& density) {
  const double m = mobility.value, n = density.value;
  return {radius(m, n), std::hypot(propagated([&](double x) { return radius(x, n); }, mobility),
                                   propagated([&](double x) { return radius(m, x); }, density))};
}

}  // namespace

Measured drag_radius(const BodyInCell& cell, const FluidViscosity& fluid) {
  const double mean = static_cast<double>(cell.particles) / cell.volume();
  const auto radius = [&](double mobility, double n) {
    return radius_of_mobility(cell.dimension, fluid.at(n) * mobility * std::pow(mean / n, 2),
                              cell.edge);
  };
  return radius_with_error(radius, cell.translation, cell.density);
}

Measured torque_radius(const BodyInCell& cell, const FluidViscosity& fluid) {
  const auto radius = [&](double w, double n) {
    return radius_of_rotation(cell.dimension, fluid.at(n) * w, cell.edge);
  };
  return radius_with_error(radius, cell.rotation, cell.density);
}

}  // namespace odpd
