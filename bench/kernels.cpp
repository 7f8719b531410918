// Kernels of a massless step, on equilibrated-like random fluids (n = 4, standard parameters): ns per particle.
//   build/release/bench/odpd_bench --benchmark_filter=Apply
// ModelEdges: a whole set of edges of one model and the sum of their forces, ns per particle and neighbour.
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
  explicit Fluid(std::int64_t particles) : Fluid(settings(particles)) {}
  explicit Fluid(SceneSettings<D> settings)
      : scene(std::move(settings)),
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

const char* const model_names[] = {"dpd", "sdpd", "sdpd, classical", "mdpd"};

/// A periodic fluid of the model: DPD's of n = 4, SDPD of the usual 27 neighbours in 2D and 112 in 3D, many-body DPD at the density that has no
/// pressure.
template <int D>
SceneSettings<D> model_settings(int model, std::int64_t particles) {
  const char* const sdpd =
      "model = \"sdpd\"\ndensity = 1.0\nkT = 0.01\neta = 1.0\nbulk_modulus = 1.0\n";
  const std::string mdpd =
      "model = \"mdpd\"\nkT = 1.0\nA = -40.0\nB = 25.0\nr_d = 0.75\ngamma = 4.5\nfilled = true\n";
  const std::string fluid[] = {"density = 4.0\nkT = 1.0\na = 18.5\ngamma = 4.5\n", sdpd,
                               std::string(sdpd) + "form = \"classical\"\n",
                               mdpd + (D == 2 ? "density = 4.14\n" : "density = 6.08\n")};
  const double density[] = {4.0, 1.0, 1.0, D == 2 ? 4.14 : 6.08};
  const std::string edge =
      std::to_string(std::pow(static_cast<double>(particles) / density[model], 1.0 / D));
  const std::string third = D == 3 ? ", " + edge : "", also = D == 3 ? ", true" : "";
  return read_scene_settings<D>(Config::from_text(
      "dimension = " + std::to_string(D) + "\n[box]\nsize = [" + edge + ", " + edge + third +
          "]\nperiodic = [true, true" + also + "]\n[fluid]\n" + fluid[model],
      "model.toml"));
}

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
void ModelEdges(benchmark::State& state) {
  static std::map<std::pair<int, std::int64_t>, Fluid<D>> made;
  const auto model = static_cast<int>(state.range(1));
  Fluid<D>& fluid =
      made.try_emplace({model, state.range(0)}, model_settings<D>(model, state.range(0)))
          .first->second;
  std::vector<Vec<D>> force(static_cast<std::size_t>(fluid.network.particles));
  for (auto _ : state) {
    fluid.edges();
    add_conservative_forces<D>(fluid.network, force);
  }
  state.SetLabel(model_names[model]);
  state.counters["ns/neighbour"] = benchmark::Counter(
      2e-9 * static_cast<double>(fluid.network.size()),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
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
BENCHMARK(ModelEdges<2>)->ArgsProduct({{10000}, {0, 1, 2, 3}});
BENCHMARK(ModelEdges<3>)->ArgsProduct({{10000}, {0, 1, 2, 3}});
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
