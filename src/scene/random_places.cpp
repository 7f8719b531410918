#include "odpd/scene/random_places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "odpd/core/index.h"
#include "odpd/core/random.h"

namespace odpd {

namespace {

// What walls and the balls that are there leave.
template <int D>
struct OpenSpace {
  const Box<D>& box;
  const Vec<D>&low, &high;
  const BallCells<D>& there;

  bool holds(const Vec<D>& r, double radius) const {
    for (int c = 0; c < D; ++c)
      if (!box.is_periodic(c) && (r[c] - low[c] < radius || high[c] - r[c] < radius)) return false;
    return !there.overlaps(r, radius);
  }
};

// Balls too dense for one after the other to find a place.
template <int D>
class Packing {
 public:
  Packing(const OpenSpace<D>& space, std::span<const double> radii, std::vector<Vec<D>> centres)
      : space_(space), radii_(radii), x_(std::move(centres)) {}

  /// The largest scale without overlap, more than 1 where there is room to spare.
  double grow();
  void mix(const CounterRandom& random);
  std::vector<Vec<D>> take() { return std::move(x_); }

 private:
  struct Pair {
    std::int32_t i, j;
    bool fixed;    // j is one of those that are there
    double touch;  // distance
  };
  double start_scale() const;
  void list_pairs(double scale);
  bool moved_far() const;
  bool overlap() const;
  bool push();
  bool relax(double scale);
  const Vec<D>& partner(const Pair& p) const {
    return p.fixed ? space_.there.centre(index(p.j)) : x_[index(p.j)];
  }

  // Pushed a little further than to where they touch: so it takes few sweeps, and rounding does not matter.
  static constexpr double spare = 1.0 + 1e-3;
  static constexpr double growth = 1.02;  // of the scale, in a step

  const OpenSpace<D>& space_;
  const Box<D>& box_ = space_.box;
  std::span<const double> radii_;
  std::vector<Vec<D>> x_;
  std::vector<Pair> pairs_;        // nearer than touching and the skin
  std::vector<Vec<D>> reference_;  // x when they were listed
  double skin_ = 0.0;
};

// Without std::pow, whose last bit depends on the machine.
template <int D>
double Packing<D>::start_scale() const {
  constexpr double loose = 0.4;
  const auto volume = [](double radius) {
    double v = unit_ball_volume<D>;
    for (int c = 0; c < D; ++c) v *= radius;
    return v;
  };
  double all = 0.0;
  for (const double radius : radii_) all += volume(std::max(radius, 0.0));
  const double room = loose * Box<D>{space_.high - space_.low, {}}.volume();
  double scale = 1.0;
  while (all * volume(scale) > unit_ball_volume<D> * room) scale /= growth;
  return scale;
}

// The balls that are there and the ends have their full size from the beginning: a small ball must not slip to where a grown one
// does not get out.
template <int D>
void Packing<D>::list_pairs(double scale) {
  skin_ = 0.5 * scale * std::accumulate(radii_.begin(), radii_.end(), 0.0) /
          static_cast<double>(radii_.size());
  pairs_.clear();
  reference_ = x_;
  BallCells<D> before(box_);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const auto list = [&](const BallCells<D>& balls, std::size_t j, bool fixed, double touch) {
      if (norm(box_.separation(x_[i], balls.centre(j))) < spare * touch + skin_)
        pairs_.push_back(
            {static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), fixed, touch});
      return false;
    };
    space_.there.find_near(x_[i], spare * radii_[i] + skin_, [&](std::size_t j) {
      return list(space_.there, j, true, radii_[i] + space_.there.radius(j));
    });
    before.find_near(x_[i], spare * scale * radii_[i] + skin_, [&](std::size_t j) {
      return list(before, j, false, scale * (radii_[i] + radii_[j]));
    });
    before.add(x_[i], spare * scale * radii_[i]);
  }
}

template <int D>
bool Packing<D>::moved_far() const {
  for (std::size_t i = 0; i < x_.size(); ++i)
    if (norm(box_.separation(x_[i], reference_[i])) > 0.5 * skin_) return true;
  return false;
}

template <int D>
bool Packing<D>::overlap() const {
  return std::any_of(pairs_.begin(), pairs_.end(), [&](const Pair& p) {
    return norm(box_.separation(x_[index(p.i)], partner(p))) < p.touch;
  });
}

// Whether some pair did overlap.
template <int D>
bool Packing<D>::push() {
  bool overlapped = false;
  for (const Pair& p : pairs_) {
    Vec<D>& r = x_[index(p.i)];
    Vec<D> d = box_.separation(r, partner(p));
    const double apart = norm(d), goal = spare * p.touch;
    if (apart >= goal) continue;
    overlapped = overlapped || apart < p.touch;
    if (apart > 0.0) {
      d *= (goal - apart) / apart;
    } else {
      d[p.i % D] = goal;  // in a corner of the box
    }
    r += (p.fixed ? 1.0 : 0.5) * d;
    box_.wrap(r);
    if (p.fixed) continue;
    x_[index(p.j)] -= 0.5 * d;
    box_.wrap(x_[index(p.j)]);
  }
  for (std::size_t i = 0; i < x_.size(); ++i)
    for (int c = 0; c < D; ++c) {
      if (box_.is_periodic(c)) continue;
      const double low = space_.low[c], high = space_.high[c];
      const double away = std::min(spare * radii_[i], 0.5 * (high - low));
      x_[i][c] = std::clamp(x_[i][c], low + away, std::max(high - away, low + away));
    }
  return overlapped;
}

