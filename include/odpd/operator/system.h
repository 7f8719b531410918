#pragma once
// A x = b as solvers see it: A = P^T R P + diagonal shift, symmetric positive (semi)definite,
// flat vectors of `nodes * block_size` doubles, node by node.
//
// The problem to solve is one of three (design of the null space, Phan-Thien et al. 2016, sec. 3.2):
//   regular      A is definite:                      A x = b
//   null space   A E = 0 for the translations E:     A x = Pi b,  E^T x = 0,   Pi = I - E (E^T E)^-1 E^T
//   held         A definite, centre of mass held:    Pi A x = Pi b,  E^T x = 0  (the exact problem of Scheme 2)
// A regular system or one with a null space may have further null motions U, orthonormal and orthogonal to E where E is null
// (operator/free_motions.h); then E stands for all of them.
// In all of them the true relative residual is |Pi (b - A x)| / |Pi b| with Pi = I for the regular one.
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/core/communicator.h"
#include "odpd/operator/block_csr.h"
#include "odpd/operator/translations.h"

namespace odpd {

class System {
 public:
  virtual ~System() = default;

  virtual int block_size() const = 0;      ///< unknowns per node; not the dimension of space
  virtual std::int64_t nodes() const = 0;  ///< number of nodes
  std::int64_t size() const { return nodes() * block_size(); }
  /// Which unknowns a translation moves. Here: all.
  virtual Translations translations() const { return {block_size(), nodes(), block_size()}; }

  /// y = A x; the same bits on any thread count. Sizes: size().
  virtual void apply(std::span<const double> x, std::span<double> y) const = 0;
  /// Diagonal blocks of A, row-major, nodes * b * b values.
  virtual void block_diagonal(std::span<double> blocks) const = 0;
  /// A assembled, made on first demand and kept until the generation changes.
  virtual const BlockCsr& matrix() const = 0;

  /// Positions of the nodes (nodes * space_dimension(), may be empty) and how many directions are periodic: with these a
  /// solver builds the near-null space (translations; rotations where none is periodic and velocities are all unknowns).
  virtual std::span<const double> positions() const = 0;
  virtual int space_dimension() const = 0;
  virtual int periodic_directions() const = 0;

  /// Translations are in the null space (nothing with known velocity holds the fluid, no shift).
  virtual bool translations_are_null() const = 0;
  /// U, a vector of size() numbers each: what else has A u = 0.
  virtual std::span<const std::vector<double>> null_motions() const { return {}; }
  bool singular() const { return translations_are_null() || !null_motions().empty(); }
  /// Orthonormal vectors that span the null space: E, where it is null, then U.
  std::vector<std::vector<double>> null_space() const;
  /// The centre of mass is to be held still although A is definite (the constrained problem).
  virtual bool holds_centre_of_mass() const = 0;
  bool projected() const { return singular() || holds_centre_of_mass(); }
  /// The nodes of this rank, and the ranks of the others. All ranks call what sums over vectors together: `project`, `inner_product`
  /// and `norm`, and whoever decides by entries of a vector asks all of them.
  virtual Share share() const { return {}; }
  /// x := Pi x; nothing where the problem is regular.
  void project(std::span<double> x) const {
    if (translations_are_null() || holds_centre_of_mass()) translations().remove_mean(x, share());
    if (!null_motions().empty()) remove_null_motions(x);
  }
  double inner_product(std::span<const double> a, std::span<const double> b) const {
    return share().dot(a, b, block_size());
  }
  double norm(std::span<const double> a) const { return share().norm(a, block_size()); }

  /// Changes whenever A changes.
  virtual std::uint64_t generation() const = 0;

 private:
  void remove_null_motions(std::span<double> x) const;
};

/// A System around an assembled matrix: toys in tests, matrices from elsewhere.
class AssembledSystem : public System {
 public:
  explicit AssembledSystem(BlockCsr matrix, bool translations_are_null = false,
                           bool holds_centre_of_mass = false);
  /// The same where translations move not all of the unknowns.
  AssembledSystem(BlockCsr matrix, Translations translations, bool translations_are_null,
                  bool holds_centre_of_mass);
  int block_size() const override { return matrix_.block; }
  std::int64_t nodes() const override { return matrix_.rows; }
  void apply(std::span<const double> x, std::span<double> y) const override;
  void block_diagonal(std::span<double> blocks) const override;
  const BlockCsr& matrix() const override { return matrix_; }
  std::span<const double> positions() const override { return {}; }
  Translations translations() const override { return translations_; }
  int space_dimension() const override { return translations_.components; }
  int periodic_directions() const override { return translations_.components; }
  bool translations_are_null() const override { return null_; }
  bool holds_centre_of_mass() const override { return held_; }
  std::uint64_t generation() const override { return 1; }
  Share share() const override { return share_; }
  /// From now on each of these ranks, which all have the whole matrix, owns a run of nodes.
  void share_among(const Communicator& ranks) { share_ = Share::of(ranks, nodes()); }

 private:
  BlockCsr matrix_;
  Translations translations_;
  bool null_;
  bool held_;
  Share share_;
};

}  // namespace odpd
