#pragma once
// Counter-based random numbers: Philox4x64-10 (Salmon et al. 2011) from Random123.
//
//   key = (seed, stream), counter = (step, stage, a, b)  ->  4 x 64 random bits
//
// Nothing is stored and nothing is drawn in sequence, so numbers depend neither on the order of the
// particles in memory nor on threads or restarts.
//
// The noise of the edges, millions of numbers per step, comes from the generator's smaller sister Philox4x32-10:
//
//   key = seed (64 bits), counter = (a, b, 64 bits of 2 step + stage)  ->  4 x 32 random bits
//
// For one seed the map from counters to bits is one to one, so any two of (step < 2^63, stage 0 or 1, a, b < 2^32)
// differ in them. No other purpose draws from it, which keeps it apart from all the streams below.
#include <array>
#include <cstdint>
#include <span>

namespace odpd {

/// What a number is for. Two uses never share a stream, so adding one changes no other. In brackets: the counter.
enum class Stream : std::uint64_t {
  pair_noise = 1,  ///< stands for F_B of the edges, drawn by PairRandom (stage 0 along, 1 across)
  start_positions = 2,    ///< random filling (0, attempt, id, 0)
  start_species = 3,      ///< which particle gets which species (0, 0, id, 0)
  overlap_direction = 4,  ///< fixed direction of an edge at r = 0 (0, 0, lower id, higher id)
  probe = 5,              ///< random vectors of tests and of `compare` (k, 0, i, 0)
  start_velocities = 6,   ///< Maxwell velocities of particles with mass (0, 0, id, 0)
  drag_noise = 7,         ///< noise of the uniform drag zeta_0 (step, 0, id, 0)
  /// Trial moves (sweep, 0, id, 0): D displacements, acceptance. Of bodies (sweep, 1, body, 0), their turns
  /// (sweep, 2, body, 0).
  monte_carlo = 8,
  /// Positions and orientations of bodies (attempt, 0 or 1, body, 0), and where they go when dense ones are mixed
  /// (sweep, 2, body, 0).
  body_poses = 9,
  /// Positions of molecules (attempt, 0, molecule, 0), turns (attempt, 1, molecule, 0), steps of a walk
  /// (attempt, 2 + trial, molecule, bead).
  molecules = 12,
  body_sizes = 13,  ///< radii of bodies (attempt, 0, which [[body]], which of its bodies)
  /// Loads of the observer `mobility`: which bodies or molecules are loaded (step, 0, which, 0), signs of random forces
  /// (step, 1, which, 0) and torques (step, 2, which, 0).
  loads = 14,
};

/// Uniform and normal numbers of one seed and stream.
class CounterRandom {
 public:
  CounterRandom(std::uint64_t seed, Stream stream);
  /// Four uniform numbers in the open interval (0, 1).
  std::array<double, 4> uniforms(std::uint64_t step, std::uint64_t stage, std::uint64_t a,
                                 std::uint64_t b) const;
  /// Four independent standard normal numbers (Box-Muller).
  std::array<double, 4> normals(std::uint64_t step, std::uint64_t stage, std::uint64_t a,
                                std::uint64_t b) const;
  /// The first of `normals`, for the price of one.
  double normal(std::uint64_t step, std::uint64_t stage, std::uint64_t a, std::uint64_t b) const;

 private:
  std::uint64_t seed_;
  std::uint64_t stream_;
};

/// Independent standard normal numbers of many pairs (a, b) in one step, by Box-Muller, sqrt(-2 log u) cos(2 pi v),
/// with polynomials for log and cos whose relative error is below 1e-12. Bits are those of the instruction path
/// (core/isa.h), whatever the number of pairs asked for at once.
class PairRandom {
 public:
  PairRandom(std::uint64_t seed, std::uint64_t step) : seed_(seed), step_(step) {}
  /// One number per pair: u of 52 bits, v of 32; |w| <= 8.6.
  void one(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b,
           std::span<double> w) const;
  /// Four per pair, out[c][k], independent of `one`: u of 40 bits, v of 24; |w| <= 7.6.
  void four(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b,
            const std::array<std::span<double>, 4>& w) const;

 private:
  std::uint64_t seed_, step_;
};

}  // namespace odpd
