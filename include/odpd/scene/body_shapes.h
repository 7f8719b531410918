#pragma once
// Sites of bodies whose shape has a name. On a surface of revolution, s(x) its radius at x along the axis, N sites stand at equal
// areas along the axis, each turned by the golden angle from the one before,
//
//   A(x_k) = (k + 1/2) A/N,   phi_k = k pi (3 - sqrt 5),   A(x) = int_-a^x 2 pi s sqrt(1 + s'^2) dx',   N = A/spacing^2
//
// so that there are 1/spacing^2 per area everywhere, whatever the surface (Vogel 1979 on a disk, Swinbank & Purser 2006 on a
// sphere). As no stretch that keeps areas brings the points of this lattice near each other, neighbours are
// sqrt(2/sqrt 5) = .946 spacing apart or more, at the ends of the axis .87; on bodies few spacings thick less, at .1 of the length .6. Areas:
//
//   spherocylinder of length L   A = 2 pi R L, its caps included (Archimedes)
//   spheroid, half axes a and b  A(x) = 2 pi a b int_-1^(x/a) sqrt(1 - e t^2) dt,   e = 1 - b^2/a^2
//
// In 2D sites stand at equal lengths along the outline. Axes lie along x; shapes are not centred yet.
#include <cstdint>
#include <vector>

#include "odpd/core/vec.h"

namespace odpd {

/// n^D points of a square or cube.
template <int D>
std::vector<Vec<D>> grid_sites(double side, std::int64_t n);

/// Evenly spaced points on a circle (in the x-y plane), put behind `points`.
template <int D>
void add_circle(double radius, std::int64_t count, std::vector<Vec<D>>& points);

/// A centre and `rings` circles of 6 k points at k radius/rings: a hexagonal disk's count.
template <int D>
std::vector<Vec<D>> disk_sites(double radius, std::int64_t rings);

/// `count` points on a sphere, about z.
template <int D>
std::vector<Vec<D>> sphere_sites(double radius, std::int64_t count);

/// Sites on a line from -length/2 to length/2, near `spacing` apart; two or more.
template <int D>
std::vector<Vec<D>> line_sites(double length, double spacing);

/// A surface (3D) or outline (2D) of given size: half its length along the axis, half its width across.
struct LongShape {
  enum class Kind { spheroid, spherocylinder } kind = Kind::spheroid;
  double half_length = 1.0, half_width = 1.0;  ///< (length)
};

/// Area of its surface, or length of its outline.
template <int D>
double surface_of(const LongShape& shape);
/// Volume, or area, inside.
template <int D>
double volume_of(const LongShape& shape);
/// `count` sites on it.
template <int D>
std::vector<Vec<D>> surface_sites(const LongShape& shape, std::int64_t count);

}  // namespace odpd
