// suspension*.csv as one markdown page, and charts of them.
#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "odpd/io/file.h"
#include "odpd/io/gnuplot.h"
#include "suspension.h"

namespace bench {

namespace {

using Words = std::vector<std::string>;

std::string ratio_of(double a, double b) {
  return std::isfinite(a / b) ? fmt::format("{:.2f}", a / b) : "-";
}

std::size_t fluid_of(const Results& scenes, std::size_t row) {
  return scenes.find({scenes.word(row, "dimension"), scenes.word(row, "N"), "0", "0"});
}

/// Set-up that a run pays and solve.
double again(const Results& scenes, std::size_t row, const std::string& whose) {
  return scenes.number(row, whose + "rebind_s") + scenes.number(row, whose + "solve_s");
}

/// The largest of the ratios of iterations, fresh and aged.
double worst_ratio(const Results& scenes, std::size_t row) {
  const std::size_t fluid = fluid_of(scenes, row);
  double worst = 0.0;
  for (const char* column : {"fresh", "aged", "most"})
    worst = std::fmax(worst, scenes.number(row, column) / scenes.number(fluid, column));
  return worst;
}

std::string scene_table(const Results& scenes) {
  std::string text = fmt::format(
      "\n## One solve to 1e-7\n\n"
      "Sites of a body and the least distance of two. Neighbours within the cutoff, but those of "
      "the "
      "same body, with bodies / in the fluid. Iterations of a solver made anew / of one {} steps "
      "old "
      "/ the most in any solve of these steps.\n\n",
      aged_steps);
  text +=
      markdown_head({"", "N", "share", "radius", "sites, spacing", "bodies", "neighbours",
                     "iterations", "the fluid's", "worst ratio", "bound", "fell back", "set-up s",
                     "set-up again s", "solve s", "set-up again + solve over the fluid's"});
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    const auto word = [&](const char* column) { return scenes.word(k, column); };
    if (word("radius") == "0") continue;
    Words cells{word("dimension") + "D", word("N"), word("share"), word("radius")};
    if (word("status") != "ok") {
      cells.push_back(word("status") + ": " + word("note"));
      cells.resize(16);
      text += markdown_row(cells);
      continue;
    }
    const auto iterations = [&](std::size_t row) {
      return scenes.word(row, "fresh") + " / " + scenes.word(row, "aged") + " / " +
             scenes.word(row, "most");
    };
    cells[2] = word("real_share");
    cells.insert(
        cells.end(),
        {word("sites") + ", " + word("spacing"), word("bodies"),
         word("neighbours") + " / " + scenes.word(fluid_of(scenes, k), "neighbours"), iterations(k),
         iterations(fluid_of(scenes, k)), fmt::format("{:.2f}", worst_ratio(scenes, k)),
         digits(allowed_ratio(scenes.number(k, "spacing"))), word("fallbacks"), word("setup_s"),
         word("rebind_s"), word("solve_s"),
         ratio_of(again(scenes, k, ""), again(scenes, k, "fluid_"))});
    text += markdown_row(cells);
  }
  return text;
}

std::string suspension_step_table(const Results& steps) {
  std::string text =
      "\n## The trapezoidal step by phase, two solves to 1e-5, ns per particle and step\n\nWith "
      "bodies / of the fluid, in one run.\n\n";
  const Words phases{"neighbours_ns", "edges_ns", "noise_ns", "assembly_ns", "solve_ns", "rest_ns"};
  text +=
      markdown_head({"", "N", "share", "radius", "iterations per solve", "neighbours", "edges",
                     "noise", "assembly", "solve", "rest", "all", "solve, ratio", "all, ratio"});
  for (std::size_t k = 0; k + 1 < steps.size(); ++k) {
    if (steps.word(k, "which") != "bodies") continue;
    const std::size_t fluid = k + 1;
    const auto both = [&](const std::string& column) {
      return steps.word(k, column) + " / " + steps.word(fluid, column);
    };
    const auto ratio = [&](const char* column) {
      return ratio_of(steps.number(k, column), steps.number(fluid, column));
    };
    Words cells{steps.word(k, "dimension") + "D", steps.word(k, "N"), steps.word(k, "share"),
                steps.word(k, "radius"), both("iterations")};
    for (const std::string& phase : phases) cells.push_back(both(phase));
    cells.insert(cells.end(), {both("all_ns"), ratio("solve_ns"), ratio("all_ns")});
    text += markdown_row(cells);
  }
  return text;
}

double total(const Results& solves, std::size_t row, const char* setup) {
  return solves.number(row, setup) + solves.number(row, "solve_s");
}

/// The packaged backend that is fastest with this set-up; size() where none solved it.
std::size_t best_packaged(const Results& solves, const Words& key, const char* setup) {
  std::size_t best = solves.size();
  for (std::size_t k = 0; k < solves.size(); ++k) {
    if (solves.word(k, "dimension") != key[0] || solves.word(k, "geometry") != key[1] ||
        solves.word(k, "N") != key[2] || solves.word(k, "status") != "ok" ||
        solves.word(k, "backend") == "pcg" || !std::isfinite(total(solves, k, setup)))
      continue;
    if (best == solves.size() || total(solves, k, setup) < total(solves, best, setup)) best = k;
  }
  return best;
}

std::string backend_table(const Results& solves) {
  std::string text =
      "\n## Against the best packaged backend on the same P^T R P, to 1e-7, set-up and solve, "
      "s\n\n";
  text += markdown_head({"", "scene", "N", "pcg first", "again", "best packaged, first", "ratio",
                         "best packaged, again", "ratio"});
  for (std::size_t k = 0; k < solves.size(); ++k) {
    if (solves.word(k, "backend") != "pcg") continue;
    const Words key{solves.word(k, "dimension"), solves.word(k, "geometry"), solves.word(k, "N")};
    Words cells{key[0] + "D", key[1], key[2], digits(total(solves, k, "setup_s")),
                digits(total(solves, k, "rebind_s"))};
    for (const char* setup : {"setup_s", "rebind_s"}) {
      const std::size_t best = best_packaged(solves, key, setup);
      if (best == solves.size()) {
        cells.insert(cells.end(), {"-", "-"});
        continue;
      }
      cells.push_back(fmt::format("{} {}; {} iterations", solves.word(best, "backend"),
                                  digits(total(solves, best, setup)),
                                  solves.word(best, "iterations")));
      cells.push_back(fmt::format("{:.1f}", total(solves, best, setup) / total(solves, k, setup)));
    }
    text += markdown_row(cells);
  }
  text += "\nAll of them:\n\n" + markdown_head({"", "scene", "N", "backend", "iterations", "set-up",
                                                "again", "solve", ""});
  for (std::size_t k = 0; k < solves.size(); ++k)
    text += markdown_row({solves.word(k, "dimension") + "D", solves.word(k, "geometry"),
                          solves.word(k, "N"), solves.word(k, "backend"),
                          solves.word(k, "iterations"), solves.word(k, "setup_s"),
                          solves.word(k, "rebind_s"), solves.word(k, "solve_s"),
                          solves.word(k, "status") == "ok"
                              ? ""
                              : solves.word(k, "status") + ": " + solves.word(k, "note")});
  return text;
}

/// Iterations of a fresh solver against N where a scene has several sizes.
std::string size_table(const Results& scenes) {
  const Words sizes = scenes.distinct("N");
  if (sizes.size() < 2) return "";
  std::string text = "\n## Iterations to 1e-7 against N, of a solver made anew\n\n";
  Words head{"", "share", "radius"};
  head.insert(head.end(), sizes.begin(), sizes.end());
  text += markdown_head(head);
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    if (scenes.word(k, "N") != sizes.back() || scenes.word(k, "status") != "ok") continue;
    Words cells{scenes.word(k, "dimension") + "D", scenes.word(k, "share"),
                scenes.word(k, "radius")};
    for (const std::string& size : sizes) {
      const std::size_t row = scenes.find(
          {scenes.word(k, "dimension"), size, scenes.word(k, "share"), scenes.word(k, "radius")});
      cells.push_back(row < scenes.size() ? scenes.word(row, "fresh") : "-");
    }
    text += markdown_row(cells);
  }
  return text;
}

