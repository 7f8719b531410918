#pragma once
// Models with densities, for the crowd of density_toy.h: the toy and those of the table, with kernels that are smooth enough for differences.
#include <memory>
#include <string>
#include <vector>

#include "odpd/pairs/mdpd.h"
#include "odpd/pairs/sdpd.h"
#include "support/density_toy.h"

namespace support {

template <int D>
struct DensityModel {
  std::string name;
  std::shared_ptr<const odpd::PairModel<D>> model;
  double step = 2e-3;   ///< of differences
  double small = 2e-3;  ///< of first differences, less where they meet jumps of second derivatives
};

template <int D>
std::shared_ptr<const odpd::PairModel<D>> crowded_sdpd(odpd::SmoothingKernel::Shape kernel,
                                                       double exponent) {
  const odpd::SdpdParameters p{
      .state = {.d_0 = 5.0, .modulus = 40.0, .background = 15.0, .exponent = exponent},
      .kernel = kernel,
      .support = 1.0,
      .kT = 1.0};
  const auto like = odpd::SdpdFriction::central(1.0, D),
             unlike = odpd::SdpdFriction::classical(2.0, D);
  return std::make_shared<odpd::SdpdModel<D>>(p, 2, std::vector{like, unlike, unlike, like});
}

template <int D>
std::shared_ptr<const odpd::PairModel<D>> crowded_mdpd() {
  odpd::MdpdPair like, unlike;
  like.A = -30.0;
  unlike.A = -20.0;
  unlike.b = 0.7;
  unlike.friction.cutoff = 0.9;
  return std::make_shared<odpd::MdpdModel<D>>(odpd::MdpdFluid{.B = 15.0, .r_d = 0.8}, 2,
                                              std::vector{like, unlike, unlike, like}, 5.0);
}

template <int D>
std::vector<DensityModel<D>> density_models() {
  using Shape = odpd::SmoothingKernel::Shape;
  return {{"toy", std::make_shared<ToyModel<D>>(ToyParameters{.c = 0.8, .pair = 3.0})},
          {"sdpd, linear", crowded_sdpd<D>(Shape::wendland_c4, 0.0)},
          {"sdpd, Tait", crowded_sdpd<D>(Shape::quintic, 7.0)},
          {"mdpd", crowded_mdpd<D>(), 3e-4, 1e-6}};
}

}  // namespace support
