#pragma once
// Profiles across bins along one axis between the wall surfaces (or the box), from the time averages (Phan-Thien et
// al. 2016, eq. 8-9)
//
//   density  n_b = <N_b>/V_b,   velocity  u_b = <sum_{i in b} v_i>/<N_b>   with v_mid at the middle of the step's path,
//   configurational temperature  <sum |F_i|^2>/<sum lap_i U>
//   angular velocity  w_b = <sum_{i in b} w_i>/<number of them>, of those that spin, like v_mid; beside it in its chart half the curl of
//            the velocity, by differences of neighbouring bins: what slow flows turn particles with
//
// and a least-squares fit of one velocity component over the bins between `fit_from` and `fit_to`:
//   linear    u = u_0 + slope x; with two walls also slope_ratio = slope H/(U_high - U_low) and the slip length
//             b = ((U_high - U_low)/slope - H)/2 with H the distance between the wall surfaces
//   parabola  u = c_0 + c_1 x + c_2 x^2; with a force f, the same in all fitted bins, also the viscosity n f/(-2 c_2), n over
//             these bins, and between walls the slip length from where the parabola reaches the walls' velocity
//   sine      u = c_0 + A <sin(2 pi k x/L)>, averaged over each bin, for the wave of the driving force: with its amplitude F the
//             viscosity n F L^2/(4 pi^2 k^2 A), that of this wavelength
#include <optional>

#include "odpd/analysis/least_squares.h"
#include "odpd/analysis/observer.h"
#include "odpd/core/rotation.h"

namespace odpd {

enum class ProfileFit { none, linear, parabola, sine };

struct ProfileSettings {
  int axis = 1;
  std::int64_t bins = 20;
  ProfileFit fit = ProfileFit::none;
  int component = 0;  ///< of velocity, for the fit
  /// Coordinates; bins whose centres lie between are fitted. Without a fit the range may be empty.
  double fit_from = 0.0, fit_to = 0.0;
};

/// How many bins a fit would use: their centres lie in its range.
template <int D>
std::int64_t fitted_bins(const ProfileSettings& p, const Scene<D>& scene);

template <int D>
class Profile : public Observer<D> {
 public:
  Profile(ObserverSettings settings, ProfileSettings profile, const Scene<D>& scene);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  double moment() const override { return 0.5; }
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override;
  std::vector<double> series_row() const override;

 private:
  // Columns of a bin: count, D velocity sums, |F|^2, laplacian.
  static constexpr std::size_t plain_width = D + 3;
  // Where somebody spins, behind those: count, sums of angular velocities.
  static constexpr std::size_t turns = rotation_components<D>;
  std::size_t width() const { return plain_width + (spinning_ ? 1 + turns : 0); }
  std::size_t column(std::size_t bin, std::size_t k) const { return bin * width() + k; }
  std::int64_t bin_of(const Vec<D>& r) const;
  double centre(std::size_t bin) const;
  Table table() const;
  void add_spin_columns(Table& t) const;
  void add_spin_chart(const Table& t, Results& results) const;
  // The fit over its bins, and the column pairs whose ratios it is linear in; NaN without errors to weigh them by.
  struct FittedBins {
    bool found = false;
    PolynomialFit fit;
    std::vector<BlockAverage::RatioTerm> bins;
    double density = 0.0;  // mean over these bins
  };
  // Velocities of two facing walls along the fitted component.
  struct WallSpeeds {
    double low = 0.0, high = 0.0;
  };
  FittedBins fit_bins() const;
  double abscissa(double x, double bin_width) const;
  double fitted_force() const;
  double coefficient_error(const FittedBins& fitted, std::size_t power) const;
  void add_fit(Results& results, Chart& chart) const;
  void add_linear(const FittedBins& fitted, const std::optional<WallSpeeds>& walls,
                  Results& results, Chart& chart) const;
  void add_parabola(const FittedBins& fitted, const std::optional<WallSpeeds>& walls,
                    Results& results) const;
  void add_sine(const FittedBins& fitted, Results& results) const;

  ProfileSettings profile_;
  const Scene<D>& scene_;
  bool spinning_;
  double low_, high_;
};

}  // namespace odpd
