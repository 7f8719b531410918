#pragma once
// Counter-based random numbers: Philox4x64-10 (Salmon et al. 2011) from Random123.
//
//   key = (seed, stream), counter = (step, stage, a, b)  ->  4 x 64 random bits
//
// Nothing is stored and nothing is drawn in sequence, so numbers depend neither on the order of the
// particles in memory nor on threads or restarts.
#include <array>
#include <cstdint>

namespace odpd {

/// What a number is for. Two uses never share a stream, so adding one changes no other.
enum class Stream : std::uint64_t {
  pair_noise = 1,       ///< F_B of an edge: counter (step, 0 along / 1 across, lower id, higher id)
  start_positions = 2,  ///< random filling: counter (0, attempt, id, 0)
  start_species = 3,    ///< which particle gets which species: counter (0, 0, id, 0)
  overlap_direction =
      4,      ///< fixed direction of an edge at r = 0: counter (0, 0, lower id, higher id)
  probe = 5,  ///< random vectors of tests and of `compare`: counter (k, 0, i, 0)
  start_velocities = 6,  ///< Maxwell velocities of particles with mass: counter (0, 0, id, 0)
  drag_noise = 7,        ///< noise of the uniform drag zeta_0: counter (step, 0, id, 0)
  monte_carlo = 8,       ///< trial moves: counter (sweep, 0, id, 0): D displacements, acceptance
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

}  // namespace odpd
