#include "odpd/dynamics/integrator.h"

#include <fmt/ranges.h>

#include "odpd/core/error.h"
#include "odpd/dynamics/euler.h"
#include "odpd/dynamics/trapezoidal.h"

namespace odpd {

std::vector<std::string> integrator_names() { return {"trapezoidal", "euler"}; }

template <int D>
std::unique_ptr<Integrator<D>> make_integrator(const std::string& name) {
  if (name == "trapezoidal") return std::make_unique<Trapezoidal<D>>();
  if (name == "euler") return std::make_unique<Euler<D>>();
  throw ConfigError(fmt::format("there is no integrator '{}': use one of {}", name,
                                fmt::join(integrator_names(), ", ")));
}

template std::unique_ptr<Integrator<2>> make_integrator<2>(const std::string&);
template std::unique_ptr<Integrator<3>> make_integrator<3>(const std::string&);

}  // namespace odpd
