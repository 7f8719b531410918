// An observer of your own: the thermometer of forces (Rugh 1997). In equilibrium, and whatever the energy U of the particles,
//
//   kT = <|F|^2>/<lap U>,   F_i = sum_j f_c e,   lap_i U = sum_j (k_c - (d - 1) f_c/r)
//
// Both are sums over the edges that the pair model wrote; averages, blocks and errors are those of every observer.
#include <cmath>
#include <cstdio>

#include "odpd/app/simulation.h"

class Thermometer : public odpd::Observer<2> {
 public:
  explicit Thermometer(odpd::ObserverSettings settings)
      : Observer<2>(std::move(settings), {"force_squared", "laplacian"}) {}
  void measure(const odpd::Clock&, const odpd::Particles<2>& particles,
               const odpd::StepRecord<2>& record) override {
    double squared = 0.0, laplacian = 0.0;
    const odpd::Share own = particles.owned();  // of several ranks each adds its own
    for (const odpd::Vec<2>& force : own.part(std::span(record.start.potential_force), 1))
      squared += dot(force, force);
    const odpd::PairNetwork<2>& edges = record.start.network;
    for (std::size_t k = 0; k < edges.r.size(); ++k)  // each edge counts at both its ends
      if (edges.counts(k)) laplacian += 2.0 * (edges.k_c[k] - edges.f_c[k] / edges.r[k]);
    const auto n = static_cast<double>(particles.size());
    add({own.ranks->sum(squared) / n, own.ranks->sum(laplacian) / n});
  }
  void add_results(odpd::Results& results) const override {
    Observer<2>::add_results(results);  // the means of the two columns
    const odpd::BlockAverage::RatioTerm ratio{.numerator = 0, .denominator = 1};
    results.scalars.push_back(
        {named("kT"), average().ratio(0, 1), average().ratio_error({&ratio, 1})});
  }
};

constexpr char equilibrium[] = R"(
  dimension = 2
  box = { size = [6.0, 6.0], periodic = [true, true] }
  fluid = { density = 4.0, kT = 1.0, a = 18.5, gamma = 4.5 }
  integrator = { name = "trapezoidal", dt = 0.005 }
  run = { equilibrate = 2.0, duration = 20.0 }
  observe = [{ kind = "thermometer", every = 2 }]
)";

int main() {
  const odpd::Config config = odpd::Config::from_text(equilibrium, "equilibrium");
  odpd::Simulation<2> simulation(config, odpd::read_case(config, "equilibrium"),
                                 {{.name = "thermometer", .make = [](const auto& entry) {
                                     return std::make_unique<Thermometer>(entry.settings());
                                   }}});
  while (!simulation.clock().finished()) simulation.step();
  const odpd::Results results = simulation.results();
  for (const char* name : {"force_squared", "laplacian", "kT"}) {
    const odpd::Scalar s = *results.find(std::string("thermometer.") + name);
    std::printf("%-14s %.4g +- %.2g\n", name, s.mean, s.standard_error);
  }
  const odpd::Scalar kT = *results.find("thermometer.kT");
  return std::abs(kT.mean - 1.0) < 4.0 * kT.standard_error && kT.standard_error < 0.02 ? 0 : 1;
}
