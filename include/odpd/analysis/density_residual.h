#pragma once
// Unevenness of the time-averaged density n_b over the N_b bins of a grid between the wall surfaces, n their mean:
//
//   paper   (1/N_b) sqrt(sum_b (n_b - n)^2)      (Phan-Thien et al. 2016, eq. 49)
//   thesis  sqrt(sum_b (n_b - n)^2 / N_b)        (Nguyen 2021, eq. 3.41)
//
// Cells whose centre is within a distance of a fixed body's centre can be left out (the paper's figure 8 leaves out a circle of
// radius 1): they are not among the N_b. Both contain sampling noise that falls with the averaging time. `noise` is what the standard errors of the n_b (block averaging)
// make of the thesis' number alone, sqrt(sum_b error_b^2 / N_b), and excess = sqrt(max(thesis^2 - noise^2, 0)) is what is left: 0 for
// an even fluid however short the run. What walls do to the fluid at rest stays in it: subtract a run at rest of the same length.
#include "odpd/analysis/grid.h"
#include "odpd/analysis/observer.h"

namespace odpd {

template <int D>
class DensityResidual : public Observer<D> {
 public:
  /// bins: D counts. clear_of_bodies: cells whose centre is nearer than this to a body's are left out.
  DensityResidual(ObserverSettings settings, const typename Grid<D>::Counts& bins,
                  const Scene<D>& scene, double clear_of_bodies = 0.0);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override {
    return {"paper_instant", "thesis_instant"};
  }
  std::vector<double> series_row() const override { return instant_; }
  std::size_t cells() const { return this->average().width(); }

 private:
  DensityResidual(ObserverSettings settings, Grid<D> grid, std::vector<std::size_t> column);
  double thesis_residual(std::span<const double> counts) const;

  Grid<D> grid_;
  std::vector<std::size_t> column_;  // of each cell of the grid; none where it is left out
  std::vector<double> instant_;
};

}  // namespace odpd
