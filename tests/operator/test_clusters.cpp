// Groups of particles out of reach of all others make R singular although no single particle is a rattler.
#include <gtest/gtest.h>

#include "odpd/operator/resistance.h"
#include "support/dimensions.h"
#include "support/errors.h"
#include "support/network.h"

namespace {

using namespace odpd;
using support::Fluid;

template <class T>
class ClusterTest : public ::testing::Test {};
TYPED_TEST_SUITE(ClusterTest, support::Dimensions);

// `drops` dense drops far from each other; `held` of them touch a particle of known velocity.
template <int D>
void build(int drops, int held, const DpdParameters& p) {
  Fluid<D> fluid{20.0, true};
  for (int k = 0; k < drops; ++k) {
    const auto low = support::uniform_vec<D>(1.0 + 3.6 * k);
    const auto high = support::uniform_vec<D>(2.5 + 3.6 * k);
    for (const auto& r : support::random_points<D>(low, high, D == 2 ? 25 : 60, 1))
      fluid.particles.add(r, 0);
    if (k < held) fluid.particles.add(0.5 * (low + high), 0, odpd::Group::wall(0));
  }
  fluid.connect(DpdModel<D>(1, {p}));
  Resistance<D> resistance(fluid.box);
  resistance.rebuild(fluid.network, DofMap<D>(fluid.particles), fluid.particles,
                     fluid.particles.position, 0.0);
}

TYPED_TEST(ClusterTest, MustBeHeldOrAlone) {
  constexpr int D = TypeParam::D;
  EXPECT_NO_THROW(build<D>(1, 0, {})) << "one drop carries the null space";
  EXPECT_NO_THROW(build<D>(2, 2, {})) << "both are held";
  for (const int held : {0, 1})
    support::expect_error<SolverError>([&] { build<D>(2, held, {}); },
                                       {"group of particles", "rattler_friction"});
  DpdParameters far;
  far.gamma_far = 0.1;
  far.cutoff_far = 5.0;
  EXPECT_NO_THROW(build<D>(2, 1, far)) << "the far friction joins them";
}

}  // namespace
