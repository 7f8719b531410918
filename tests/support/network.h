#pragma once
// Particles in a box with the pair network of a DPD model, and R as a dense matrix by its
// definition.
#include <cstdint>
#include <vector>

#include "odpd/geometry/pair_list.h"
#include "odpd/operator/dof_map.h"
#include "odpd/pairs/dpd.h"
#include "odpd/pairs/network.h"
#include "odpd/particles/particles.h"
#include "support/points.h"

namespace support {

template <int D>
struct Fluid {
  odpd::Box<D> box;
  odpd::Particles<D> particles;
  odpd::PairNetwork<D> network;

  Fluid(double length, bool periodic) {
    box.size = uniform_vec<D>(length);
    box.periodic.fill(periodic);
  }
  /// Random points, those below x = known_below in group 1.
  Fluid(double length, bool periodic, std::size_t count, std::uint64_t seed,
        double known_below = 0.0)
      : Fluid(length, periodic) {
    for (const auto& r : random_points<D>(odpd::Vec<D>{}, box.size, count, seed)) {
      particles.add(r, 0, r[0] < known_below ? odpd::Group::wall(0) : odpd::Group());
    }
  }
  void connect(const odpd::PairModel<D>& model, double skin = 0.3) {
    odpd::PairList<D> list(box, model.cutoff(), skin);
    list.update(particles.position);
    model.write_edges(list, box, particles.position, particles, network);
  }
};

/// Adds sign * Z of an edge to the block (row, column) of an n x n matrix.
template <int D>
void add_block(const odpd::PairNetwork<D>& network, std::size_t edge, double sign, std::int32_t row,
               std::int32_t column, std::size_t n, std::vector<double>& matrix) {
  if (row < 0 || column < 0) return;
  const odpd::Vec<D>& e = network.e[edge];
  for (int a = 0; a < D; ++a) {
    for (int b = 0; b < D; ++b) {
      const double along = e[a] * e[b];
      const double z =
          network.zeta_par[edge] * along + network.zeta_perp[edge] * ((a == b ? 1.0 : 0.0) - along);
      matrix[static_cast<std::size_t>(row * D + a) * n +
             static_cast<std::size_t>(column * D + b)] += sign * z;
    }
  }
}

/// sum over edges of J^T Z J + shift I, rows and columns of known particles left out.
template <int D>
std::vector<double> dense_resistance(const odpd::PairNetwork<D>& network,
                                     const odpd::DofMap<D>& dofs, double shift) {
  const auto n = static_cast<std::size_t>(dofs.unknowns());
  std::vector<double> matrix(n * n, 0.0);
  for (std::size_t k = 0; k < n; ++k) matrix[k * n + k] = shift;
  for (std::size_t k = 0; k < static_cast<std::size_t>(network.size()); ++k) {
    const std::int32_t i = dofs.mobile_of(static_cast<std::size_t>(network.i[k]));
    const std::int32_t j = dofs.mobile_of(static_cast<std::size_t>(network.j[k]));
    add_block(network, k, 1.0, i, i, n, matrix);
    add_block(network, k, 1.0, j, j, n, matrix);
    add_block(network, k, -1.0, i, j, n, matrix);
    add_block(network, k, -1.0, j, i, n, matrix);
  }
  return matrix;
}

inline double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double s = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) s += a[k] * b[k];
  return s;
}

inline double norm(const std::vector<double>& a) { return std::sqrt(dot(a, a)); }

}  // namespace support
