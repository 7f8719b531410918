#pragma once
// Who moves a particle.
#include <cstdint>

namespace odpd {

/// Nobody: it is free (fluid). Or a wall or a body of known motion: its velocity is known. Or a rigid body of unknown motion.
class Group {
 public:
  constexpr Group() = default;  ///< free
  /// Wall of the scene, counted from 0.
  static constexpr Group wall(std::int32_t wall) { return Group(wall + 1); }
  /// Body of known motion, where there are so many walls.
  static constexpr Group known_body(std::int32_t body, std::int32_t walls) {
    return Group(walls + body + 1);
  }
  static constexpr Group free_body(std::int32_t body) { return Group(-(body + 1)); }
  /// As files have it: 0 free, k + 1 of wall k or, above the walls, of known body k - walls; -(k + 1) of body k of unknown motion.
  static constexpr Group of_code(std::int64_t code) {
    return Group(static_cast<std::int32_t>(code));
  }
  constexpr std::int32_t code() const { return code_; }

  constexpr bool is_free() const { return code_ == 0; }
  constexpr bool is_known() const { return code_ > 0; }
  constexpr bool in_free_body() const { return code_ < 0; }
  /// The wall or, from `walls` on, the body of known motion that moves it.
  constexpr std::int32_t known_mover() const { return code_ - 1; }
  /// Of Particles::bodies; -1 where it belongs to none.
  constexpr std::int32_t body(std::int32_t walls) const {
    if (code_ < 0) return -code_ - 1;
    return code_ > walls ? code_ - 1 - walls : -1;
  }

  friend constexpr bool operator==(Group, Group) = default;
  /// Two of known velocity, or of one body, which exert nothing on each other that moves them.
  friend constexpr bool rigid_pair(Group a, Group b) {
    return a.is_known() ? b.is_known() : !a.is_free() && a == b;
  }

 private:
  explicit constexpr Group(std::int32_t code) : code_(code) {}
  std::int32_t code_ = 0;
};

}  // namespace odpd
