#pragma once
// Velocities of particles and of centres, against those of Maxwell. Per species (its free particles), [[molecule]] and free
// [[body]] (its centres), and per component,
//
//   <(v - V)^2> = (kT/M) (1 - M/M_all),   M = p m of a centre of p particles, p = 1 of a particle
//
// exactly, at any density and in any potential, and the density of u = (v - V)/sqrt(that) is exp(-u^2/2)/sqrt(2 pi). V is
// the mean velocity of all that moves, of mass M_all. Where something takes momentum from them (a wall, a held body,
// zeta_0), V = 0 and the second factor is 1. Under [shear] v is less that of the flow. v is that of the step's start, whose
// variance the integrators state (dynamics/step_record.h). At m = 0 there is no such velocity.
#include "odpd/analysis/observer.h"

namespace odpd {

struct VelocitiesSettings {
  std::vector<int> directions;  ///< components that count
  double range = 4.0;           ///< of the histogram: u from -range to range
  std::size_t bins = 40;
};

template <int D>
class Velocities : public Observer<D> {
 public:
  Velocities(ObserverSettings settings, VelocitiesSettings velocities, const Scene<D>& scene);
  /// Throws ConfigError at mass = 0 and at kT = 0.
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override;
  std::vector<double> series_row() const override;

 private:
  struct Kind {
    std::string name;
    double population = 0.0;
    double variance = 0.0;  ///< the exact one (length^2/time^2); of bodies that of the first
  };
  std::size_t columns() const { return 1 + velocities_.bins; }
  double bin_width() const {
    return 2.0 * velocities_.range / static_cast<double>(velocities_.bins);
  }
  void add_kind(std::string name, double population, std::size_t particles);
  /// Of the mean velocity of so many particles.
  double variance_of(std::size_t particles) const;
  void count(std::size_t kind, const Vec<D>& v, std::vector<double>& sample) const;

  VelocitiesSettings velocities_;
  const Scene<D>& scene_;
  std::vector<Kind> kinds_;  // species, then molecules, then bodies
  std::size_t first_molecule_ = 0, first_body_ = 0;
  // A sample has for each kind the mean u^2 and the histogram.
};

}  // namespace odpd
