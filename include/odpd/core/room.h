#pragma once
#include <cstddef>
#include <vector>

namespace odpd {

/// Resizes what is about to be written anew. Of a large array there are never two: the old one goes before the new one
/// comes, and that has some room more, since the number of edges changes by little from one configuration to the next.
template <class T>
void resize_afresh(std::vector<T>& array, std::size_t size) {
  if (array.capacity() < size) {
    array = std::vector<T>();
    array.reserve(size + size / 32);
  }
  array.resize(size);
}

}  // namespace odpd