std::string robustness_table(const Results& results) {
  if (results.size() == 0) return "";
  std::string text =
      "\n## Where solvers may fail: iterations to 1e-7, share 0.3 of radius 1 where nothing else "
      "is "
      "said\n\n";
  text += markdown_head({"", "scene", "N", "iterations", "the fluid's", "ratio", "bound", "", ""});
  for (std::size_t k = 0; k < results.size(); ++k)
    text += markdown_row(
        {results.word(k, "dimension") + "D", results.word(k, "scene"), results.word(k, "N"),
         results.word(k, "iterations"), results.word(k, "fluid"), results.word(k, "ratio"),
         results.word(k, "bound"), results.word(k, "verdict"), results.word(k, "note")});
  return text;
}

using Value = std::function<double(std::size_t row)>;

/// A curve per share over the radius.
void draw_over_radius(const std::string& name, odpd::Chart chart, const Results& rows,
                      const std::string& dimension, const std::string& size, const Value& value,
                      const std::filesystem::path& out) {
  chart.x_label = "radius";
  chart.log_x = true;
  for (const std::string& share : rows.distinct("share")) {
    odpd::Curve curve{.title = "share " + share, .x = {}, .y = {}, .error = {}, .line = true};
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (rows.word(k, "dimension") != dimension || rows.word(k, "N") != size ||
          rows.word(k, "share") != share || rows.word(k, "radius") == "0" ||
          !std::isfinite(value(k)))
        continue;
      curve.x.push_back(rows.number(k, "radius"));
      curve.y.push_back(value(k));
    }
    if (!curve.x.empty()) chart.curves.push_back(std::move(curve));
  }
  if (!chart.curves.empty())
    odpd::draw_chart(out / fmt::format("suspension_{}_{}d_{}", name, dimension, size), chart);
}

