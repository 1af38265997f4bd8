// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "adapters/formats/datasets/stereo_source.h"
#include "engine/problem/stop_condition.h"

// Options, and what their values may be, that several commands share.
namespace prospect {

/// The option takes one of these, or a list of them; its type says so: "model|camera".
CLI::Option* one_of(CLI::Option* option, const std::vector<std::string>& choices);
/// A finite number in [min, max]: CLI::Range lets nan through.
CLI::Validator number_within(double min, double max);
/// A whole number in [min, max]: CLI11 wraps a negative one around.
CLI::Validator whole_number_within(std::uint64_t min, std::uint64_t max);
/// By which clock deadlines strike and times are told: --clock wall|cpu.
void add_clock(CLI::App* command, SolveClock& clock);
/// --plugin FILE.
void add_plugins(CLI::App* command, std::vector<std::string>& plugins);
/// --format: in which forms figures are written.
CLI::Option* add_figure_formats(CLI::App* command, std::vector<std::string>& formats);
/// Topics of a bag as USE=TOPIC, separated by commas.
void add_topics(CLI::App* command, std::map<std::string, std::string>& topics,
                const std::vector<std::string>& uses);
/// What a recording of a stereo pair does not say by itself.
void add_recording_options(CLI::App* command, StereoDatasetOptions& options);
/// The frame of a bag in which poses are wanted.
void add_fixed_frame(CLI::App* command, std::string& frame);

/// What the arguments of a node of ROS 2 say: --ros-args, -r and -p.
struct RosArgumentWords {
  bool marked = false;  ///< --ros-args was said, which changes nothing
  std::vector<std::string> remap, parameters;
};
void add_ros_arguments(CLI::App* command, RosArgumentWords& words);

}  // namespace prospect
