#pragma once
// index(i) = i: identities, rows and counts are signed here (std::int32_t, std::int64_t, int), subscripts of the
// standard library are not.
#include <concepts>
#include <cstddef>
#include <type_traits>

namespace odpd {

/// Subscript of a container for a count, row or identity i >= 0, or for a name of an enumeration.
template <class Number>
requires std::integral<Number> || std::is_enum_v<Number>
constexpr std::size_t index(Number i) { return static_cast<std::size_t>(i); }

}  // namespace odpd
