#pragma once
// What `odpd calibrate --radius` has measured, what follows from it, and its files.
#include <filesystem>
#include <vector>

#include "odpd/app/radius_run.h"

namespace odpd {

/// Everything that was measured, and what follows from it.
struct RadiusRecord {
  MeasuredBody body;
  std::vector<double> edges;  ///< in the order in which they are measured
  double relative_error = 0.01;
  PureFluid fluid;
  std::vector<BodyInCell> cells;    ///< of these edges
  std::vector<BodyInCell> earlier;  ///< of the same fluid and body, by another call

  FluidViscosity viscosity() const {
    return {fluid.eta.value, fluid.density.value, body.viscosity_exponent()};
  }
  Measured drag(const BodyInCell& cell) const { return drag_radius(cell, viscosity()); }
  Measured torque(const BodyInCell& cell) const { return torque_radius(cell, viscosity()); }
  template <class Quantity>
  std::vector<Measured> of_cells(const Quantity& quantity) const {
    std::vector<Measured> values;
    for (const BodyInCell& cell : cells) values.push_back(quantity(cell));
    return values;
  }
  /// Mean over the cells, with the error of eta, which all of them share.
  Measured radius() const { return shared(&RadiusRecord::drag); }
  Measured turning_radius() const { return shared(&RadiusRecord::torque); }
  /// That by drag, on a line in 1/edge.
  Measured at_infinity() const;
  Measured excluded() const;
  /// What an earlier call measured in a cell of this edge; without samples where it did not.
  BodyInCell take(double edge) const;

 private:
  Measured shared(Measured (RadiusRecord::*quantity)(const BodyInCell&) const) const;
};

/// radius.json and radius.csv of the directory, of the cells and of earlier ones with other edges; `complete`: with the result, of the cells
/// alone. Throws IoError.
void write_radius(const std::filesystem::path& directory, const RadiusRecord& record,
                  bool complete);
/// Takes what an earlier radius.json has. False, and nothing, where it is of another fluid or body. Throws IoError.
bool continue_radius(const std::filesystem::path& file, RadiusRecord& record);

}  // namespace odpd
