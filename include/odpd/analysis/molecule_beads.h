#pragma once
// Where the beads of a molecule are, whatever faces of the box lie between them: bond by bond from the first on.
#include <array>
#include <vector>

#include "odpd/dynamics/step_record.h"
#include "odpd/scene/scene.h"

namespace odpd {

template <int D>
class MoleculeBeads {
 public:
  explicit MoleculeBeads(const Scene<D>& scene);
  /// Seen from its first (length); index_of: the particles' index_of_id().
  std::vector<Vec<D>> of(const Molecule& m, const Stage<D>& stage,
                         const std::vector<std::int32_t>& index_of) const;

 private:
  // Of each kind: bonds that reach all beads from the first on, as (bead reached already, next bead).
  std::vector<std::vector<std::array<std::size_t, 2>>> tree_;
  std::vector<std::size_t> count_;  // beads
};

}  // namespace odpd
