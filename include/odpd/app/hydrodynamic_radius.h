#pragma once
// The hydrodynamic radius a of a body from what it moves by in a periodic cube (square) of edge L, one body to a cell, Stokes flow:
//
//   3D   6 pi eta a U/F = 1 - 1.7601 c^(1/3) + c - 1.5593 c^2 + 3.9799 c^(8/3) - 3.0734 c^(10/3),   c = (4 pi/3)(a/L)^3
//   2D   4 pi eta   U/F = -(ln c)/2 - .738 + c - .887 c^2 + 2.038 c^3,                             c = pi (a/L)^2
//   3D   8 pi eta a^3 w/T = 1 - c,      2D   4 pi eta a^2 w/T = 1 - c
//
// Hasimoto 1959 found the first terms (1.7601 c^(1/3) is 2.8373 a/L), Sangani & Acrivos 1982 the others; below 1 % to c = .2 in 3D and .15 in
// 2D. F is the force on the body, U its velocity relative to the mean over the cell, body included, where the opposite force is a uniform
// pressure gradient F/V. A torque T has no such counterpart: in Fourier space its flow is what it is without images, less the term k = 0,
// and that is a rotation by -c of its own (symmetry leaves no strain; the next term goes as c^(10/3)).
//
// Where no `excluded_volume` is given the observer `mobility` spreads the opposite force over all particles, the body's p too, and
// takes velocities relative to the mean of all N. With n the density of the fluid far away, a uniform force f on each of its N - p
// particles is a pressure gradient n f, and the same holds of velocities by reciprocity. So
//
//   U/F = mobility (N/(n V))^2
//
// where N/(n V) = 1 + (p - n v_ex)/(n V) has the first order in c. v_ex is the volume that a body takes from the fluid (Gibbs excess),
//
//   v_ex = V - (N - p)/n.
//
// It is an integral over all of g(q) - 1, where an exclusion radius is a threshold on g(q) near 0.
#include <cmath>
#include <cstdint>
#include <span>

namespace odpd {

/// eta U/F of a ball of radius a in a cell of edge L (1/length in 3D, a number in 2D).
double eta_mobility(int dimension, double a, double edge);
/// The radius that has it (length), by bisection. NaN beyond where the series holds: a < .4 L in 3D, .3 L in 2D.
double radius_of_mobility(int dimension, double eta_mobility, double edge);
/// The radius that has this eta w/T (1/length^d). NaN where there is none.
double radius_of_rotation(int dimension, double eta_rotation, double edge);

/// A number with its standard error.
struct Measured {
  double value = 0.0, error = 0.0;
};

/// Weighted by 1/error^2; the error is larger by sqrt(chi^2/(n - 1)) where that is above 1.
Measured weighted_mean(std::span<const Measured> values);
/// Value at 1/L = 0 of the line in 1/L through them, by weighted least squares. NaN with fewer than two edges.
Measured extrapolated(std::span<const Measured> values, std::span<const double> edges);

/// One body in one cell, as measured.
struct BodyInCell {
  int dimension = 3;
  double edge = 0.0;                      ///< L (length)
  std::int64_t particles = 0, sites = 0;  ///< N, body included, and p
  Measured translation{}, rotation{};     ///< velocity per force, angular velocity per torque
  Measured density{};                     ///< n (1/length^d)
  std::int64_t samples = 0;               ///< configurations
  double volume() const;
  double fluid() const { return static_cast<double>(particles - sites); }
};

/// v_ex (length^d).
Measured excluded_volume(const BodyInCell& cell);
/// Of the fluid alone: eta at a density, and as which power of the density it goes near it.
struct FluidViscosity {
  double eta = 1.0, density = 1.0, exponent = 2.0;
  double at(double n) const { return eta * std::pow(n / density, exponent); }
};
/// By the drag, and by the torque; errors of the mobilities and of n, not of eta. (With the exponent 2 the drag's does not depend on n.)
Measured drag_radius(const BodyInCell& cell, const FluidViscosity& fluid);
Measured torque_radius(const BodyInCell& cell, const FluidViscosity& fluid);

}  // namespace odpd
