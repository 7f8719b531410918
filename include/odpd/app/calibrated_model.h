#pragma once
// What `odpd calibrate` knows of a model: the key of [fluid] that its friction follows from, here called the friction, and everything else that
// a measurement of its viscosity depends on.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "odpd/pairs/dpd_parameters.h"
#include "odpd/pairs/sdpd.h"

namespace odpd {

class CalibratedModel {
 public:
  virtual ~CalibratedModel() = default;
  /// gamma, or the eta that is asked for.
  virtual std::string key() const = 0;
  /// For tables and calibration.json, where eta is the one that is wanted.
  std::string label() const { return key() == "eta" ? "fluid.eta" : key(); }
  virtual double friction() const = 0;  ///< of the case
  virtual double kT() const = 0;
  virtual double cutoff() const = 0;  ///< (length)
  /// Numbers that must agree for measurements to be of the same fluid, and a text that must.
  virtual std::vector<std::pair<std::string, double>> inputs() const = 0;
  virtual std::string text() const { return {}; }
  /// Lines of [fluid], but density, mass and friction.
  virtual std::string keys() const = 0;
  /// The friction that would give eta without structure.
  virtual double guess(double eta) const = 0;
  /// Time in which particles move by about r_c (DPD) or a few spacings (SDPD) at mass 0.
  virtual double diffusion_time(double friction) const = 0;
  virtual double accurate_step(double friction, double mass) const = 0;
  /// At mass 0 friction only sets the unit of time.
  virtual bool scales() const = 0;
};

/// In `dimension` dimensions at this density.
std::shared_ptr<const CalibratedModel> calibrated_dpd(const DpdParameters& p, int dimension,
                                                      double density);
/// A central or classical fluid.
std::shared_ptr<const CalibratedModel> calibrated_sdpd(const SdpdParameters& p,
                                                       const SdpdFriction& friction, int dimension);

}  // namespace odpd
