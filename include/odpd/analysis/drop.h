#pragma once
// A drop in its vapour in a periodic box, seen from its centre of mass:
//
//   rho(q)              density of the free particles at distance q from the centre
//   core                the ball of radius r_core about it, in which the drop is liquid and nothing else:
//     rho_c = N_c/V_c,  P_c = [N_c kT + (1/d) sum_edges l r f_c]/V_c,   l: the part of an edge's line inside
//   equimolar radius    that of a ball of rho_c which holds the same excess over the vapour,
//                       omega R^d (rho_c - rho_v) = N - rho_v V,   all within r_max, omega = pi or 4 pi/3
//   laplace             gamma = R (P_c - rho_v kT)/(d - 1), the surface tension by the pressure that it causes (Laplace)
//
// rho_v is the density beyond 3/4 r_max; such vapour is an ideal gas. The centre of mass is that of the nearest images to it; where it
// begins is the mean angle about each periodic direction.
#include "odpd/analysis/observer.h"

namespace odpd {

struct DropSettings {
  double core = 1.0;   ///< r_core (length)
  double r_max = 5.0;  ///< end of rho(q) (length)
  double bin = 0.1;    ///< of rho(q) (length)
};

/// Centre of mass of the free particles in a periodic box, all of whose mass is near one place. All ranks call it together.
template <int D>
Vec<D> centre_of_mass(const Box<D>& box, const Particles<D>& particles,
                      const std::vector<Vec<D>>& positions);

template <int D>
class Drop : public Observer<D> {
 public:
  Drop(ObserverSettings settings, DropSettings drop, const Scene<D>& scene);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override;
  std::vector<double> series_row() const override;

 private:
  // Columns of a sample: density and pressure of the core, then density in each bin.
  enum DropColumn : std::size_t { core_density, core_pressure, first_bin };
  double core_volume() const { return unit_ball_volume<D> * std::pow(drop_.core, D); }
  double edge(std::size_t bin) const { return drop_.bin * static_cast<double>(bin); }
  double shell(std::size_t bin) const;
  double vapour(const std::vector<double>& means) const;
  double radius(const std::vector<double>& means) const;
  double laplace(const std::vector<double>& means) const;

  DropSettings drop_;
  const Scene<D>& scene_;
  std::size_t bins_;
};

}  // namespace odpd
