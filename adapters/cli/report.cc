#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "adapters/cli/commands.h"
#include "adapters/config/input_error.h"
#include "adapters/report/figure_source.h"
#include "adapters/run/whole_file.h"
#include "models/nearest_name.h"

namespace prospect {
namespace {

/// Throws InputError if a word is not among those known.
void check_words(const std::string& option, const std::vector<std::string>& words,
                 const std::vector<std::string>& known) {
  for (const std::string& word : words) {
    if (std::find(known.begin(), known.end(), word) != known.end()) continue;
    std::string list;
    for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
    throw InputError(option + ": unknown '" + word + "'" + did_you_mean(word, known) +
                     "; expected one of: " + list);
  }
}

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

int report(const ReportArguments& arguments, const Registries& registries) {
  namespace fs = std::filesystem;
  static const std::vector<std::string> kColors = {"plain", "features", "error", "speed", "mode"};
  if (arguments.figures.empty()) {
    throw InputError("report: no figure named; expected --figure path, map or path,map (" +
                     (fs::path(arguments.run) / "report.html").string() +
                     " is the page to open in a browser)");
  }
  check_words("--figure", arguments.figures, {"path", "map"});
  check_words("--format", arguments.formats, {"png", "svg"});
  if (!arguments.color.empty()) check_words("--colour", {arguments.color}, kColors);
  const bool path = has(arguments.figures, "path"), map = has(arguments.figures, "map");
  if (!path && !arguments.color.empty()) {
    throw InputError("--colour is of the path; expected --figure path with it");
  }
  const std::string color = arguments.color.empty() ? "plain" : arguments.color;
  const auto by =
      static_cast<PathColor>(std::find(kColors.begin(), kColors.end(), color) - kColors.begin());
  const FigureSource source =
      read_figure_source(arguments.run, path ? std::optional(by) : std::nullopt, map, registries);

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
