#pragma once
// Transverse waves in a periodic box, the modes that displacements of particles are projected on:
//
//   phi_i = e_c cos(k r_d) or e_c sin(k r_d),   k = 2 pi number/edge along d, c != d
//
// for each wave number all directions d, all components c across it and both phases. Longitudinal waves (c = d) come with
// them where one asks for them.
#include <cstdint>
#include <string>
#include <vector>

#include "odpd/pairs/network.h"
#include "odpd/particles/particles.h"

namespace odpd {

template <int D>
class Waves {
 public:
  struct Mode {
    std::size_t wave = 0;  ///< which of the wave numbers
    int axis = 0, component = 0;
    bool sine = false;
  };

  /// numbers: waves in the edge, ascending; axes: directions of k, along which the box has this edge.
  Waves(std::vector<std::int64_t> numbers, std::vector<int> axes, double edge,
        bool longitudinal = false);

  std::size_t count() const { return numbers_.size(); }
  std::int64_t number(std::size_t wave) const { return numbers_[wave]; }
  double k(std::size_t wave) const;
  /// By wave number.
  const std::vector<Mode>& modes() const { return modes_; }
  /// `prefix`_<number>_<axis><component>_<phase> of each, for a series.
  std::vector<std::string> names(const std::string& prefix) const;
  std::size_t modes_per_wave() const { return modes_.size() / numbers_.size(); }

  /// phi of a mode at these positions.
  std::vector<Vec<D>> shape(const Mode& mode, const std::vector<Vec<D>>& position) const;
  /// sum_i phi_i . vector_i of every mode; all ranks together, as what follows.
  std::vector<double> sums(const Particles<D>& particles, const std::vector<Vec<D>>& position,
                           const std::vector<Vec<D>>& vector) const;
  /// phi R phi of each wave number, the mean over its transverse modes: power per velocity squared of particles that follow
  /// the wave.
  std::vector<double> friction(const Particles<D>& particles, const PairNetwork<D>& network) const;

 private:
  void add_sums(std::size_t first, std::size_t last, const std::vector<Vec<D>>& position,
                const std::vector<Vec<D>>& vector, double* sum) const;

  std::vector<std::int64_t> numbers_;
  std::vector<int> axes_;
  double edge_;
  bool longitudinal_;
  std::vector<Mode> modes_;
};

}  // namespace odpd
