#pragma once
// Molecules of each kind: mean and variance of the length of their bonds, mean-square radius of gyration
//
//   R_g^2 = <1/n sum_b |r_b - R|^2>,   R = 1/n sum_b r_b
//
// where they are tied to sites (pairs/site_frame.h) the mean square distance of a bead from its site, and self-diffusion of the
// centre R from its mean-square displacement, as analysis/displacements.h has it. In a solvent, free particles that belong to no
// molecule, also g(q) of the solvent around the centres and their exclusion radius (analysis/fluid_around.h).
#include <array>

#include "odpd/analysis/displacements.h"
#include "odpd/analysis/fluid_around.h"
#include "odpd/analysis/molecule_beads.h"
#include "odpd/analysis/msd.h"

namespace odpd {

struct MoleculesSettings {
  MsdSettings msd;             ///< lags and directions of the centre's displacements
  FluidAroundSettings around;  ///< g(q)
};

template <int D>
class MoleculeStatistics : public Observer<D> {
 public:
  /// `in_time`: steps are steps in time; otherwise there is no diffusion.
  MoleculeStatistics(ObserverSettings settings, MoleculesSettings molecules, const Scene<D>& scene,
                     double dt, bool in_time);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override;
  std::vector<double> series_row() const override;
  void save(StateWriter& out) const override;
  void load(const StateReader& in) override;

 private:
  /// Where the particles stood when the window began, unwrapped.
  std::string column() const { return "observer_" + this->named("origin"); }
  std::vector<double> shapes(const Particles<D>& particles, const Stage<D>& stage) const;
  void follow(const Particles<D>& particles);
  void count_solvent(const Particles<D>& particles, const Stage<D>& stage);
  bool is_solvent(const Particles<D>& particles, std::size_t i) const;

  MsdSettings msd_;
  const Scene<D>& scene_;
  bool in_time_;
  MoleculeBeads<D> beads_;
  std::vector<double> population_;  // molecules of each kind
  std::int64_t solvent_ = 0;        // particles
  FluidAround<D> around_;
  // A sample, per kind: length, its square, R_g^2, square distance from the sites.
  Displacements displacements_;
};

}  // namespace odpd
