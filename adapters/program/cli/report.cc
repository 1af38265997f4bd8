// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/report.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/output_folder.h"
#include "adapters/missions/log/logged_run.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/interrupt.h"
#include "adapters/program/cli/progress.h"
#include "adapters/program/cli/written_file.h"
#include "adapters/views/report/comparison_page.h"
#include "adapters/views/report/divergence.h"
#include "adapters/views/report/figure_source.h"

namespace prospect {
namespace {

struct ReportArguments {
  std::vector<std::string> runs;     ///< folder, or the log of a mission; two are compared
  std::vector<std::string> figures;  ///< "path", "map"
  std::vector<std::string> formats = {"png", "svg"};
  std::string color;  ///< of the path; empty: plain
  std::string out;    ///< folder; empty: that of the run
};

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

void write(OutputFolder& folder, const std::string& name, const std::string& content) {
  const std::string file = (std::filesystem::path(folder.path()) / name).string();
  write_file(folder, name, content, file);
  std::printf("%s\n", file.c_str());
}

/// A folder for figures and pages: that of what they show, or another one, of their own or a run's.
OutputFolder folder_for(const std::string& out, const std::string& source) {
  return out.empty() ? OutputFolder::beside(source)
                     : OutputFolder::shared(out, {"report", "run", "drive"});
}

bool is_log(const std::string& run) { return std::filesystem::path(run).extension() == ".mcap"; }

/// The page of a mission's log, beside it: RUN.mcap gives RUN.html.
int report_log(const ReportArguments& arguments, const Registries& registries,
               SignalGuard& signals) {
  const std::string& log = arguments.runs.front();
  const std::filesystem::path path = log;
  if (!arguments.figures.empty() || !arguments.color.empty()) {
    throw InputError("--figure and --colour are of a run's folder; " + log +
                     " is a log, expected it alone");
  }
  Progress progress;
  progress.show("reading " + log);
  const LoggedRun run = read_logged_run(log, registries);
  progress.show("drawing the page of " + log);
  const std::string page = render_report(run.record);
  progress.finish();
  signals.note();  // what is written now is written whole
  OutputFolder out = folder_for(arguments.out, path.parent_path().string());
  write(out, path.stem().string() + ".html", page);
  for (const std::string& note : run.notes) std::printf("%s\n", note.c_str());
  return kDone;
}

/// What a comparison needs of one of two runs.
struct RunToCompare {
  ComparedRun page;
  DrivenSteps steps;
};

RunToCompare run_to_compare(const std::string& run, const Registries& registries) {
  namespace fs = std::filesystem;
  if (is_log(run)) {
    const LoggedRun logged = read_logged_run(run, registries);
    return {{"", report_run(logged.record)}, driven_steps(logged.record.steps)};
  }
  if (!fs::is_directory(run)) {
    throw InputError(run + ": no run; expected the folder of one, or a mission's log (.mcap)");
  }
  const std::string page = (fs::path(run) / "report.html").string();
  if (!fs::is_regular_file(page)) {
    throw InputError(page + ": no such file; expected a mission that came to its end");
  }
  return {{"", run_of_report(read_whole_file(page), page)},
          driven_steps(StepTable::read((fs::path(run) / "steps.csv").string()))};
}

/// The last part of a path, or all of it where the other ends alike.
std::string short_name(const std::string& run, const std::string& other) {
  const auto last = [](const std::string& path) {
    const std::filesystem::path p = std::filesystem::path(path).lexically_normal();
    return (p.has_filename() ? p : p.parent_path()).filename().string();
  };
  return last(run) == last(other) ? run : last(run);
}

/// Two missions under one slider: a page in the folder of the first.
int report_two(const ReportArguments& arguments, const Registries& registries,
               SignalGuard& signals) {
  if (!arguments.figures.empty() || !arguments.color.empty()) {
    throw InputError("--figure and --colour are of one run; expected two runs alone");
  }
  const std::string &a = arguments.runs[0], &b = arguments.runs[1];
  Progress progress;
  progress.show("reading " + a);
  RunToCompare first = run_to_compare(a, registries);
  progress.show("reading " + b);
  RunToCompare second = run_to_compare(b, registries);
  progress.finish();
  first.page.name = short_name(a, b);
  second.page.name = short_name(b, a);
  const Divergence divergence = first_divergence(first.steps, second.steps);
  const std::string page = comparison_page(first.page, second.page, divergence);
  signals.note();
  OutputFolder out =
      folder_for(arguments.out, is_log(a) ? std::filesystem::path(a).parent_path().string() : a);
  std::string name = second.page.name;
  std::replace(name.begin(), name.end(), '/', '_');
  write(out, "compared_with_" + name + ".html", page);
  std::printf("%s, %s: %s\n", first.page.name.c_str(), second.page.name.c_str(),
              divergence_text(divergence).c_str());
  return kDone;
}

std::vector<std::string> path_colors() { return {"plain", "features", "error", "speed", "mode"}; }

int report(const ReportArguments& arguments, const Registries& registries, SignalGuard& signals) {
  namespace fs = std::filesystem;
  if (arguments.runs.size() == 2) return report_two(arguments, registries, signals);
  const std::string& run = arguments.runs.front();
  if (is_log(run)) return report_log(arguments, registries, signals);
  if (arguments.figures.empty()) {
    throw InputError("report: no figure named; expected --figure path, map or path,map (" +
                     (fs::path(run) / "report.html").string() +
                     " is the page to open in a browser)");
  }
  const bool path = has(arguments.figures, "path"), map = has(arguments.figures, "map");
  if (!path && !arguments.color.empty()) {
    throw InputError("--colour is of the path; expected --figure path with it");
  }
  const std::string color = arguments.color.empty() ? "plain" : arguments.color;
  const std::vector<std::string> colors = path_colors();
  const auto by =
      static_cast<PathColor>(std::find(colors.begin(), colors.end(), color) - colors.begin());
  Progress progress;
  progress.show("reading " + run);
  const FigureSource source =
      read_figure_source(run, path ? std::optional(by) : std::nullopt, map, registries);

  // All of them before the first is written.
  std::vector<std::pair<std::string, std::string>> files;
  const auto add = [&](const std::string& name, const Drawing& drawing) {
    for (const std::string& format : drawing_formats()) {
      if (has(arguments.formats, format)) {
        files.emplace_back(name + '.' + format, written(drawing, format));
      }
    }
  };
  if (path) add("path", path_figure(source.map ? &*source.map : nullptr, *source.path));
  if (map) add("map", map_figure(*source.map));
  progress.finish();

  signals.note();
  OutputFolder out = folder_for(arguments.out, run);
  for (const auto& [name, content] : files) write(out, name, content);
  if (path && !source.map) {
    std::printf("without the map: the run did not come to its end, so there is no map.bt\n");
  }
  return kDone;
}

}  // namespace

Command report_command(CLI::App& program) {
  const auto given = std::make_shared<ReportArguments>();
  ReportArguments& arguments = *given;
  CLI::App* command = program.add_subcommand(
      "report",
      "Two missions side by side; figures of a run for print; the page of a mission's log");
  command
      ->add_option("run", arguments.runs,
                   "Folder of a run, or the log of a mission (.mcap); of two, a page that compares")
      ->type_name("FILE")
      ->expected(1, 2)
      ->required();
  one_of(command->add_option(
             "--figure", arguments.figures,
             "path: the path over the map; map: the map at the end; separated by commas"),
         {"path", "map"})
      ->delimiter(',')
      ->allow_extra_args(false);
  add_figure_formats(command, arguments.formats);
  one_of(command->add_option("--colour", arguments.color, "What the path's colour says [plain]"),
         path_colors());
  command->add_option("--out", arguments.out, "Folder to write to [that of the run or log]")
      ->type_name("DIR");
  return {command,
          [given](const Invocation& in) { return report(*given, in.registries, in.signals); }};
}

}  // namespace prospect
