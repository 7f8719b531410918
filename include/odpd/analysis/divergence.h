#pragma once
// How far the time-averaged flow is from divergence-free. On a grid between the wall surfaces, u = <sum v_mid>/<count> per cell (a
// particle counts where it is in the middle of its step) and its central differences (one-sided next to a surface):
//
//   <name>.rms       sqrt(mean over cells of (div u)^2)
//   <name>.noise     the part that the errors of the cell averages alone make of it, from block averaging
//   <name>.gradient  sqrt(mean of sum_ab (d_a u_b)^2), its own noise taken out
//   <name>.relative  sqrt(max(rms^2 - noise^2, 0)) / gradient
//
// (The measure behind fig. 8 of Phan-Thien et al. 2016, which gives no normalisation, and states no noise.)
#include "odpd/analysis/grid.h"
#include "odpd/analysis/observer.h"

namespace odpd {

template <int D>
class Divergence : public Observer<D> {
 public:
  Divergence(ObserverSettings settings, const typename Grid<D>::Counts& cells,
             const Scene<D>& scene);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  double moment() const override { return 0.5; }
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override;

 private:
  using Terms = std::vector<BlockAverage::RatioTerm>;
  std::size_t column(std::size_t cell, std::size_t k) const { return cell * (D + 1) + k; }
  /// Adds d_a u_b at the cell, times `weight`, as ratios of columns.
  void add_derivative(std::size_t cell, int a, int b, Terms& terms) const;
  Terms divergence_at(std::size_t cell) const;
  bool every_cell_was_visited() const;

  // A sample: count and D velocity sums per cell.
  const Scene<D>& scene_;
  Grid<D> grid_;
};

}  // namespace odpd
