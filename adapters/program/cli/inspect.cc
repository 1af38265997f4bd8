// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "adapters/formats/datasets/depth_source.h"
#include "adapters/formats/datasets/stereo_source.h"
#include "adapters/missions/recordings/inspection.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/progress.h"

namespace prospect {
namespace {

struct InspectArguments {
  std::string path;
  StereoDatasetOptions stereo;
  DepthDatasetOptions depth;
  bool json = false;
};

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
  command->add_flag("--json", arguments.json, "Print JSON");
  return {command, [given](const Invocation&) { return inspect(*given); }};
}

}  // namespace prospect
