// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/configuration_reference.h"

#include <algorithm>
#include <string>
#include <vector>

#include "adapters/missions/config/configuration.h"
#include "engine/maps/clearance_field.h"
#include "engine/planner/planner_fit.h"
#include "models/make_model.h"

namespace prospect {
namespace {

std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? "\\|" : std::string(1, c);
  return out;
}

std::string code(const std::string& text) { return text.empty() ? "" : '`' + cell(text) + '`'; }

/// "" if no entry is below the path.
std::string table(const std::vector<ConfigEntry>& entries, const std::string& below) {
  std::string rows;
  for (const ConfigEntry& e : entries) {
    if (!e.path.starts_with(below)) continue;
    rows += "| " + code(e.path) + " | " + cell(e.unit == "1" ? "" : e.unit) + " | " +
            cell(e.range) + " | " + (e.default_value.empty() ? "required" : code(e.default_value)) +
            " | " + cell(e.description) + " |\n";
  }
  if (rows.empty()) return "";
  return "| Key | Unit | Range | Default | What it is |\n|---|---|---|---|---|\n" + rows + '\n';
}

std::vector<ConfigEntry> entries_of(const std::string& text) {
  return configuration_from_text(text, "reference").entries;
}

/// Those whose default is not that of the same place in `others`.
std::vector<ConfigEntry> different(std::vector<ConfigEntry> entries,
                                   const std::vector<ConfigEntry>& others) {
  std::size_t place = 0;
  std::erase_if(entries, [&](const ConfigEntry& e) {
    return e.default_value == others.at(place++).default_value;
  });
  return entries;
}

}  // namespace

std::string configuration_reference() {
  const std::vector<ConfigEntry> entries = entries_of("");
  std::string page =
      "# Configuration\n\n"
      "Every key of a configuration file (YAML). `prospect explore`, `solve` and `bench` read one "
      "with `--config FILE`, and each key can be set on the command line, above the file, as often "
      "as wanted: `--set planner.weights.w_l=0 --set robot.shape.type=box`. Options with a name of "
      "their own, such as `--time-limit`, are spellings of keys, which their help names. Of a key "
      "the last `--set` counts, else such an option, else the file, else the default, which "
      "`--set KEY=~` asks for. `prospect config FILE` prints the configuration that is in "
      "effect.\n\n"
      "A key stands in the mapping that its path names: `planner.weights.w_l` is `w_l` in "
      "`weights` "
      "in `planner`. What a file does not hold keeps its default. Both ends of a range belong to "
      "it. No unit: a pure number, a switch or a text. An unknown key, or a value out of its "
      "range, "
      "is an error that names the key, its line and what was expected (exit code 2). So is a key "
      "that nothing reads in the mission at hand, and says who does; in a file, which may describe "
      "a "
      "robot for all its missions, `drive`, `gazebo`, `simulator` and `world` may be another's.\n\n"
      "Values that share arithmetic are judged together before the first step, with the numbers "
      "and what would fit (exit code 2); a planner of one's own asks the same:\n\n"
      "| Of | must hold |\n|---|---|\n"
      "| `robot.depth.max_range`, `perception.mapping.resolution` | 1 to " +
      std::to_string(kMostRangeVoxels) +
      " voxels |\n"
      "| `perception.mapping.z_min`, `z_max`, `perception.mapping.resolution` | at most " +
      std::to_string(kMostLayers) +
      " layers of voxels; the body is between them |\n"
      "| `robot.shape`, `planner.d_des`, `planner.drift_margin`, `perception.mapping.resolution` | "
      "radius + d_des + drift_margin + 0.2 m: at most " +
      std::to_string(ClearanceField::kMostVoxels) + " voxels; of a multirotor " +
      std::to_string(ClearanceField::kMostVoxelsInSpace) +
      " |\n"
      "| `planner.frontiers.window_radius`, `perception.mapping.resolution` | at most " +
      std::to_string(kMostWindow) +
      " voxels |\n"
      "| `robot.motion`, `planner.N`, `planner.dt` | the robot gets faster than 1 mm/s within the "
      "horizon |\n"
      "| `planner.M`, `robot.model` | knots times inputs: at most " +
      std::to_string(kMostVariables) +
      " variables |\n"
      "| `planner.N`, `planner.max_landmarks`, `planner.deadline` | N times max_landmarks: at "
      "most " +
      std::to_string(static_cast<int>(kMostViews)) + ", with a deadline also " +
      std::to_string(static_cast<int>(kMostViewsPerSecond)) + " for each second, or " +
      std::to_string(static_cast<int>(kLeastViews)) +
      " |\n\n"
      "How far the robot can get, `v_max` N dt and its braking distance, needs no limit: memory "
      "follows what is known of the world.\n\n"
      "This page is made by `prospect config --reference > docs/reference/configuration.md` from "
      "the descriptions by which the program reads and checks; do not edit it.\n\n";
  std::vector<std::string> groups;
  for (const ConfigEntry& e : entries) {
    const std::string group = e.path.substr(0, e.path.find('.'));
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
  }
  for (const std::string& group : groups) {
    page += "## " + group + "\n\n" + table(entries, group + '.');
    if (group == "robot") {
      for (const std::string& model : model_names()) {
        if (model == model_names().front()) continue;
        page += "With `robot.model: " + model + "`:\n\n" +
                table(entries_of("robot: {model: " + model + "}"), "robot.motion.");
      }
      for (const auto& [type, shape] :
           {std::pair<std::string, std::string>{"box", ""},
            {"spheres", ", spheres: [{center: [0, 0, 0.3], radius: 0.2}]"},
            {"convex", ", vertices: [0.2, 0, 0.1, -0.2, 0.1, 0.1, -0.2, -0.1, 0.1, 0, 0, 0.5]"}}) {
        std::vector<ConfigEntry> of_shape =
            entries_of("robot: {shape: {type: " + type + shape + "}}");
        std::erase_if(of_shape, [](const ConfigEntry& e) { return e.path == "robot.shape.type"; });
        page += "With `robot.shape.type: " + type + "`:\n\n" + table(of_shape, "robot.shape.");
      }
      page += "Depth sensors besides `robot.depth`, of each in the list `robot.more_depth`:\n\n" +
              table(entries_of("robot: {more_depth: [{}]}"), "robot.more_depth");
    } else if (group == "perception") {
      page +=
          "Of the simulator's robot, other defaults, of wheels those that `simulator.wheels` "
          "has, of the calibration what is drawn (`simulator.camera.effects`):\n\n" +
          table(different(entries_of("simulator: {sensors: camera}"), entries), "perception.");
    } else if (group == "zones") {
      std::vector<ConfigEntry> lists = entries_of(
          "zones: {keep_out: [{area: [5, 5, 6, 5, 6, 6]}],"
          " slow: [{area: [5, 5, 6, 5, 6, 6], max_speed: 0.2}]}");
      std::erase_if(lists, [](const ConfigEntry& e) { return e.path == "zones.bound"; });
      page += "Of each zone in the lists `keep_out` and `slow`:\n\n" + table(lists, "zones.");
    }
  }
  page +=
      "The keys of `planner.options` are those of the back end, which `prospect list solvers` "
      "tells; `planner.options.max_evaluations` stands above `planner.polish_evaluations`, and "
      "`planner.options.threads` above `planner.threads`.\n";
  return page;
}

}  // namespace prospect
