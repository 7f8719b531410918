#pragma once
// Fluid around the centres of bodies or molecules (Phan-Thien et al. 2016, eq. 48):
//
//   g(q)                density of the fluid at distance q from a centre, relative to its mean
//   exclusion radius    largest r with   int_0^r g(q) S_d q^(d-1) dq <= empty r^d S_d/d,
//
// the radius of the largest ball with less than `empty` of the mean density (S_d: surface of the unit sphere). The whole
// ball counts, as a single visit trips the density of a thin shell near the centre.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "odpd/analysis/block_average.h"
#include "odpd/analysis/observer.h"

namespace odpd {

struct FluidAroundSettings {
  double r_max = 2.0;   ///< of g(q) (length)
  double bin = 0.01;    ///< its bins (length)
  double empty = 1e-3;  ///< density of a ball without fluid, relative to the mean
};

/// The keys `r_max`, `bin` and `empty`. Throws ConfigError.
template <int D>
FluidAroundSettings read_fluid_around(const ObserverEntry<D>& entry);

template <int D>
class FluidAround {
 public:
  /// `kind` of each centre, counted from 0 up to the number of `names`.
  FluidAround(FluidAroundSettings settings, std::vector<std::string> names,
              std::vector<std::size_t> kind);
  /// One sample: `centres` as many as kinds were given, anywhere; `fluid`: those of this rank's particles that are fluid;
  /// `per_particle`: the volume that one of them has. All ranks call it together.
  void add(const Stage<D>& stage, std::span<const Vec<D>> centres,
           std::span<const std::int32_t> fluid, double per_particle, const Communicator& ranks);
  /// NaN where the largest ball does not end within r_max, and without samples.
  double exclusion_radius(std::size_t kind) const;
  /// Table and chart `name`, where there are samples.
  void add_table(const std::string& name, const std::string& title, Results& results) const;
  void save(StateWriter& out) const { density_.save(out, "density"); }
  void load(const StateReader& in) { density_.load(in, "density"); }

 private:
  FluidAroundSettings settings_;
  std::vector<std::string> names_;
  std::vector<std::size_t> kind_;
  std::vector<double> share_;  // 1/centres of each kind
  std::size_t bins_;
  BlockAverage density_;  // [kind * bins + bin]
};

}  // namespace odpd
