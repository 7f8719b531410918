// study_page of study_report.h.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "odpd/app/info.h"
#include "odpd/app/report.h"
#include "odpd/app/study_report.h"
#include "odpd/io/file.h"
#include "odpd/version.h"

namespace odpd {

namespace {

constexpr const char* style = R"(
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.2rem; margin-top: 2.2rem; }
figure { margin: 1rem 0; } figure svg { max-width: 100%; height: auto; border: 1px solid #ddd; }
table { border-collapse: collapse; font-size: 0.85rem; } .wide { overflow-x: auto; }
th, td { border: 1px solid #ddd; padding: 0.2rem 0.5rem; text-align: right; white-space: nowrap; }
th { background: #f4f4f4; } td.word { text-align: left; } td.message { text-align: left; white-space: normal; }
.ok { background: #a8d8b9; } .biased { background: #fdc27a; } .unclear { background: #dddddd; } .blew, .failed { background: #e57368; }
pre { background: #f6f6f6; padding: 0.8rem; overflow-x: auto; font-size: 0.85rem; }
)";

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

// An SVG file as part of a page: without the XML declaration and document type before it, and with names of its own, as
// pictures of one page share them.
std::string inline_svg(const std::string& text, std::size_t number) {
  const std::size_t begin = text.find("<svg");
  if (begin == std::string::npos) return "";
  std::string svg = text.substr(begin);
  const std::string title = "<title>Gnuplot</title>";  // would pop up over the picture
  if (const std::size_t at = svg.find(title); at != std::string::npos) svg.erase(at, title.size());
  for (const std::string mark : {"id=\"", "id='", "href=\"#", "href='#", "url(#"}) {
    const std::string tag = fmt::format("p{}_", number);
    for (std::size_t at = svg.find(mark); at != std::string::npos;
         at = svg.find(mark, at + mark.size() + tag.size()))
      svg.insert(at + mark.size(), tag);
  }
  return svg;
}

std::string explanation(const StudyResults& results) {
  const StudySettings& study = results.settings;
  const bool lines = study.sweep < study.axes.size();
  std::string text = "<p>In a chart of speed and accuracy each line is a method";
  if (lines)
    text +=
        fmt::format(" and each of its points a value of {}", escaped(study.axes[study.sweep].name));
  text +=
      ": lower is more accurate, further left is cheaper, and on the grey Pareto front no other "
      "point is both. Bars are one "
      "standard error; a hollow symbol is a point whose error is below twice its standard error, "
      "so that it stands at "
      "this upper limit and is as good as the runs could tell. In a map a cell is green where the "
      "bias is within the "
      "tolerance, orange where it is beyond (by how much), grey where the runs were too short to "
      "tell, and red where a "
      "run ended with an error, at the time that is written in it.</p>\n";
  return text;
}

std::string references(const StudyResults& results) {
  const StudySettings& study = results.settings;
  std::string text = "<ul>\n";
  for (std::size_t o = 0; o < study.observables.size(); ++o) {
    const StudyObservable& observable = study.observables[o];
    text += fmt::format("<li><b>{}</b>, tolerance {:g}: against ", escaped(observable.name),
                        observable.tolerance);
    if (observable.kind == ReferenceKind::number) {
      text += fmt::format("{:g}", observable.number);
    } else {
      std::vector<std::size_t> told;
      for (const Finding& f : results.findings) {
        if (f.observable != o) continue;
        const std::size_t reference = results.plan.reference[f.point][o];
        if (std::find(told.begin(), told.end(), reference) != told.end()) continue;
        text += (told.empty() ? "" : "; ") + escaped(results.plan.points[reference].label);
        if (observable.table.empty())
          text += ": " + with_error(f.reference.mean, f.reference.standard_error);
        told.push_back(reference);
      }
    }
    text += "</li>\n";
  }
  return text + "</ul>\n";
}

std::string row(const StudyResults& results, const Finding& f) {
  const StudySettings& study = results.settings;
  const StudyPoint& point = results.plan.points[f.point];
  std::string text = "<tr>";
  for (std::size_t k = 0; k < study.axes.size(); ++k)
    text += "<td class=\"word\">" + escaped(study.axes[k].values[point.at[k]].label) + "</td>";
  const std::string verdict = f.verdict_text();
  std::string note = f.message;
  if (f.is_reference) note = "the reference itself";
  if (f.out_of_time)
    note += std::string(note.empty() ? "" : "; ") + "stopped by the limit of seconds";
  const bool biased = std::isfinite(f.bias) && !f.is_reference;
  text += fmt::format(
      "<td class=\"word\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td "
      "class=\"{}\">{}</td><td>{}</td><td>{}</td>"
      "<td>{}</td><td class=\"message\">{}</td></tr>\n",
      escaped(study.observables[f.observable].name), f.seeds,
      f.seeds > 0 ? with_error(f.value.mean, f.value.standard_error) : "",
      biased ? fmt::format("{:+.2g}", f.bias) : "", biased ? fmt::format("{:.2g}", f.sigma) : "",
      f.verdict == Verdict::blew_up ? "blew" : verdict_name(f.verdict),
      f.ended_with_error() && std::isfinite(f.blew_up_at)
          ? fmt::format("{} at t = {:.3g}", verdict, f.blew_up_at)
          : verdict,
      f.on_front ? "&#9679;" : "", std::isfinite(f.cost) ? fmt::format("{:.3g}", f.cost) : "",
      fmt::format("{:.1f}", f.wall_seconds), escaped(note));
  return text;
}

std::string table(const StudyResults& results) {
  std::string text = "<div class=\"wide\"><table>\n<tr>";
  for (const StudyAxis& axis : results.settings.axes) text += "<th>" + escaped(axis.name) + "</th>";
  text +=
      "<th>observable</th><th>seeds</th><th>value</th><th>bias</th><th>its "
      "s.e.</th><th>verdict</th><th>Pareto</th><th>s/time</th>"
      "<th>wall s</th><th>note</th></tr>\n";
  for (const Finding& f : results.findings) text += row(results, f);
  return text + "</table></div>\n";
}

std::string commands(const StudyResults& results) {
  std::string text;
  for (const StudyPoint& point : results.plan.points)
    for (const StudyRun& run : point.runs) text += run_command(results.settings, run) + "\n";
  return text;
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  return fmt::format("{:%Y-%m-%d}", fmt::localtime(now));
}

}  // namespace

std::string study_page(const StudyResults& results, const std::vector<StudyPicture>& pictures,
                       const std::vector<std::string>& svg) {
  const StudySettings& study = results.settings;
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta "
      "charset=\"utf-8\">\n<title>{0}</title>\n<style>{1}</style>\n</head>\n"
      "<body>\n<h1>{0}</h1>\n<p>{2} points of <code>{3}</code>, {4} seed(s) each; odpd {5} on {6}, "
      "{7} thread(s) per run, {8}.</p>\n",
      escaped(study.title), style, results.plan.points.size(), escaped(study.case_path.string()),
      study.seeds, ODPD_VERSION, escaped(machine_text()), results.threads, today());
  page += explanation(results);
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    page += fmt::format("<h2>{}</h2>\n", escaped(pictures[k].heading));
    page += svg[k].empty() ? "<p>No picture: gnuplot is not installed.</p>\n"
                           : "<figure>" + inline_svg(svg[k], k) + "</figure>\n";
  }
  page += "<h2>References</h2>\n" + references(results);
  page +=
      "<h2>All points</h2>\n<p>The bias is relative to the reference (of a table: the rms "
      "difference). Seconds per unit of "
      "simulated time are those of the steps, without measuring and writing.</p>\n" +
      table(results);
  page += fmt::format("<h2>To reproduce it</h2>\n<pre>{}</pre>\n", escaped(results.command));
  page += fmt::format("<details><summary>One command per run</summary><pre>{}</pre></details>\n",
                      escaped(commands(results)));
  page += fmt::format("<details><summary>The study file</summary><pre>{}</pre></details>\n",
                      escaped(read_file(study.file)));
  return page + "</body>\n</html>\n";
}

}  // namespace odpd
