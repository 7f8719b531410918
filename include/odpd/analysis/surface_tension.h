#pragma once
// Surface tension of a slab in a periodic box, which has two flat surfaces of area A across the direction n, by two routes:
//
//   stress      gamma = L_n/2 (P_n - P_t) = 1/(2 A) sum_edges [r_n f_n - r_t . f_t/(d - 1)]     conservative forces f
//   test area   gamma = [F(x) - F(-x)]/(4 A x),   F(x) = -kT ln <exp(-[U(x) - U(0)]/kT)>
//
// U(x): the energy of the same particles where the configuration, and its box, are stretched by (1 + x)^(1/(d - 1)) along the surfaces
// and by 1/(1 + x) along n, at constant volume (Gloor et al. 2005). As x -> 0, [U(x) - U(-x)]/(4 A x) becomes the sum of the
// first route, configuration by configuration. At kT = 0, F is the mean of U.
//
// Velocities have the same variance in every direction and add nothing. A fluid without surfaces has gamma = 0.
#include <array>

#include "odpd/analysis/observer.h"
#include "odpd/geometry/pair_list.h"

namespace odpd {

struct SurfaceTensionSettings {
  int axis = 0;          ///< n
  double strain = 5e-4;  ///< x
};

template <int D>
class SurfaceTension : public Observer<D> {
 public:
  SurfaceTension(ObserverSettings settings, SurfaceTensionSettings tension, const Scene<D>& scene);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override;
  std::vector<double> series_row() const override;

 private:
  // The box and the configuration in it, stretched by x = strain or -strain.
  struct Stretched {
    Vec<D> factor;
    Box<D> box;
    PairList<D> list;
  };
  Stretched stretched(double x) const;
  double energy(Stretched& to, const Particles<D>& particles,
                const std::vector<Vec<D>>& positions) const;
  double test_area(const std::vector<double>& means) const;

  SurfaceTensionSettings tension_;
  const Scene<D>& scene_;
  double area_;  // of one surface
  std::array<Stretched, 2> stretched_;
};

}  // namespace odpd
