#include "odpd/pairs/levers.h"

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"

namespace odpd {

template <int D>
void write_levers(const Particles<D>& particles, PairNetwork<D>& network) {
  const bool some = !particles.spin_of_species.empty() && network.transverse;
  for (auto* column : {&network.lever_i, &network.lever_j})
    column->resize(some ? network.i.size() : 0);
  if (!some) return;
  const auto radius = [&](std::int32_t particle) {
    return particles.spin_of_species[index(particles.species[index(particle)])].lever_radius;
  };
  parallel_for(network.size(), [&](std::int64_t edge) {
    const auto k = index(edge);
    const double i = radius(network.i[k]), j = radius(network.j[k]);
    const double unit = i + j > 0.0 ? network.r[k] / (i + j) : 0.0;
    network.lever_i[k] = i * unit;
    network.lever_j[k] = j * unit;
  });
}

template void write_levers(const Particles<2>&, PairNetwork<2>&);
template void write_levers(const Particles<3>&, PairNetwork<3>&);

}  // namespace odpd
