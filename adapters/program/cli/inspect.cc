// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "adapters/formats/datasets/depth_source.h"
#include "adapters/formats/datasets/stereo_source.h"
#include "adapters/formats/files/extension.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/output_folder.h"
#include "adapters/missions/recordings/inspection.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/configuration_arguments.h"
#include "adapters/program/cli/interrupt.h"
#include "adapters/program/cli/progress.h"
#include "adapters/program/cli/told_world.h"
#include "adapters/program/cli/written_file.h"
#include "adapters/views/report/run_figure.h"
#include "models/formatted.h"

namespace prospect {
namespace {

struct InspectArguments {
  std::string path;
  StereoDatasetOptions stereo;
  DepthDatasetOptions depth;
  bool json = false;
  std::string picture;                   ///< file, of a world; empty: none
  ConfigurationArguments configuration;  ///< how a world is read
};

/// What a body meets in each column of a world.
Grid<CellState> columns_of(const World& world, const BodySlice& slice) {
  const VoxelGrid& voxels = world.voxels;
  const double r = voxels.resolution();
  const Grid<std::uint8_t> free = free_columns(voxels, slice);
  const int low = std::max(voxels.k0(), static_cast<int>(std::floor(slice.z_min / r)));
  const int top =
      std::min(voxels.k0() + voxels.depth(), static_cast<int>(std::ceil(slice.z_max / r)));
  Grid<CellState> ground(voxels.frame(), CellState::kUnknown);
  for (int n = 0; n < voxels.frame().size(); ++n) {
    const Cell c = voxels.frame().at(n);
    if (free[c] != 0) {
      ground[c] = CellState::kFree;
      continue;
    }
    for (int k = low; k < top; ++k) {
      if (voxels.state(c.i, c.j, k) == CellState::kOccupied) ground[c] = CellState::kOccupied;
    }
  }
  return ground;
}

/// How a world is read, as a picture and in words.
int picture_world(const InspectArguments& arguments, const Registries& registries,
                  SignalGuard& signals) {
  const std::filesystem::path file = arguments.picture;
  const std::string ending = lower_case_extension(arguments.picture);
  const std::vector<std::string>& formats = drawing_formats();
  if (ending.empty() ||
      std::find(formats.begin(), formats.end(), ending.substr(1)) == formats.end()) {
    throw InputError("--picture: '" + arguments.picture +
                     "'; expected a file that ends in .png, .svg, .pdf or .pgf");
  }
  const Configuration configuration =
      read_told(arguments.configuration, registries, ConfigurationUse::kExplore);
  Progress progress;
  progress.show("reading " + arguments.path);
  const std::shared_ptr<const World> world =
      mission_world(arguments.path, configuration, ConfigurationUse::kExplore);
  const ReachableArea reachable = told_area(reachable_area(*world, configuration), configuration);
  std::vector<std::string> facts = {
      size_text(*world) + formatted(", cells of %.4g m", world->voxels.resolution()),
      "scale: " + (world->assumed.empty() ? "as stated" : "assumed, " + world->assumed),
      formatted("start: (%.2f, %.2f) m, %.0f degrees", world->start.position.x(),
                world->start.position.y(), world->start.yaw * 180.0 / M_PI),
      formatted("%.1f m2 can be seen from where the robot gets to", reachable.area)};
  if (!world->left_out.empty()) facts.push_back("read without: " + world->left_out.text());
  const Drawing drawing = world_figure(columns_of(*world, world_options_for(configuration).slice),
                                       reachable.cells, world->start, facts);
  const std::string content = written(drawing, ending.substr(1));
  progress.finish();
  signals.note();
  const std::string folder = file.has_parent_path() ? file.parent_path().string() : ".";
  OutputFolder out = OutputFolder::beside(folder);
  write_file(out, file.filename().string(), content, file);
  for (const std::string& fact : facts) std::printf("%s\n", fact.c_str());
  std::printf("%s\n", arguments.picture.c_str());
  return kDone;
}

int inspect(const InspectArguments& arguments) {
  Found found = Found::kUnknown;
  DepthDatasetOptions depth = arguments.depth;
  depth.topics = arguments.stereo.topics;
  Progress progress;
  progress.show("reading " + arguments.path);
  const auto json = inspect_path(arguments.path, arguments.stereo, depth, found);
  progress.finish();
  std::cout << (arguments.json ? json.dump(2) + "\n" : inspection_text(json));
  return found == Found::kUsable ? kDone : found == Found::kIncomplete ? kFailed : kBadInput;
}

}  // namespace

Command inspect_command(CLI::App& program) {
  const auto given = std::make_shared<InspectArguments>();
  InspectArguments& arguments = *given;
  CLI::App* command = program.add_subcommand(
      "inspect", "What a recording holds, and what is missing to use it; names maps and worlds");
  command->add_option("path", arguments.path, "Folder or file")->type_name("FILE")->required();
  add_recording_options(command, arguments.stereo);
  add_topics(command, arguments.stereo.topics,
             {"left", "right", "left_info", "right_info", "truth", "imu", "depth", "depth_info",
              "depth_1", "depth_2", "depth_3", "scan", "pose"});
  add_fixed_frame(command, arguments.depth.fixed_frame);
  CLI::Option* json = command->add_flag("--json", arguments.json, "Print JSON");
  CLI::Option* picture = command->add_option(
      "--picture", arguments.picture,
      "Draw how a world is read: .png, .svg, .pdf or .pgf; with its size, scale and start");
  picture->type_name("FILE")->excludes(json);
  add_configuration(command, arguments.configuration);
  add_world_keys(command, arguments.configuration);
  return {command, [given](const Invocation& in) {
            return given->picture.empty() ? inspect(*given)
                                          : picture_world(*given, in.registries, in.signals);
          }};
}

}  // namespace prospect
