#pragma once
// Contact angle of a drop that sits on a flat wall, from how high its centre of mass stands (Hautman & Klein 1991). The cap of a ball (in 2D
// of a disk) of radius R that meets the plane at the angle theta has
//
//   volume   omega R^d I(theta)/I(pi),   I(theta) = int_0^theta sin^d
//   centre   R [sin^(d+1) theta/((d + 1) I(theta)) - cos theta]   above the plane
//
// with omega = pi or 4 pi/3. Centre over volume^(1/d) rises with theta from 0 to that of the whole ball. So the mean height of N particles at
// the density of the liquid gives theta. The plane is the wall's surface, or `offset` above it.
#include "odpd/analysis/observer.h"

namespace odpd {

struct ContactAngleSettings {
  std::size_t wall = 0;  ///< of the scene's
  double density = 1.0;  ///< of the liquid (1/length^d)
  /// Of the plane on which the cap sits from the wall's surface, into the fluid (length).
  double offset = 0.0;
};

/// Height of a cap's centre over (its volume)^(1/d), at a contact angle in (0, pi].
template <int D>
double cap_height(double angle);
/// The angle (degrees) at which it is `ratio`; NaN where that is no cap's: below that of 3 degrees, or higher than a ball that touches the plane.
template <int D>
double cap_angle(double ratio);

template <int D>
class ContactAngle : public Observer<D> {
 public:
  ContactAngle(ObserverSettings settings, ContactAngleSettings drop, const Scene<D>& scene);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;

 private:
  double angle(double height) const;

  ContactAngleSettings drop_;
  const Scene<D>& scene_;
};

}  // namespace odpd
