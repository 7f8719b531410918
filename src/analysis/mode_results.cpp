#include "odpd/analysis/mode_results.h"

#include <fmt/format.h>

#include <cmath>

#include "odpd/analysis/least_squares.h"

namespace odpd {

std::string ModeResults::scalar(const std::string& what, std::size_t wave) const {
  return fmt::format("{}.{}.{}", name, what, wave + 1);
}

void ModeResults::add_extrapolation(Results& results, std::size_t waves,
                                    const ErrorOf& error_of) const {
  Scalar zero{name + ".eta_0"}, curvature{name + ".curvature"};
  std::vector<double> x, y, error;
  for (std::size_t wave = 0; wave < waves; ++wave) {
    const Scalar* eta = results.find(scalar("eta", wave));
    if (!(eta->standard_error > 0.0)) break;
    x.push_back(k[wave] * k[wave]);
    y.push_back(eta->mean);
    error.push_back(eta->standard_error);
  }
  if (x.size() == waves && waves >= 2) {
    const PolynomialFit fit = fit_polynomial(1, x, y, error);
    for (std::size_t p = 0; p < 2; ++p) {
      Scalar& scalar = p == 0 ? zero : curvature;
      scalar.mean = fit.coefficient[p];
      scalar.standard_error = error_of([&](const std::vector<double>& eta) {
        double sum = 0.0;
        for (std::size_t wave = 0; wave < waves; ++wave) sum += fit.weight[p][wave] * eta[wave];
        return sum;
      });
    }
    std::string note = fmt::format("{}: eta_0 + {} k^2 fitted up to k = {:.4g}", zero.name,
                                   curvature.name, k[waves - 1]);
    if (waves > 2) note += fmt::format(", reduced chi^2 {:.2g}", fit.reduced_chi_square);
    results.notes.push_back(std::move(note));
  }
  results.scalars.push_back(std::move(zero));
  results.scalars.push_back(std::move(curvature));
}

Table ModeResults::by_k(const Results& results, const std::vector<std::string>& what) const {
  Table table;
  table.comment = {"viscosity at wave numbers k = 2 pi number/(edge of the box)"};
  table.columns = {"number", "k"};
  for (const std::string& column : what) {
    table.columns.push_back(column);
    table.columns.push_back(column + "_error");
  }
  for (std::size_t wave = 0; wave < k.size(); ++wave) {
    std::vector<double> row{static_cast<double>(numbers[wave]), k[wave]};
    for (const std::string& column : what) {
      const Scalar* value = results.find(scalar(column, wave));
      row.push_back(value->mean);
      row.push_back(value->standard_error);
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Chart ModeResults::chart(const Results& results, std::size_t waves) const {
  Chart chart{
      .title = "Viscosity by wave number", .x_label = "k", .y_label = "eta(k)", .curves = {}};
  Curve eta{.title = "measured", .x = k, .y = {}, .error = {}};
  Curve affine{.title = "eta_inf(k)", .x = k, .y = {}, .error = {}};
  for (std::size_t wave = 0; wave < k.size(); ++wave) {
    const Scalar* measured = results.find(scalar("eta", wave));
    eta.y.push_back(measured->mean);
    eta.error.push_back(measured->standard_error);
    affine.y.push_back(results.find(scalar("eta_inf", wave))->mean);
  }
  chart.curves = {std::move(eta), std::move(affine)};
  const double zero = results.find(name + ".eta_0")->mean;
  const double curvature = results.find(name + ".curvature")->mean;
  if (std::isnan(zero)) return chart;
  Curve fit{.title = "eta_0 + a k^2", .x = {}, .y = {}, .error = {}, .line = true, .points = false};
  constexpr int points = 20;
  for (int n = 0; n <= points; ++n) {
    fit.x.push_back(k[waves - 1] * n / points);
    fit.y.push_back(zero + curvature * fit.x.back() * fit.x.back());
  }
  chart.curves.push_back(std::move(fit));
  return chart;
}

Table ModeResults::moduli(double lowest, double highest, const Viscosity& viscosity) const {
  constexpr double per_decade = 10.0;
  Table table;
  table.comment = {"storage modulus G' and dynamic viscosity eta' with one time of the memory"};
  table.columns = {"omega"};
  for (std::size_t wave = 1; wave <= k.size(); ++wave) {
    table.columns.push_back(fmt::format("storage_{}", wave));
    table.columns.push_back(fmt::format("viscosity_{}", wave));
  }
  const auto points = static_cast<int>(per_decade * std::log10(highest / lowest));
  for (int n = 0; n <= points; ++n) {
    const double omega = lowest * std::pow(10.0, n / per_decade);
    std::vector<double> row{omega};
    for (std::size_t wave = 0; wave < k.size(); ++wave) {
      const std::complex<double> eta = viscosity(wave, omega);
      row.push_back(-omega * eta.imag());
      row.push_back(eta.real());
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Chart ModeResults::modulus_chart(const Table& moduli, bool positive) const {
  Chart chart{.title = "Storage modulus",
              .x_label = "omega",
              .y_label = "G'",
              .log_x = true,
              .log_y = positive,
              .curves = {}};
  for (std::size_t wave = 0; wave < k.size(); ++wave) {
    Curve curve{.title = fmt::format("k = {:.4g}", k[wave]),
                .x = {},
                .y = {},
                .error = {},
                .line = true,
                .points = false};
    for (const auto& row : moduli.rows) {
      const double storage = row[1 + 2 * wave];
      if (std::isnan(storage) || (positive && !(storage > 0.0))) continue;
      curve.x.push_back(row[0]);
      curve.y.push_back(storage);
    }
    if (!curve.x.empty()) chart.curves.push_back(std::move(curve));
  }
  return chart;
}

}  // namespace odpd