void draw(const SuspensionTables& tables, const std::filesystem::path& out) {
  const Results& scenes = tables.scenes;
  const Results& steps = tables.steps;
  for (const std::string& dimension : scenes.distinct("dimension"))
    for (const std::string& size : scenes.distinct("N")) {
      const std::string where = fmt::format("{}D, N = {}", dimension, size);
      odpd::Chart chart;
      chart.title = "Iterations to 1e-7 after 50 steps: " + where;
      chart.y_label = "iterations";
      const std::size_t fluid = scenes.find({dimension, size, "0", "0"});
      const double flat = fluid < scenes.size() ? scenes.number(fluid, "aged") : NAN;
      if (std::isfinite(flat))
        chart.curves.push_back(
            {.title = "fluid", .x = {0.5, 4.0}, .y = {flat, flat}, .error = {}, .line = true});
      draw_over_radius(
          "iterations", chart, scenes, dimension, size,
          [&](std::size_t k) { return scenes.number(k, "aged"); }, out);
      chart.curves.clear();
      chart.title = "Time of a step over that of the fluid: " + where;
      chart.y_label = "ratio";
      draw_over_radius(
          "step", chart, steps, dimension, size,
          [&](std::size_t k) {
            if (steps.word(k, "which") != "bodies") return double{NAN};
            return steps.number(k, "all_ns") / steps.number(k + 1, "all_ns");
          },
          out);
    }
}

}  // namespace

SuspensionTables::SuspensionTables(const std::filesystem::path& out)
    : scenes(out / "suspension.csv",
             {"dimension", "N",       "share",         "radius",         "status",
              "sites",     "bodies",  "real_share",    "spacing",        "neighbours",
              "fresh",     "aged",    "most",          "fallbacks",      "setup_s",
              "rebind_s",  "solve_s", "fluid_setup_s", "fluid_rebind_s", "fluid_solve_s",
              "note"},
             4),
      steps(out / "suspension_steps.csv",
            {"dimension", "N", "share", "radius", "which", "iterations", "neighbours_ns",
             "edges_ns", "noise_ns", "assembly_ns", "solve_ns", "rest_ns", "all_ns"},
            5),
      backends(solve_results(out / "suspension_backends.csv")),
      robustness(
          out / "suspension_robustness.csv",
          {"scene", "dimension", "N", "iterations", "fluid", "ratio", "bound", "verdict", "note"},
          3) {}

void write_suspension(const SuspensionTables& tables, const std::filesystem::path& out) {
  odpd::write_file_atomically(
      out / "suspension.md",
      table_head("Suspensions against a fluid of as many particles, one thread") +
          scene_table(tables.scenes) + size_table(tables.scenes) +
          suspension_step_table(tables.steps) + backend_table(tables.backends) +
          robustness_table(tables.robustness));
  draw(tables, out);
}

}  // namespace bench
