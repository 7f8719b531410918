#include "odpd/analysis/molecule_beads.h"

#include "odpd/core/index.h"

namespace odpd {

namespace {

template <int D>
std::vector<std::array<std::size_t, 2>> bond_tree(const MoleculeSettings<D>& m) {
  std::vector<std::array<std::size_t, 2>> tree;
  std::vector<bool> reached(m.shape.size(), false);
  reached[0] = true;
  while (tree.size() + 1 < m.shape.size()) {
    const std::size_t before = tree.size();
    for (const auto& bond : m.bonds) {
      const auto i = index(bond.i), j = index(bond.j);
      if (reached[i] == reached[j]) continue;
      tree.push_back(reached[i] ? std::array{i, j} : std::array{j, i});
      reached[i] = reached[j] = true;
    }
    if (tree.size() == before) break;
  }
  return tree;
}

}  // namespace

template <int D>
MoleculeBeads<D>::MoleculeBeads(const Scene<D>& scene) {
  for (const auto& m : scene.settings().molecules) {
    tree_.push_back(bond_tree(m));
    count_.push_back(m.shape.size());
  }
}

template <int D>
std::vector<Vec<D>> MoleculeBeads<D>::of(const Molecule& m, const Stage<D>& stage,
                                         const std::vector<std::int32_t>& index_of) const {
  const auto bead_at = [&](std::size_t bead) {
    return stage.position[index(index_of[index(m.first) + bead])];
  };
  std::vector<Vec<D>> beads(count_[m.kind]);
  for (const auto& [from, to] : tree_[m.kind])
    beads[to] = beads[from] + stage.box.separation(bead_at(to), bead_at(from));
  return beads;
}

template class MoleculeBeads<2>;
template class MoleculeBeads<3>;

}  // namespace odpd
