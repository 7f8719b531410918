#pragma once
// Where the constituents of rigid bodies lie in memory, body after body, and loops over bodies.
#include <algorithm>
#include <cstdint>
#include <exception>
#include <span>
#include <vector>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/particles/particles.h"

namespace odpd {

/// Of all bodies of some particles, until these are reordered.
class Constituents {
 public:
  Constituents() = default;
  template <int D>
  explicit Constituents(const Particles<D>& particles) {
    if (particles.bodies.empty()) return;
    const std::vector<std::int32_t> index_of = particles.index_of_id();
    begin_.push_back(0);
    for (const RigidBody<D>& body : particles.bodies) {
      for (const std::int64_t id : body.members) particle_.push_back(index_of[index(id)]);
      begin_.push_back(particle_.size());
    }
  }

  std::size_t bodies() const { return begin_.empty() ? 0 : begin_.size() - 1; }
  /// Indices in memory, in the order of the body's `members`.
  std::span<const std::int32_t> operator[](std::size_t body) const {
    return std::span(particle_).subspan(begin_[body], begin_[body + 1] - begin_[body]);
  }

 private:
  std::vector<std::int32_t> particle_;
  std::vector<std::size_t> begin_;  // of each body in particle_, and the end; empty without bodies
};

/// Room for one body at a time.
template <int D>
struct BodyScratch {
  std::vector<Vec<D>> arms, values;
};

/// body(b, scratch) for 0 <= b < n, each b once, on any thread and in any order; the scratch is left as the last body had it.
/// An error ends the bodies of its range alone; when all have ended, that of the lowest range is thrown.
template <int D, class Body>
void for_each_body(std::size_t n, const Body& body) {
  constexpr std::size_t range = 16;
  std::vector<std::exception_ptr> failure((n + range - 1) / range);
  parallel_blocks(static_cast<std::int64_t>(failure.size()), [&](std::int64_t block) {
    const std::size_t k = index(block);
    BodyScratch<D> scratch;
    try {
      for (std::size_t b = k * range; b < std::min(n, (k + 1) * range); ++b) body(b, scratch);
    } catch (...) {
      failure[k] = std::current_exception();
    }
  });
  for (const std::exception_ptr& f : failure)
    if (f) std::rethrow_exception(f);
}

}  // namespace odpd
