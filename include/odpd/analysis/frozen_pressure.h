#pragma once
// A pressure for what a frozen configuration answers to a load (analysis/frozen.h), which friction alone does not have. The answer u of
// the particles, on top of slips A at the edges (those of a flow; zero for a force), neither compresses nor dilates the fluid:
//
//   R u + G p = f,    G^T u + C A = 0,    G^T = C J,    (C s)_g = sum over edges of h_g t . s
//
// p_g are pressures at the nodes of a grid, h_g of an edge the mean of their hat functions at its free ends (at both where none is free).
// t is the tension of an edge under a pressure that is 1 everywhere:
//
//   t = c e - Z J w,    R w = J^T c e,    c = W'(r) times the number of free ends,    W = (1 - r/r_c)^2
//
// so that J^T t = 0 (but for what a drag zeta_0 takes up), torques of particles that spin included. C s with c e in place of t would be how fast densities sum_j W(r_ij) of the free
// particles change. But a smooth compression need not change those, as particles can make way for each other until they have the same
// neighbours at a smaller distance. Where one pressure everywhere pushes nobody there is no such way: only the slip of the whole is left
// in C s. All goes by pairs: momentum is kept, and uniform motion has no rate. Constituents of bodies, particles of walls and colloids of
// one particle have no pressure of their own. At an edge of a colloid r_c is the cutoff of this pair.
//
// p makes a functional of the load smallest or largest, whose value there is the one wanted, so that the error of this is of second
// order in those of p and of u:
//
//   force f:   f . R^-1 f without compression = min over p of max over u of 2 f.u - u.R u - 2 p.G^T u
//   flow A:    V eta without compression = max over p of min over u of (A + J u).Z (A + J u) + 2 p.(C A + G^T u)
//
// p is found by conjugate gradients on G^T R^-1 G p = b, a solve of R for each product. For long waves the product is the same
// for all of them, as a medium of friction resists all compression alike, and so is the mass matrix sum_i h_g(r_i) h_g'(r_i), which
// therefore is the preconditioner (as for finite elements: Elman, Silvester and Wathen 2014, section 4.2).
//
// Radii of bodies larger than r_c do not depend on the grid's spacing up to 2 r_c. The fluid's own viscosity does, as the finer the grid,
// the less can single particles give way: at 1.5 r_c it is that of a sheared fluid within 2 %, at 1 r_c 2 to 6 % above. Compare a
// suspension with the fluid on the same grid (docs/suspensions.md).
#include <optional>
#include <span>
#include <vector>

#include "odpd/dynamics/step_record.h"
#include "odpd/particles/particles.h"
#include "odpd/scene/scene.h"

namespace odpd {

/// Who has a pressure, and how far it pushes: by species.
struct PressureRange {
  double reach = 1.0;  ///< r_c of W, that of the fluid's pairs (length)
  /// Of each pair of species (PairModel::reaches), for edges of colloids; empty: `reach` for all.
  std::span<const double> reaches{};
  std::vector<char> colloid{};  ///< species without pressures of their own; empty: none
};

/// That of a scene, whose colloids are the [[molecule]] of one particle. The fluid is what most of the other particles are.
template <int D>
PressureRange pressure_range(const Scene<D>& scene);

template <int D>
class FrozenPressure {
 public:
  /// For the record's start. `spacing` of the grid (length), as near as the box
  /// allows, along the edges of the sheared cell where images slide. One solve to `tolerance`. On all ranks together. Throws SolverError.
  FrozenPressure(const Particles<D>& particles, const StepRecord<D>& record,
                 const PressureRange& range, double spacing, double tolerance);

  std::size_t nodes() const { return diagonal_.size(); }
  /// C s of slips s, one per edge; of nodes.
  std::vector<double> rates(const std::vector<Vec<D>>& slips) const;
  /// C J u of velocities u.
  std::vector<double> rates_of(const ParticleMotions<D>& motions) const;
  /// Takes out the rate of the whole, which is none in a box that keeps its volume: no pressure acts on it, J^T t = 0, so that what is seen of it
  /// is error, or the chance of a finite box in a flow.
  void drop_whole(std::vector<double>& rates) const;
  /// -G p: what this pressure pushes particles with.
  ParticleLoads<D> push(std::span<const double> pressure) const;

  struct Held {
    std::vector<double> pressure;  ///< p
    double work = 0.0;             ///< p . rates that are left
  };
  /// Adds to `motions`, on entry u without a pressure, what p moves, until `rates`, on entry C A + G^T u, are gone so far that the
  /// value hardly changes, but for that of the whole: twice in turn by less than a fifth of `tolerance` times `value`. Solves to `tolerance`. At 0.01 some 4
  /// solves find the value to 0.1 %. Throws SolverError where no pressure can.
  Held hold(std::vector<double>& rates, ParticleMotions<D>& motions, double value,
            double tolerance) const;

 private:
  struct Place {
    std::array<std::int32_t, index(D)> low{};  // the node below
    Vec<D> beyond{};                           // of it, in spacings
  };
  void place(double spacing);
  void find_tensions(const Particles<D>& particles, const PressureRange& range, double tolerance);
  ParticleLoads<D> loads_of(const std::vector<Vec<D>>& edge_force) const;
  /// The pressure at particle i is one of those of edge k.
  bool has_pressure(std::size_t i, std::size_t k) const {
    const PairNetwork<D>& network = record_.start.network;
    return free_[i] != 0 || free_[index(network.i[k])] + free_[index(network.j[k])] == 0;
  }
  /// f(g, h_g) of the nodes around particle i.
  template <class F>
  void around(std::size_t i, const F& f) const;
  std::vector<double> on_nodes(const std::vector<double>& of_particles) const;
  std::vector<double> at_particles(std::span<const double> of_nodes) const;
  /// z with M z = r, roughly.
  std::vector<double> preconditioned(const std::vector<double>& r) const;

  const StepRecord<D>& record_;
  const Communicator& ranks_;
  Share own_;
  std::array<std::int32_t, index(D)> count_{};  // nodes along each edge of the box
  std::vector<Place> place_;                    // of each particle
  std::vector<char> free_;
  std::vector<Vec<D>> tension_;   // t of each edge over the number of its pressures
  std::vector<double> weight_;    // of each particle in the mass matrix
  std::vector<double> mass_;      // sum of a row of it
  std::vector<double> diagonal_;  // of it; 0: no free particle there
};

/// Solves for one load, as a rule: one without the pressure, and those that find it.
constexpr double solves_with_pressure = 5.0;

/// Spacing of an observer's grid, in cutoffs, as near as the box allows.
constexpr double pressure_spacing = 1.5;

/// That of an observer, if wanted.
template <int D>
std::optional<FrozenPressure<D>> pressure_on(const Particles<D>& particles,
                                             const StepRecord<D>& record, const Scene<D>& scene,
                                             bool wanted, double tolerance);

}  // namespace odpd
