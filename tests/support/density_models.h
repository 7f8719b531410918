#pragma once
// Models with densities, for the crowd of density_toy.h: the toy and those of the table, with kernels that are smooth enough for differences.
#include <memory>
#include <string>
#include <vector>

#include "odpd/pairs/sdpd.h"
#include "support/density_toy.h"

namespace support {

template <int D>
struct DensityModel {
  std::string name;
  std::shared_ptr<const odpd::PairModel<D>> model;
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
std::vector<DensityModel<D>> density_models() {
  using Shape = odpd::SmoothingKernel::Shape;
  return {{"toy", std::make_shared<ToyModel<D>>(ToyParameters{.c = 0.8, .pair = 3.0})},
          {"sdpd, linear", crowded_sdpd<D>(Shape::wendland_c4, 0.0)},
          {"sdpd, Tait", crowded_sdpd<D>(Shape::quintic, 7.0)}};
}

}  // namespace support
