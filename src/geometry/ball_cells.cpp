#include "odpd/geometry/ball_cells.h"

#include <limits>

#include "odpd/core/index.h"

namespace odpd {

template <int D>
std::size_t BallCells<D>::cell_of(const Grid& grid, const Vec<D>& centre) const {
  const Vec<D> s = grid_place(centre);
  std::int64_t cell = 0;
  for (int c = D - 1; c >= 0; --c) {
    const std::int64_t n = grid.count[index(c)];
    const double k = cell_coordinate(grid, s[c], c);
    // Outside a bounded direction (or not a number): the border cell.
    cell = cell * n +
           (k > 0.0 ? static_cast<std::int64_t>(std::min(k, static_cast<double>(n - 1))) : 0);
  }
  return index(cell);
}

template <int D>
void BallCells<D>::insert(std::size_t k) {
  Ball& ball = balls_[k];
  Grid& grid = grids_[ball.grid];
  ball.cell = cell_of(grid, ball.centre);
  ball.next = grid.first[ball.cell];
  grid.first[ball.cell] = static_cast<std::int32_t>(k);
}

// As wide as a ball, or wider where there would be more than a few cells per ball.
template <int D>
void BallCells<D>::choose_cells(std::size_t g) {
  Grid& grid = grids_[g];
  grid.room = 2 * grid.size + 8;
  double longest = 0.0;
  for (int c = 0; c < D; ++c) longest = std::max(longest, box_.size[c]);
  double width = std::max(2.0 * grid.largest, longest / static_cast<double>(2 * grid.room));
  double cells = 0.0;
  do {
    cells = 1.0;
    for (int c = 0; c < D; ++c) {
      const double n = std::max(1.0, std::floor(box_.size[c] / width));
      grid.count[index(c)] = static_cast<std::int64_t>(n);
      cells *= n;
    }
    width *= 1.25;
  } while (cells > static_cast<double>(2 * grid.room));
  grid.first.assign(static_cast<std::size_t>(cells), -1);
  for (std::size_t k = 0; k < balls_.size(); ++k)
    if (balls_[k].grid == g) insert(k);
}

template <int D>
void BallCells<D>::add(const Vec<D>& centre, double radius) {
  constexpr int points = std::numeric_limits<int>::min();
  const int exponent = radius > 0.0 ? std::ilogb(radius) : points;
  const auto at = std::find_if(grids_.begin(), grids_.end(),
                               [&](const Grid& grid) { return grid.exponent == exponent; });
  const auto g = static_cast<std::size_t>(at - grids_.begin());
  if (at == grids_.end()) {
    grids_.emplace_back();
    grids_.back().exponent = exponent;
    grids_.back().largest = radius;
  }
  Grid& grid = grids_[g];
  grid.largest = std::max(grid.largest, radius);
  ++grid.size;
  balls_.push_back({centre, radius, g, 0, -1});
  if (grid.size > grid.room) {
    choose_cells(g);
  } else {
    insert(balls_.size() - 1);
  }
}

template <int D>
void BallCells<D>::move(std::size_t k, const Vec<D>& centre) {
  Ball& ball = balls_[k];
  Grid& grid = grids_[ball.grid];
  std::int32_t* link = &grid.first[ball.cell];
  while (index(*link) != k) link = &balls_[index(*link)].next;
  *link = ball.next;
  ball.centre = centre;
  insert(k);
}

template class BallCells<2>;
template class BallCells<3>;

}  // namespace odpd
