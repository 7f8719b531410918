#include "odpd/particles/field_table.h"

#include <fmt/format.h>

#include <type_traits>

#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

namespace {

// Every field is stored flat: doubles as doubles, integers as 64-bit integers.
template <class T>
struct Flat {
  static constexpr std::size_t width = 1;
  using Scalar = std::conditional_t<std::is_floating_point_v<T>, double, std::int64_t>;
  static Scalar at(const T& value, std::size_t) { return value; }
  static void set(T& value, std::size_t, Scalar s) { value = static_cast<T>(s); }
};
template <int D>
struct Flat<Vec<D>> {
  static constexpr std::size_t width = index(D);
  using Scalar = double;
  static double at(const Vec<D>& v, std::size_t c) { return v.x[c]; }
  static void set(Vec<D>& v, std::size_t c, double s) { v.x[c] = s; }
};
template <std::size_t N>
struct Flat<std::array<std::int32_t, N>> {
  static constexpr std::size_t width = N;
  using Scalar = std::int64_t;
  static std::int64_t at(const std::array<std::int32_t, N>& v, std::size_t c) { return v[c]; }
  static void set(std::array<std::int32_t, N>& v, std::size_t c, std::int64_t s) {
    v[c] = static_cast<std::int32_t>(s);
  }
};

template <>
struct Flat<Group> {
  static constexpr std::size_t width = 1;
  using Scalar = std::int64_t;
  static Scalar at(Group group, std::size_t) { return group.code(); }
  static void set(Group& group, std::size_t, Scalar s) { group = Group::of_code(s); }
};

template <class T>
std::vector<typename Flat<T>::Scalar> flatten(const std::vector<T>& values) {
  std::vector<typename Flat<T>::Scalar> flat;
  flat.reserve(values.size() * Flat<T>::width);
  for (const T& v : values)
    for (std::size_t c = 0; c < Flat<T>::width; ++c) flat.push_back(Flat<T>::at(v, c));
  return flat;
}

template <class T>
void restore(const StateReader& in, const std::string& name, std::vector<T>& values) {
  std::vector<typename Flat<T>::Scalar> flat;
  if constexpr (std::is_same_v<typename Flat<T>::Scalar, double>) {
    flat = in.read_doubles(name);
  } else {
    flat = in.read_integers(name);
  }
  if (flat.size() % Flat<T>::width != 0)
    throw IoError(
        fmt::format("the checkpoint holds {} numbers in '{}', not a multiple of {}: it is damaged",
                    flat.size(), name, Flat<T>::width));
  values.resize(flat.size() / Flat<T>::width);
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t c = 0; c < Flat<T>::width; ++c)
      Flat<T>::set(values[i], c, flat[i * Flat<T>::width + c]);
}

}  // namespace

template <int D>
void FieldTable<D>::reorder(const std::vector<std::int32_t>& order) {
  for (Field& field : fields_)
    std::visit(
        [&](auto* column) {
          auto moved = *column;
          for (std::size_t k = 0; k < order.size(); ++k) moved[k] = (*column)[index(order[k])];
          column->swap(moved);
        },
        field.column);
}

template <int D>
void FieldTable<D>::resize(std::size_t n) {
  for (Field& field : fields_) std::visit([&](auto* column) { column->resize(n); }, field.column);
}

template <int D>
void FieldTable<D>::save(StateWriter& out) const {
  for (const Field& field : fields_)
    std::visit([&](auto* column) { out.write(field.name, flatten(*column)); }, field.column);
}

template <int D>
void FieldTable<D>::load(const StateReader& in) {
  std::size_t size = 0;
  for (std::size_t k = 0; k < fields_.size(); ++k)
    std::visit(
        [&](auto* column) {
          restore(in, fields_[k].name, *column);
          if (k > 0 && column->size() != size)
            throw IoError(fmt::format(
                "the checkpoint holds {} particles in '{}' but {} in '{}': it is damaged",
                column->size(), fields_[k].name, size, fields_[0].name));
          size = column->size();
        },
        fields_[k].column);
}

template class FieldTable<2>;
template class FieldTable<3>;

}  // namespace odpd