template <int D>
bool Packing<D>::relax(double scale) {
  constexpr int most_sweeps = 1000;
  list_pairs(scale);
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    const bool overlapped = push();
    if (moved_far()) list_pairs(scale);
    if (!overlapped && !overlap()) return true;
  }
  return false;
}

template <int D>
double Packing<D>::grow() {
  // Grown beyond 1, few balls are left in touch, which mixing would take long to part.
  constexpr double ample = 1.05, finest = 1.004, least = 0.01;
  double reached = 0.0, failed = std::numeric_limits<double>::infinity();
  std::vector<Vec<D>> best = x_;
  for (double scale = start_scale(); scale > least;) {
    if (relax(scale)) {
      reached = scale;
      best = x_;
    } else {
      failed = scale;
      x_ = best;
    }
    const bool done = reached >= 1.0 && (reached >= ample || std::isfinite(failed));
    if (done || failed < finest * reached) break;
    if (reached == 0.0) {
      scale *= 0.9;
    } else {
      scale = reached < 1.0 ? std::min(growth * reached, 1.0) : growth * reached;
      if (scale >= failed) scale = std::sqrt(reached * failed);
    }
  }
  x_ = best;
  return std::max(reached, least);
}

template <int D>
void Packing<D>::mix(const CounterRandom& random) {
  constexpr std::uint64_t sweeps = 200;
  constexpr double wanted_acceptance = 0.4;
  BallCells<D> balls(box_);
  for (std::size_t i = 0; i < x_.size(); ++i) balls.add(x_[i], radii_[i]);
  double step = 0.2 * *std::max_element(radii_.begin(), radii_.end());
  const double longest = 0.5 * *std::min_element(box_.size.x.begin(), box_.size.x.end());
  for (std::uint64_t sweep = 0; sweep < sweeps; ++sweep) {
    std::size_t accepted = 0;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const auto u = random.uniforms(sweep, 2, i, 0);
      Vec<D> r = x_[i];
      for (int c = 0; c < D; ++c) r[c] += step * (2.0 * u[index(c)] - 1.0);
      box_.wrap(r);
      if (!space_.holds(r, radii_[i]) || balls.overlaps(r, radii_[i], i)) continue;
      x_[i] = r;
      balls.move(i, r);
      ++accepted;
    }
    const double share = static_cast<double>(accepted) / static_cast<double>(x_.size());
    step = std::min(step * (1.0 + share - wanted_acceptance), longest);
  }
}

// One ball after the other.
template <int D>
class SequentialPlaces {
 public:
  SequentialPlaces(const OpenSpace<D>& space, std::span<const double> radii,
                   const CounterRandom& random)
      : space_(space), radii_(radii), random_(random), placed_(space.box) {}

  /// Ball k goes to a place clear of all.
  bool place(std::size_t k) {
    if (!find(k, [&](const Vec<D>& r) { return !placed_.overlaps(r, radii_[k]); })) return false;
    placed_.add(found.centres.back(), radii_[k]);
    return true;
  }
  /// Ball k goes to a place clear of what is there, but perhaps not of those before it.
  bool leave(std::size_t k) {
    return find(k, [](const Vec<D>&) { return true; });
  }
  RandomPlaces<D> found;

 private:
  template <class IsFree>
  bool find(std::size_t k, const IsFree& is_free) {
    constexpr std::uint64_t most_attempts = 10000;
    for (std::uint64_t attempt = 0; attempt < most_attempts; ++attempt) {
      const auto u = random_.uniforms(attempt, 0, k, 0);
      Vec<D> r;
      for (int c = 0; c < D; ++c)
        r[c] = space_.low[c] + (space_.high[c] - space_.low[c]) * u[index(c)];
      if (!space_.holds(r, radii_[k]) || !is_free(r)) continue;
      found.centres.push_back(r);
      found.attempts.push_back(attempt);
      return true;
    }
    return false;
  }

  const OpenSpace<D>& space_;
  std::span<const double> radii_;
  const CounterRandom& random_;
  BallCells<D> placed_;
};

}  // namespace

template <int D>
RandomPlaces<D> find_random_places(const Box<D>& box, const Vec<D>& low, const Vec<D>& high,
                                   const BallCells<D>& there, std::span<const double> radii,
                                   std::uint64_t seed) {
  const CounterRandom random(seed, Stream::body_poses);
  const OpenSpace<D> space{box, low, high, there};
  SequentialPlaces<D> one_by_one(space, radii, random);
  RandomPlaces<D>& places = one_by_one.found;
  std::size_t k = 0;
  while (k < radii.size() && one_by_one.place(k)) ++k;
  if (k == radii.size()) return places;
  while (k < radii.size() && one_by_one.leave(k)) ++k;
  if (k < radii.size()) {
    places.scale = 0.0;
    return places;
  }
  Packing<D> packing(space, radii, std::move(places.centres));
  places.scale = std::min(packing.grow(), 1.0);
  places.centres.clear();
  if (places.scale < 1.0) return places;
  packing.mix(random);
  places.centres = packing.take();
  return places;
}

#define ODPD_INSTANTIATE(D)                                                                    \
  template RandomPlaces<D> find_random_places<D>(const Box<D>&, const Vec<D>&, const Vec<D>&,  \
                                                 const BallCells<D>&, std::span<const double>, \
                                                 std::uint64_t);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
