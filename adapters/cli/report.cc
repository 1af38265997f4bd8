#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "adapters/cli/commands.h"
#include "adapters/files/input_error.h"
#include "adapters/files/whole_file.h"
#include "adapters/report/figure_source.h"

namespace prospect {
namespace {

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

std::vector<std::string> path_colors() { return {"plain", "features", "error", "speed", "mode"}; }

int report(const ReportArguments& arguments, const SolverRegistry& registry) {
  namespace fs = std::filesystem;
  if (arguments.figures.empty()) {
    throw InputError("report: no figure named; expected --figure path, map or path,map (" +
                     (fs::path(arguments.run) / "report.html").string() +
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
  const FigureSource source =
      read_figure_source(arguments.run, path ? std::optional(by) : std::nullopt, map, registry);

  // All of them before the first is written.
  std::vector<std::pair<std::string, std::string>> files;
  const auto add = [&](const std::string& name, const Drawing& drawing) {
    if (has(arguments.formats, "png")) files.emplace_back(name + ".png", drawing.png());
    if (has(arguments.formats, "svg")) files.emplace_back(name + ".svg", drawing.svg());
  };
  if (path) add("path", path_figure(source.map ? &*source.map : nullptr, *source.path));
  if (map) add("map", map_figure(*source.map));

  const fs::path out = arguments.out.empty() ? arguments.run : arguments.out;
  std::error_code error;
  fs::create_directories(out, error);
  if (!fs::is_directory(out, error)) {
    throw InputError(out.string() + ": cannot be created; expected a folder to write to");
  }
  for (const auto& [name, content] : files) {
    const std::string file = (out / name).string();
    const std::string wrong = write_whole_file(file, content);
    if (!wrong.empty()) {
      throw InputError(file + ": cannot be written (" + wrong + "); expected a writable folder");
    }
    std::printf("%s\n", file.c_str());
  }
  if (path && !source.map) {
    std::printf("without the map: the run did not come to its end, so there is no map.bt\n");
  }
  return kDone;
}

}  // namespace prospect
