#pragma once
// The files of a study: tables, pictures and the page.
#include <filesystem>
#include <string>
#include <vector>

#include "odpd/app/study_analysis.h"
#include "odpd/core/table.h"

namespace odpd {

/// A finished or interrupted study as its files tell it.
struct StudyResults {
  StudySettings settings;
  StudyPlan plan;
  std::vector<std::vector<RunOutcome>> outcomes;  ///< [point][run]
  std::vector<Finding> findings;
  std::string command;  ///< that reproduces it
  int threads = 1;
};

/// A picture of the study: `<stem>.svg` and `.png`; either a chart or a map.
struct StudyPicture {
  std::string stem, heading;
  bool is_map = false;
  Chart chart;
  CellMap map;
};

/// The speed-accuracy charts and stability maps of every observable, for each combination of the axes beyond those
/// that a picture shows.
std::vector<StudyPicture> study_pictures(const StudyResults& results);

/// study.csv: a line per point and observable. runs.csv: a line per run.
std::string findings_csv(const StudyResults& results);
std::string runs_csv(const StudyResults& results);

/// The command line that repeats one run.
std::string run_command(const StudySettings& study, const StudyRun& run);

/// One HTML file with everything in it: pictures (SVG texts in the order of `pictures`; empty: none was drawn), table,
/// references, machine, commands.
std::string study_page(const StudyResults& results, const std::vector<StudyPicture>& pictures,
                       const std::vector<std::string>& svg);

}  // namespace odpd
