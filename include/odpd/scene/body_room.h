#pragma once
// Where bodies leave no room to start for fluid and molecules: in the ball around all of a body's sites,
//
//   |r - X| < R,   R = max_k |a_k|
//
// and of a long or flat body, whose narrowest width is less than 1.1 R, also between the planes that touch its sites,
//
//   min_k n.a_k < n.(r - X) < max_k n.a_k   for many directions n of its frame
//
// as its ball would keep the fluid away from much that is not the body. The axis of a rod or an ellipsoid and what is across to it
// are among these directions, so that a line of sites takes no room.
#include <vector>

#include "odpd/geometry/ball_cells.h"
#include "odpd/particles/particles.h"

namespace odpd {

template <int D>
class BodyRoom {
 public:
  BodyRoom(const Box<D>& box, const Particles<D>& particles);
  /// Whether r lies in a body; r inside the box along periodic directions.
  bool holds(const Vec<D>& r) const;

 private:
  struct Slab {
    Vec<D> normal;
    double low, high;  // of n.a_k (length)
  };
  Box<D> box_;
  BallCells<D> balls_;
  std::vector<std::vector<Slab>> slabs_;  // of each body; none where its ball is enough
};

}  // namespace odpd
