#include "odpd/pairs/registry.h"

#include <algorithm>

#include "odpd/pairs/dpd.h"
#include "odpd/pairs/dpd_keys.h"
#include "odpd/pairs/gaussian.h"
#include "odpd/pairs/mdpd.h"
#include "odpd/pairs/physical_keys.h"
#include "odpd/pairs/sdpd.h"
#include "odpd/pairs/table_model.h"

namespace odpd {

namespace {

template <int D>
struct Row {
  const char* name;
  std::shared_ptr<const PairModel<D>> (*read)(const FluidKeys&);
  bool physical_inputs;  // reads eta, ..., calibration itself
};

template <int D>
const std::vector<Row<D>>& table() {
  static const std::vector<Row<D>> rows{
      {"dpd", &read_dpd<D>, true},
      {"table", &read_table_model<D>, false},
      {"gaussian", &read_force_model<D, GaussianForce>, false},
      {"sdpd", &read_sdpd<D>, true},
      {"mdpd", &read_mdpd<D>, false},
  };
  return rows;
}

}  // namespace

std::vector<std::string> pair_model_names() {
  std::vector<std::string> names;
  for (const auto& row : table<2>()) names.emplace_back(row.name);
  return names;
}

template <int D>
std::shared_ptr<const PairModel<D>> read_pair_model(const FluidKeys& keys) {
  const std::vector<std::string> names = pair_model_names();
  const std::string name = keys.fluid.choice("model", names, names.front());
  const auto row = std::find_if(table<D>().begin(), table<D>().end(),
                                [&](const Row<D>& r) { return name == r.name; });
  if (!row->physical_inputs) refuse_physical_inputs(keys.fluid, name);
  return row->read(keys);
}

template <int D>
std::shared_ptr<const PairModel<D>> default_pair_model() {
  return make_dpd<D>(DpdParameters{});
}

std::vector<std::string> dynamical_model_keys() {
  std::vector<std::string> keys = friction_keys();
  keys.insert(keys.end(),
              {"eta", "Sc", "tau_P", "spin", "lever_radius", "moment", "antisymmetric_stress"});
  return keys;
}

template std::shared_ptr<const PairModel<2>> read_pair_model<2>(const FluidKeys&);
template std::shared_ptr<const PairModel<3>> read_pair_model<3>(const FluidKeys&);
template std::shared_ptr<const PairModel<2>> default_pair_model<2>();
template std::shared_ptr<const PairModel<3>> default_pair_model<3>();

}  // namespace odpd
