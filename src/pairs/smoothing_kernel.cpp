#include "odpd/pairs/smoothing_kernel.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "edge_kernels.h"
#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/isa.h"

namespace odpd {

namespace {

struct KernelRow {
  const char* name;
  double plane, space;  // pi s h^d in 2D and 3D
};

// In the order of the shapes.
constexpr std::array kernel_table{
    KernelRow{"wendland-c2", 7.0, 10.5}, KernelRow{"wendland-c4", 9.0, 495.0 / 32.0},
    KernelRow{"lucy", 5.0, 105.0 / 16.0}, KernelRow{"quintic", 63.0 / 478.0, 9.0 / 40.0}};

}  // namespace

SmoothingKernel::SmoothingKernel(Shape shape, int dimension, double support)
    : shape_(shape), support_(support) {
  if (!(support > 0.0))
    throw ConfigError(
        fmt::format("the support of a smoothing kernel is {}: it must be positive", support));
  if (dimension != 2 && dimension != 3)
    throw ConfigError(
        fmt::format("smoothing kernels are of 2 and 3 dimensions, never {}", dimension));
  const KernelRow& row = kernel_table[index(static_cast<int>(shape))];
  scale_ =
      (dimension == 2 ? row.plane : row.space) / std::numbers::pi / std::pow(support, dimension);
}

void SmoothingKernel::operator()(std::span<const double> r, const WeightColumns& columns) const {
  const auto& table = for_isa(kernels::edge_portable, kernels::edge_avx2, kernels::edge_avx512);
  table.weights({static_cast<kernels::WeightShape>(shape_), scale_, support_},
                static_cast<int>(r.size()), r.data(), columns);
}

const std::vector<std::string>& smoothing_kernel_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const KernelRow& row : kernel_table) list.emplace_back(row.name);
    return list;
  }();
  return names;
}

}  // namespace odpd
