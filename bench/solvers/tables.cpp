// results.csv and the others as one markdown page.
#include <fmt/format.h>

#include <cmath>
#include <ctime>

#include "backends.h"
#include "benchmark.h"
#include "odpd/app/info.h"
#include "odpd/core/isa.h"
#include "odpd/io/file.h"
#include "odpd/version.h"
#include "prediction.h"

namespace bench {

namespace {

using Words = std::vector<std::string>;

Words behind(Words keys) {
  keys.insert(keys.end(), measured_columns.begin(), measured_columns.end());
  return keys;
}

std::string dimensional(const std::string& dimension) { return dimension + "D"; }

/// Solve and a set-up: the first one (setup_s), or that of a solver bound again (rebind_s).
double total(const Results& solves, std::size_t row, const std::string& setup) {
  return row < solves.size() ? solves.number(row, setup) + solves.number(row, "solve_s") : NAN;
}

/// A cell with one value per tolerance: "12 / 34 / 56".
template <class Value>
std::string per_tolerance(const Words& tolerances, const Value& value) {
  std::string cell;
  for (const std::string& tolerance : tolerances)
    cell += (cell.empty() ? "" : " / ") + value(tolerance);
  return cell;
}

/// All backends on one configuration.
std::string solve_rows(const Results& solves, const Words& key, const Words& tolerances,
                       const std::string& threads) {
  std::string text;
  const auto row_of = [&](const std::string& backend, const std::string& tolerance) {
    return solves.find({key[0], key[1], key[2], backend, tolerance, threads});
  };
  for (const Backend& backend : backends()) {
    std::size_t ok = solves.size();
    std::string why;
    for (const std::string& tolerance : tolerances) {
      const std::size_t row = row_of(backend.name, tolerance);
      if (row == solves.size()) continue;
      if (solves.word(row, "status") == "ok")
        ok = row;
      else
        why = solves.word(row, "status") + ": " + solves.word(row, "note");
    }
    if (ok == solves.size()) {
      if (!why.empty())
        text += markdown_row({key[2], backend.name, why, "", "", "", "", "", "", ""});
      continue;
    }
    const auto cell = [&](const std::string& column) {
      return [&solves, &backend, &row_of, column](const std::string& tolerance) {
        const std::size_t row = row_of(backend.name, tolerance);
        return row < solves.size() ? solves.word(row, column) : std::string("-");
      };
    };
    const auto ratio = [&](const std::string& setup) {
      return [&solves, &backend, &row_of, setup](const std::string& tolerance) {
        return digits(total(solves, row_of(backend.name, tolerance), setup) /
                      total(solves, row_of("pcg", tolerance), setup));
      };
    };
    text += markdown_row(
        {key[2], backend.name, per_tolerance(tolerances, cell("iterations")),
         per_tolerance(tolerances, cell("setup_s")), per_tolerance(tolerances, cell("rebind_s")),
         per_tolerance(tolerances, cell("solve_s")), per_tolerance(tolerances, cell("error")),
         solves.word(ok, "bytes_per_particle") + "; " + solves.word(ok, "peak_bytes_per_particle"),
         per_tolerance(tolerances, ratio("setup_s")),
         per_tolerance(tolerances, ratio("rebind_s"))});
  }
  return text;
}

std::string solve_tables(const Results& solves) {
  std::string text;
  const Words tolerances = solves.distinct("tolerance");
  const std::string at = per_tolerance(tolerances, [](const std::string& t) { return t; });
  for (const std::string& threads : solves.distinct("threads"))
    for (const std::string& dimension : solves.distinct("dimension"))
      for (const std::string& geometry : solves.distinct("geometry")) {
        text += fmt::format("\n## One solve, {}, {}, {} thread(s), tolerances {}\n\n",
                            dimensional(dimension), geometry, threads, at);
        text += markdown_head({"N", "backend", "iterations", "set-up s", "set-up again s",
                               "solve s", "error in v", "bytes/particle: own, peak",
                               "(set-up + solve) / pcg's", "(set-up again + solve) / pcg's"});
        for (const std::string& size : solves.distinct("N"))
          text += solve_rows(solves, {dimension, geometry, size}, tolerances, threads);
      }
  return text;
}

/// Bytes per particle that one product in double precision must move: each edge twice (D doubles and an index), x in and y out.
double product_bytes(double dimension, double neighbours) {
  return neighbours * (8.0 * dimension + 4.0) + 2.0 * 8.0 * dimension + 8.0;
}

double bandwidth(const Results& triad, const std::string& threads) {
  double last = NAN;
  for (std::size_t k = 0; k < triad.size(); ++k)
    if (triad.word(k, "threads") == threads) last = triad.number(k, "GB_s");
  return last;
}

std::string product_table(const Tables& tables) {
  const std::string backend = own_backends().back().name;
  std::string text =
      "\n## The product with R in double and in single precision, and one iteration of " + backend +
      "\n\n";
  text += markdown_head({"", "N", "threads", "neighbours", "operator ns/particle",
                         "double ns/particle", "bytes", "of triad", "single ns/particle", "bytes",
                         "of triad", "iteration ns/particle", "bytes", "of triad"});
  const Results& products = tables.products;
  const Results& solves = tables.solves;
  for (std::size_t k = 0; k < products.size(); ++k) {
    const auto number = [&](const char* column) { return products.number(k, column); };
    const std::string threads = products.word(k, "threads");
    const std::size_t row =
        solves.find({products.word(k, "dimension"), products.word(k, "geometry"),
                     products.word(k, "N"), backend, "1e-05", threads});
    const double iteration =
        row < solves.size()
            ? 1e9 * solves.number(row, "solve_s") / solves.number(row, "iterations") / number("N")
            : NAN;
    std::vector<std::string> cells{
        dimensional(products.word(k, "dimension")) + " " + products.word(k, "geometry"),
        products.word(k, "N"), threads, products.word(k, "neighbours"),
        products.word(k, "rebuild_ns")};
    const auto add = [&](double ns, double bytes) {
      cells.insert(cells.end(),
                   {digits(ns), digits(bytes), digits(bytes / ns / number("triad_GB_s"))});
    };
    add(number("product_ns"), product_bytes(number("dimension"), number("neighbours")));
    add(number("packed_ns"), number("packed_bytes"));
    add(iteration, number("iteration_bytes"));
    text += markdown_row(cells);
  }
  return text;
}

std::string step_table(const Results& steps) {
  std::string text =
      "\n## The trapezoidal step by phase, ns per particle and step (two solves by pcg)\n\n";
  text += markdown_head({"", "N", "tolerance", "threads", "iterations per solve", "neighbours",
                         "edges", "noise", "assembly", "solve", "rest", "all"});
  for (std::size_t k = 0; k < steps.size(); ++k)
    text += markdown_row({dimensional(steps.word(k, "dimension")) + " " + steps.word(k, "geometry"),
                          steps.word(k, "N"), steps.word(k, "tolerance"), steps.word(k, "threads"),
                          steps.word(k, "iterations"), steps.word(k, "neighbours_ns"),
                          steps.word(k, "edges_ns"), steps.word(k, "noise_ns"),
                          steps.word(k, "assembly_ns"), steps.word(k, "solve_ns"),
                          steps.word(k, "rest_ns"), steps.word(k, "all_ns")});
  return text;
}

}  // namespace

Results solve_results(const std::filesystem::path& file) {
  return {file, behind({"dimension", "geometry", "N", "backend", "tolerance", "threads"}), 6};
}

Tables::Tables(const std::filesystem::path& out)
    : solves(solve_results(out / "results.csv")),
      products(out / "products.csv",
               {"dimension", "geometry", "N", "threads", "neighbours", "rebuild_ns", "product_ns",
                "packed_ns", "packed_bytes", "iteration_bytes", "triad_GB_s"},
               4),
      steps(
          out / "steps.csv",
          {"dimension", "geometry", "N", "tolerance", "threads", "steps", "iterations",
           "neighbours_ns", "edges_ns", "noise_ns", "assembly_ns", "solve_ns", "rest_ns", "all_ns"},
          5),
      triad(out / "triad.csv", {"unix_time", "threads", "GB_s"}, 2) {}

std::string table_head(const std::string& title) {
  const std::time_t now = std::time(nullptr);
  char date[32] = "";
  std::strftime(date, sizeof date, "%Y-%m-%d", std::localtime(&now));
  return fmt::format("# {}\n\n{}, odpd {}, {} with {}, instruction path {}; {}.\n", title, date,
                     ODPD_VERSION, ODPD_BUILD_TYPE, ODPD_COMPILER, odpd::isa_name(odpd::isa()),
                     odpd::machine_text());
}

void write_comparison(const Tables& tables, const std::filesystem::path& out) {
  std::string text = table_head("Solver benchmark");
  text += "\n## STREAM triad\n\n" + markdown_head({"threads", "GB/s, last run"});
  for (const std::string& threads : tables.triad.distinct("threads"))
    text += markdown_row({threads, digits(bandwidth(tables.triad, threads))});
  text += solve_tables(tables.solves) + product_table(tables) + step_table(tables.steps);
  odpd::write_file_atomically(out / "table.md", text);
}

}  // namespace bench
