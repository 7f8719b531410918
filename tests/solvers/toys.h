#pragma once
// Toy systems: networks of random points, R = sum of zeta e e^T over the pairs closer than 1.
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "odpd/operator/system.h"

namespace toys {

enum class Kind { regular, null_space, held };

inline const char* kind_name(Kind kind) {
  return kind == Kind::regular ? "regular" : kind == Kind::held ? "held" : "null";
}

struct Network {
  int dimension = 2;
  std::int32_t nodes = 0;
  std::vector<double> positions;
  std::map<std::pair<std::int32_t, std::int32_t>, std::array<double, 9>> blocks;

  std::array<double, 9>& block(std::int32_t i, std::int32_t j) { return blocks[{i, j}]; }
};

/// Adds the spring zeta e e^T, scaled out of `e`, between two unknowns; one below 0 is at rest.
inline void connect(Network& net, std::int32_t i, std::int32_t j, const std::array<double, 3>& e,
                    double zeta) {
  const std::size_t d = static_cast<std::size_t>(net.dimension);
  for (std::size_t k = 0; k < d * d; ++k) {
    const double value = zeta * e[k / d] * e[k % d];
    if (i >= 0) net.block(i, i)[k] += value;
    if (j >= 0) net.block(j, j)[k] += value;
    if (i < 0 || j < 0) continue;
    net.block(i, j)[k] -= value;
    net.block(j, i)[k] -= value;
  }
}

/// Every two nodes connected, each spring in a direction of its own: only translations are null.
inline Network clique(int dimension, std::int32_t nodes, std::uint32_t seed) {
  Network net;
  net.dimension = dimension;
  net.nodes = nodes;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (std::int32_t i = 0; i < nodes; ++i) {
    for (std::int32_t j = 0; j < i; ++j) {
      connect(net, i, j, {normal(random), normal(random), normal(random)}, 1.0);
    }
  }
  return net;
}

/// Random points at number density 4; periodic in every direction, or an open box. Points below
/// height `wall` are at rest and no unknowns. Spring weights are sqrt(1 - r).
inline Network network(int dimension, std::int32_t points, bool periodic, double wall,
                       std::uint32_t seed) {
  const std::size_t d = static_cast<std::size_t>(dimension);
  const double length = std::pow(points / 4.0, 1.0 / dimension);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, length);
  std::vector<double> all(static_cast<std::size_t>(points) * d);
  for (double& x : all) x = uniform(random);

  Network net;
  net.dimension = dimension;
  std::vector<std::int32_t> unknown(static_cast<std::size_t>(points), -1);
  for (std::size_t i = 0; i < unknown.size(); ++i) {
    if (all[i * d + d - 1] < wall) continue;
    unknown[i] = net.nodes++;
    for (std::size_t k = 0; k < d; ++k) net.positions.push_back(all[i * d + k]);
  }
  for (std::size_t i = 0; i < unknown.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      std::array<double, 3> e{};
      double rr = 0.0;
      for (std::size_t k = 0; k < d; ++k) {
        e[k] = all[i * d + k] - all[j * d + k];
        if (periodic) e[k] -= length * std::round(e[k] / length);
        rr += e[k] * e[k];
      }
      if (rr >= 1.0) continue;
      connect(net, unknown[i], unknown[j], e, std::sqrt(1.0 - std::sqrt(rr)) / rr);
    }
  }
  return net;
}

/// The matrix of a network, `shift` added to its diagonal.
inline odpd::BlockCsr matrix(const Network& net, double shift = 0.0) {
  const std::size_t d = static_cast<std::size_t>(net.dimension);
  odpd::BlockCsr a;
  a.block = net.dimension;
  a.rows = net.nodes;
  a.start.assign(static_cast<std::size_t>(net.nodes) + 1, 0);
  for (const auto& [place, block] : net.blocks) {
    ++a.start[static_cast<std::size_t>(place.first) + 1];
    a.column.push_back(place.second);
    for (std::size_t k = 0; k < d * d; ++k) {
      const bool diagonal = place.first == place.second && k / d == k % d;
      a.value.push_back(block[k] + (diagonal ? shift : 0.0));
    }
  }
  for (std::size_t i = 1; i < a.start.size(); ++i) a.start[i] += a.start[i - 1];
  return a;
}

inline odpd::AssembledSystem system(int dimension, Kind kind, std::uint32_t seed = 1,
                                    double shift = 0.0) {
  const double wall = kind == Kind::null_space ? 0.0 : 1.0;
  // Made once in a program: under sanitizers this takes longer than most solvers.
  static std::map<std::tuple<int, double, std::uint32_t>, Network> made;
  auto [place, absent] = made.try_emplace({dimension, wall, seed});
  Network& net = place->second;
  if (absent) net = network(dimension, dimension == 2 ? 220 : 400, true, wall, seed);
  return odpd::AssembledSystem(matrix(net, shift), kind == Kind::null_space, kind == Kind::held);
}

/// A free-floating network in an open box with known positions, a little mass on each node.
class OpenSystem : public odpd::AssembledSystem {
 public:
  explicit OpenSystem(const Network& net)
      : AssembledSystem(toys::matrix(net, 1e-3)), positions_(net.positions) {}
  std::span<const double> positions() const override { return positions_; }
  int periodic_directions() const override { return 0; }

 private:
  std::vector<double> positions_;
};

inline std::vector<double> random_vector(std::int64_t size, std::uint32_t seed = 7) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> v(static_cast<std::size_t>(size));
  for (double& x : v) x = normal(random);
  return v;
}

inline double norm(const std::vector<double>& v) {
  double s = 0.0;
  for (double x : v) s += x * x;
  return std::sqrt(s);
}

/// |a - b| / |b|
inline double distance(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> difference(a);
  for (std::size_t i = 0; i < a.size(); ++i) difference[i] -= b[i];
  return norm(difference) / norm(b);
}

/// |Pi (b - A x)| / |Pi b|, worked out here, not by the solver.
inline double true_residual(const odpd::System& system, std::vector<double> b,
                            const std::vector<double>& x) {
  std::vector<double> r(x.size());
  system.apply(x, r);
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = b[i] - r[i];
  system.project(r);
  system.project(b);
  return norm(r) / norm(b);
}

}  // namespace toys
