// Kernels of a massless step, on equilibrated-like random fluids (n = 4, standard parameters): ns per particle.
//   build/release/bench/odpd_bench --benchmark_filter=Apply
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>

#include "odpd/dynamics/dynamics.h"
#include "odpd/operator/edge_sums.h"
#include "odpd/pairs/noise.h"
#include "odpd/scene/scene.h"

namespace odpd {
namespace {

template <int D>
struct Fluid {
  explicit Fluid(std::int64_t particles)
      : scene(settings(particles)),
        list(scene.box(), scene.model().cutoff(), 0.0),
        dofs(scene.particles()),
        resistance(scene.box()) {
    scene.particles().reorder(
        spatial_order<D>(scene.box(), 1.0, scene.particles().position, scene.particles().id));
    edges();
    resistance.rebuild(network, dofs, scene.particles(), scene.particles().position, 0.0);
  }
  static SceneSettings<D> settings(std::int64_t particles) {
    SceneSettings<D> s;
    const double edge = std::pow(static_cast<double>(particles) / 4.0, 1.0 / D);
    for (int c = 0; c < D; ++c) {
      s.box.size[c] = edge;
      s.box.periodic[static_cast<std::size_t>(c)] = true;
    }
    s.count = particles;
    return s;
  }
  void edges() {
    if (list.rows() == 0) list.update(scene.particles().position);
    scene.model().write_edges(list, scene.box(), scene.particles().position, scene.particles(),
                              network);
  }

  Scene<D> scene;
  PairList<D> list;
  PairNetwork<D> network;
  DofMap<D> dofs;
  Resistance<D> resistance;
};

/// Made once: to relax a large one takes longer than to measure it.
template <int D>
Fluid<D>& fluid_of(std::int64_t particles) {
  static std::map<std::int64_t, Fluid<D>> made;
  return made.try_emplace(particles, particles).first->second;
}

void per_particle(benchmark::State& state) {
  state.counters["ns/particle"] = benchmark::Counter(
      static_cast<double>(state.range(0)) * 1e-9,
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

template <int D>
void PairSearch(benchmark::State& state) {
  Fluid<D>& fluid = fluid_of<D>(state.range(0));
  for (auto _ : state) fluid.list.update(fluid.scene.particles().position);
  per_particle(state);
}

template <int D>
void Edges(benchmark::State& state) {
  Fluid<D>& fluid = fluid_of<D>(state.range(0));
  for (auto _ : state) fluid.edges();
  per_particle(state);
}

template <int D>
void Noise(benchmark::State& state) {
  Fluid<D>& fluid = fluid_of<D>(state.range(0));
  std::vector<Vec<D>> force;
  std::uint64_t step = 0;
  for (auto _ : state)
    draw_edge_noise(fluid.network, fluid.scene.particles(), 1, ++step, 0.005, force);
  per_particle(state);
}

template <int D>
void EdgeForces(benchmark::State& state) {
  Fluid<D>& fluid = fluid_of<D>(state.range(0));
  std::vector<Vec<D>> edge_force, force(static_cast<std::size_t>(state.range(0)));
  draw_edge_noise(fluid.network, fluid.scene.particles(), 1, 1, 0.005, edge_force);
  for (auto _ : state) add_edge_forces<D>(fluid.network, edge_force, force);
  per_particle(state);
}

template <int D>
void ConservativeForces(benchmark::State& state) {
  Fluid<D>& fluid = fluid_of<D>(state.range(0));
  std::vector<Vec<D>> force(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) add_conservative_forces<D>(fluid.network, force);
  per_particle(state);
}

template <int D>
void Apply(benchmark::State& state) {
  const Fluid<D>& fluid = fluid_of<D>(state.range(0));
  std::vector<double> x(static_cast<std::size_t>(fluid.resistance.size()));
  std::vector<double> y(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = std::sin(static_cast<double>(k));
  for (auto _ : state) fluid.resistance.apply(x, y);
  per_particle(state);
}

template <int D>
void Solve(benchmark::State& state) {
  const Fluid<D>& fluid = fluid_of<D>(state.range(0));
  const auto solver = make_solver({.name = "pcg", .tolerance = 1e-5});
  std::vector<double> b(static_cast<std::size_t>(fluid.resistance.size()));
  for (std::size_t k = 0; k < b.size(); ++k) b[k] = std::sin(static_cast<double>(k));
  for (auto _ : state) {
    std::vector<double> x(b.size(), 0.0);
    solver->bind(fluid.resistance);
    state.counters["iterations"] = static_cast<double>(solver->solve(b, x).iterations);
  }
  per_particle(state);
}

/// Set-up of a solver made anew: its grid's operator, its memory.
template <int D>
void FirstBind(benchmark::State& state) {
  const Fluid<D>& fluid = fluid_of<D>(state.range(0));
  for (auto _ : state) make_solver({.name = "pcg"})->bind(fluid.resistance);
  per_particle(state);
}

BENCHMARK(PairSearch<2>)->Arg(540)->Arg(10000)->Arg(100000);
BENCHMARK(PairSearch<3>)->Arg(540)->Arg(10000)->Arg(100000);
BENCHMARK(Edges<2>)->Arg(540)->Arg(10000)->Arg(100000);
BENCHMARK(Edges<3>)->Arg(540)->Arg(10000)->Arg(100000);
BENCHMARK(Noise<2>)->Arg(10000)->Arg(100000);
BENCHMARK(EdgeForces<2>)->Arg(10000)->Arg(100000);
BENCHMARK(ConservativeForces<2>)->Arg(10000)->Arg(100000);
BENCHMARK(Noise<3>)->Arg(10000)->Arg(100000);
BENCHMARK(EdgeForces<3>)->Arg(10000)->Arg(100000);
BENCHMARK(ConservativeForces<3>)->Arg(10000)->Arg(100000);
BENCHMARK(Apply<2>)->Arg(540)->Arg(10000);
BENCHMARK(Apply<3>)->Arg(540)->Arg(10000);
BENCHMARK(Solve<2>)->Arg(540)->Arg(10000);
BENCHMARK(Solve<3>)->Arg(540)->Arg(10000);
BENCHMARK(FirstBind<2>)->Arg(10000);
BENCHMARK(FirstBind<3>)->Arg(10000);

}  // namespace
}  // namespace odpd

BENCHMARK_MAIN();
