// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/common_options.h"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "adapters/formats/files/input_error.h"
#include "adapters/views/report/drawing.h"
#include "models/nearest_name.h"

namespace prospect {

CLI::Option* one_of(CLI::Option* option, const std::vector<std::string>& choices) {
  std::string type;
  for (const std::string& choice : choices) type += (type.empty() ? "" : "|") + choice;
  return option->type_name(type)->check(CLI::Validator(
      [=](std::string& text) -> std::string {
        if (std::find(choices.begin(), choices.end(), text) != choices.end()) return "";
        return "unknown '" + text + "'" + did_you_mean(text, choices) + expected_one_of(choices);
      },
      ""));
}

CLI::Validator number_within(double min, double max) {
  std::ostringstream range;
  range << "a number from " << min << " to " << max;
  const std::string expected = range.str();
  return {[=](std::string& text) -> std::string {
            double value = 0.0;
            const char* last = text.data() + text.size();
            const auto [end, error] = std::from_chars(text.data(), last, value);
            const bool sound = error == std::errc() && end == last && value >= min && value <= max;
            return sound ? "" : "is '" + text + "'; expected " + expected;
          },
          ""};
}

CLI::Validator whole_number_within(std::uint64_t min, std::uint64_t max) {
  return {[=](std::string& text) -> std::string {
            std::uint64_t value = 0;
            const char* last = text.data() + text.size();
            const auto [end, error] = std::from_chars(text.data(), last, value);
            const bool sound = error == std::errc() && end == last && value >= min && value <= max;
            return sound ? ""
                         : "is '" + text + "'; expected a whole number from " +
                               std::to_string(min) + " to " + std::to_string(max);
          },
          ""};
}

void add_clock(CLI::App* command, SolveClock& clock) {
  one_of(command->add_option_function<std::string>(
             "--clock",
             [&clock](const std::string& word) {
               clock = word == "cpu" ? SolveClock::kProcessor : SolveClock::kWall;
             },
             "Of deadlines and times: the wall's, or processor time of all threads, the same "
             "beside other work [wall]"),
         {"wall", "cpu"});
}

void add_plugins(CLI::App* command, std::vector<std::string>& plugins) {
  command
      ->add_option("--plugin", plugins,
                   "Shared library with further back ends, terms or problems; may be given "
                   "several times")
      ->type_name("FILE")
      ->allow_extra_args(false);
}

CLI::Option* add_figure_formats(CLI::App* command, std::vector<std::string>& formats) {
  return one_of(command->add_option("--format", formats,
                                    "Of the figures, separated by commas; pgf: for LaTeX [" +
                                        CLI::detail::join(formats, ",") + "]"),
                drawing_formats())
      ->delimiter(',')
      ->allow_extra_args(false);
}

void add_topics(CLI::App* command, std::map<std::string, std::string>& topics,
                const std::vector<std::string>& uses) {
  std::string list;
  for (const std::string& use : uses) list += (list.empty() ? "" : ", ") + use;
  command
      ->add_option_function<std::vector<std::string>>(
          "--topics",
          [&topics, uses, list](const std::vector<std::string>& entries) {
            for (const std::string& entry : entries) {
              const auto equals = entry.find('=');
              const std::string use = entry.substr(0, equals);
              if (equals == std::string::npos || equals + 1 == entry.size() ||
                  std::find(uses.begin(), uses.end(), use) == uses.end()) {
                throw CLI::ValidationError(
                    "--topics", "is '" + entry + "'; expected USE=TOPIC, with USE of: " + list);
              }
              topics[use] = entry.substr(equals + 1);
            }
          },
          "Of a ROS 2 bag: " + list + " [found by type and name]")
      ->type_name("USE=TOPIC")
      ->delimiter(',')
      ->allow_extra_args(false);
}

void add_recording_options(CLI::App* command, StereoDatasetOptions& options) {
  command
      ->add_option("--calibration", options.calibration,
                   "File of the calibration: calib.txt, ROS camera_info (left.yaml,right.yaml), "
                   "OpenCV stereo or Kalibr camchain YAML; of depth images a camera_info [the "
                   "recording's own]")
      ->type_name("FILE");
  command->add_flag("--rectified", options.rectified,
                    "The images are rectified already, by that camera_info");
  command
      ->add_option("--sync", options.sync,
                   "How far stamps of a pair may differ [s] [a tenth of a period]")
      ->check(number_within(0.0, 10.0));
  command->add_option("--rate", options.rate, "Of images that are only numbered [Hz] [10]")
      ->check(number_within(0.01, 10000.0));
}

void add_fixed_frame(CLI::App* command, std::string& frame) {
  command
      ->add_option(
          "--fixed-frame", frame,
          "Of a bag's TF, in which the sensor moves [map, else a topic of poses, else odom "
          "or what is above the sensor]")
      ->type_name("FRAME");
}

void add_ros_arguments(CLI::App* command, RosArgumentWords& words) {
  command->add_flag("--ros-args", words.marked, "Arguments of ROS 2 follow: -r, -p");
  command
      ->add_option("-r,--remap", words.remap,
                   "With --ros: a topic by another name, FROM:=TO; __ns:=, __node:=")
      ->type_name("RULE")
      ->allow_extra_args(false);
  command->add_option("-p,--param", words.parameters, "With --ros: use_sim_time:=true or false")
      ->type_name("RULE")
      ->allow_extra_args(false);
}

}  // namespace prospect
