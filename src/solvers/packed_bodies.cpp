#include "odpd/solvers/packed_bodies.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/solvers/preconditioner.h"

namespace odpd {

namespace {

// Sums of so many constituents in single precision, of more in double.
constexpr std::int64_t constituents_per_sum = 64;
constexpr std::int64_t constituents_per_turn = 1024;

// A velocity or force of the packed rows as a register holds it, with what the fourth component is in 3D: zero.
template <int D>
struct Arrow;

template <>
struct Arrow<2> {
  using Type = float __attribute__((vector_size(8), aligned(4), may_alias));
  static Type velocity(const float* motion, Type arm) {
    return Type{motion[0] - motion[2] * arm[1], motion[1] + motion[2] * arm[0]};
  }
  struct Sum {
    Type force{};
    float torque = 0.0F;
    void add(Type arm, Type f) {
      force += f;
      torque += arm[0] * f[1] - arm[1] * f[0];
    }
    void add_to(double* load) const {
      for (int c = 0; c < 2; ++c) load[c] += static_cast<double>(force[c]);
      load[2] += static_cast<double>(torque);
    }
  };
};

template <>
struct Arrow<3> {
  using Type = float __attribute__((vector_size(16), aligned(4), may_alias));
  static Type cross(Type a, Type b) {
    return __builtin_shufflevector(a, a, 1, 2, 0, 3) * __builtin_shufflevector(b, b, 2, 0, 1, 3) -
           __builtin_shufflevector(a, a, 2, 0, 1, 3) * __builtin_shufflevector(b, b, 1, 2, 0, 3);
  }
  static Type velocity(const float* motion, Type arm) {
    const Type v{motion[0], motion[1], motion[2], 0.0F}, w{motion[3], motion[4], motion[5], 0.0F};
    return v + cross(w, arm);
  }
  struct Sum {
    Type force{}, torque{};
    void add(Type arm, Type f) {
      force += f;
      torque += cross(arm, f);
    }
    void add_to(double* load) const {
      for (int c = 0; c < 3; ++c) {
        load[c] += static_cast<double>(force[c]);
        load[3 + c] += static_cast<double>(torque[c]);
      }
    }
  };
};

// Inverse, or pseudo-inverse, of a positive semidefinite block.
void invert(std::span<double> block) {
  constexpr double singular = 1e-10;  // of the largest eigenvalue
  const auto n = static_cast<Eigen::Index>(std::lround(std::sqrt(block.size())));
  std::vector<double> inverse(block.begin(), block.end());
  if (invert_definite(inverse, static_cast<int>(n))) {
    std::copy(inverse.begin(), inverse.end(), block.begin());
    return;
  }
  Eigen::Map<Eigen::MatrixXd> m(block.data(), n, n);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts(m);
  m.setZero();
  for (Eigen::Index k = 0; k < n; ++k)
    if (parts.eigenvalues()(k) > singular * parts.eigenvalues()(n - 1))
      m += parts.eigenvectors().col(k) * parts.eigenvectors().col(k).transpose() /
           parts.eigenvalues()(k);
}

template <int D>
auto arrow_at(const float* p) {
  return *reinterpret_cast<const typename Arrow<D>::Type*>(p);
}

template <int D>
void store_arrow(float* p, typename Arrow<D>::Type v) {
  *reinterpret_cast<typename Arrow<D>::Type*>(p) = v;
}

}  // namespace

template <int D>
void PackedBodies<D>::pack(const RigidResistance<D>& resistance, const SlicedRows<D>& rows) {
  constexpr std::int64_t stride = SlicedRows<D>::stride;
  const RigidMap<D>& map = resistance.map();
  resistance_ = &resistance;
  share_ = resistance.mobile().share();
  bodies_ = map.bodies();
  offset_.resize(index(map.constituents()));
  arm_.resize(map.constituents() * stride);
  parallel_for(map.constituents(), [&](std::int64_t member) {
    const auto s = index(member);
    offset_[s] = static_cast<std::int32_t>(rows.place_of_node()[index(map.rows()[s])] * stride);
    for (std::int64_t c = 0; c < stride; ++c)
      arm_.data()[member * stride + c] =
          c < D ? static_cast<float>(map.arms()[s].x[index(c) % D]) : 0.0F;
  });
  load_.resize(index(bodies_));
  work_.resize(index(bodies_));
  inverse_inertia_.resize(index(bodies_));
  inverse_block_.resize(index(bodies_));
  std::vector<double> blocks;
  resistance.body_blocks(blocks);
  parallel_for(bodies_, [&](std::int64_t body) {
    const auto b = index(body);
    const auto block = std::span(blocks).subspan(b * freedoms * freedoms, freedoms * freedoms);
    invert(block);
    // Unknowns in the order V, w, each a combination of scaled ones, which are w and V.
    double scale[freedoms][freedoms] = {};
    for (std::size_t row = 0; row < D; ++row) {
      scale[row][D + row] = map.inverse_root_mass(b);
      for (std::size_t col = 0; col < D; ++col) scale[D + row][col] = map.turn(b)[row * D + col];
    }
    for (std::size_t row = 0; row < freedoms; ++row)
      for (std::size_t col = 0; col < freedoms; ++col) {
        double sum = 0.0, inertia = 0.0;
        for (std::size_t k = 0; k < freedoms; ++k) {
          inertia += scale[row][k] * scale[col][k];
          for (std::size_t l = 0; l < freedoms; ++l)
            sum += scale[row][k] * block[k * freedoms + l] * scale[col][l];
        }
        inverse_block_[b][row * freedoms + col] = static_cast<float>(sum);
        if (row >= D && col >= D)
          inverse_inertia_[b][1 + (row - D) * D + col - D] = static_cast<float>(inertia);
        if (row == 0 && col == 0) inverse_inertia_[b][0] = static_cast<float>(inertia);
      }
  });
}

/// Bodies that begin in the same stretch of constituents share a thread's turn: some may be much larger than others.
template <int D>
template <class Change>
void PackedBodies<D>::for_each_body(const Change& change) const {
  if (bodies_ == 0) return;
  const RigidMap<D>& map = resistance_->map();
  const auto bodies_of = [&](std::int64_t begin, std::int64_t end) {
    for (std::size_t b = map.first_from(begin); b < index(bodies_) && map.begin(b) < end; ++b)
      change(b, map.begin(b), map.end(b));
  };
  parallel_ranges(std::ssize(offset_), constituents_per_turn, bodies_of);
}

template <int D>
void PackedBodies<D>::gather(const float* v) {
  constexpr std::int64_t stride = SlicedRows<D>::stride;
  const bool alone = share_.alone();
  for_each_body([&](std::size_t b, std::int64_t begin, std::int64_t end) {
    auto& load = load_[b];
    load.fill(0.0);
    for (std::int64_t from = begin; from < end; from += constituents_per_sum) {
      typename Arrow<D>::Sum sum;
      for (std::int64_t s = from; s < std::min(end, from + constituents_per_sum); ++s)
        if (alone || share_.owns(std::int64_t{resistance_->map().rows()[index(s)]}))
          sum.add(arrow_at<D>(arm_.data() + s * stride), arrow_at<D>(v + offset_[index(s)]));
      sum.add_to(load.data());
    }
  });
  if (bodies_ > 0) share_.ranks->sum(std::span(load_.front().data(), load_.size() * freedoms));
}

template <int D>
template <class Find, class Write>
void PackedBodies<D>::for_each_constituent(const Find& find, float* v, const Write& write) const {
  constexpr std::int64_t stride = SlicedRows<D>::stride;
  for_each_body([&](std::size_t b, std::int64_t begin, std::int64_t end) {
    const Motion motion = find(b);
    for (std::int64_t s = begin; s < end; ++s)
      write(v + offset_[index(s)],
            Arrow<D>::velocity(motion.data(), arrow_at<D>(arm_.data() + s * stride)));
  });
}

template <int D>
auto PackedBodies<D>::closest(std::size_t b) const -> Motion {
  Motion motion{};
  for (std::size_t row = 0; row < D; ++row) {
    motion[row] = inverse_inertia_[b][0] * static_cast<float>(load_[b][row]);
    for (std::size_t col = 0; col < D; ++col)
      motion[D + row] +=
          inverse_inertia_[b][1 + row * D + col] * static_cast<float>(load_[b][D + col]);
  }
  return motion;
}

template <int D>
auto PackedBodies<D>::answer(std::size_t b) const -> Motion {
  Motion motion{};
  for (std::size_t row = 0; row < freedoms; ++row)
    for (std::size_t col = 0; col < freedoms; ++col)
      motion[row] += inverse_block_[b][row * freedoms + col] * static_cast<float>(load_[b][col]);
  return motion;
}

template <int D>
void PackedBodies<D>::project(float* v) {
  gather(v);
  for_each_constituent([this](std::size_t b) { return closest(b); }, v, store_arrow<D>);
}

template <int D>
double PackedBodies<D>::solve(const float* r, float* z) {
  gather(r);
  for_each_constituent(
      [this](std::size_t b) {
        const Motion motion = answer(b);
        work_[b] = 0.0;
        for (std::size_t k = 0; k < freedoms; ++k)
          work_[b] += load_[b][k] * static_cast<double>(motion[k]);
        return motion;
      },
      z, store_arrow<D>);
  return std::accumulate(work_.begin(), work_.begin() + bodies_, 0.0);
}

template <int D>
void PackedBodies<D>::subtract(float step, float* v) const {
  for_each_constituent(
      [this](std::size_t b) { return answer(b); }, v,
      [step](float* at, auto u) { store_arrow<D>(at, arrow_at<D>(at) - step * u); });
}

template <int D>
void PackedBodies<D>::scatter(std::span<const double> y, double scale, float* r) const {
  for_each_constituent(
      [&](std::size_t b) {
        const RigidMotion<D> motion =
            resistance_->map().motion(b, &y[resistance_->linear_node(b) * D], &y[b * D]);
        Motion out{};
        for (std::size_t c = 0; c < D; ++c) {
          out[c] = static_cast<float>(motion.velocity.x[c] / scale);
          out[D + c] = static_cast<float>(motion.angular.x[c] / scale);
        }
        return out;
      },
      r, store_arrow<D>);
}

template <int D>
void PackedBodies<D>::add_to(const float* d, double scale, std::span<double> y) {
  gather(d);
  parallel_for(bodies_, [&](std::int64_t body) {
    const auto b = index(body);
    RigidLoad<D> load;
    for (std::size_t c = 0; c < D; ++c) {
      load.force.x[c] = load_[b][c];
      load.torque.x[c] = load_[b][D + c];
    }
    std::array<double, D> linear, angular;
    resistance_->map().load(b, load, linear.data(), angular.data());
    for (std::size_t c = 0; c < D; ++c) {
      y[resistance_->linear_node(b) * D + c] += scale * linear[c];
      y[b * D + c] += scale * angular[c];
    }
  });
}

template <int D>
void PackedBodies<D>::settle_unused(std::span<const double> b, std::span<double> x) const {
  for (std::size_t body = 0; body < index(bodies_); ++body) {
    Vec<D> missing;
    for (std::size_t c = 0; c < D; ++c) missing.x[c] = b[body * D + c] - x[body * D + c];
    for (std::size_t row = 0; row < D; ++row)
      for (std::size_t col = 0; col < D; ++col)
        x[body * D + row] += resistance_->map().unused(body)[row * D + col] * missing.x[col];
  }
}

template <int D>
std::int64_t PackedBodies<D>::bytes() const {
  return arm_.size() * static_cast<std::int64_t>(sizeof(float)) +
         static_cast<std::int64_t>(offset_.size() * sizeof(std::int32_t) +
                                   load_.size() *
                                       (sizeof(double) + sizeof(load_[0]) +
                                        sizeof(inverse_inertia_[0]) + sizeof(inverse_block_[0])));
}

template class PackedBodies<2>;
template class PackedBodies<3>;

}  // namespace odpd
