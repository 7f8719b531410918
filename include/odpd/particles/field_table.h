#pragma once
// Named per-particle fields: registered once, then reordered, saved and loaded without being named again.
#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "odpd/core/archive.h"
#include "odpd/core/index.h"
#include "odpd/core/vec.h"
#include "odpd/particles/group.h"

namespace odpd {

template <int D>
class FieldTable {
 public:
  using Integers = std::array<std::int32_t, index(D)>;
  using Column =
      std::variant<std::vector<Vec<D>>*, std::vector<Integers>*, std::vector<double>*,
                   std::vector<std::int32_t>*, std::vector<std::int64_t>*, std::vector<Group>*>;

  /// The vector must outlive the table; all registered vectors have one entry per particle.
  void add(std::string name, Column column) { fields_.push_back({std::move(name), column}); }

  /// Entry k becomes the old entry order[k], in every field.
  void reorder(const std::vector<std::int32_t>& order);
  void resize(std::size_t n);
  void save(StateWriter& out) const;
  /// Throws IoError when a field is missing or of another length than the others.
  void load(const StateReader& in);

 private:
  struct Field {
    std::string name;
    Column column;
  };
  std::vector<Field> fields_;
};

}  // namespace odpd
