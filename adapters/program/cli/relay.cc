// SPDX-License-Identifier: Apache-2.0
#include <initializer_list>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/files/parse_number.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/configuration_arguments.h"
#include "adapters/program/cli/interrupt.h"
#include "adapters/robots/dds/dds_relay.h"
#include "models/range_text.h"
#include "runtime/driver.h"
#include "runtime/realtime_priority.h"

namespace prospect {
namespace {

struct RelayArguments {
  std::string ros;                       ///< file of topics
  RosArgumentWords ros_arguments;        ///< above it
  ConfigurationArguments configuration;  ///< the robot's motion
};

/// What the file of topics leaves out is that of the robot's motion. Throws InputError for keys
/// that say nothing of that.
void complete_limits(BaseLimits& limits, const Configuration& configuration) {
  KeyReader reader{.use = ConfigurationUse::kRelay};
  const auto told = [&](bool by_topics, std::initializer_list<const char*> keys) {
    if (!by_topics) return;
    for (const char* key : keys)
      reader.told_elsewhere.push_back(std::string("robot.motion.") + key);
  };
  told(limits.speed.has_value(), {"v_min", "v_max", "vx_min", "vx_max", "vy_max", "vz_max"});
  told(limits.yaw_rate.has_value(), {"omega_max"});
  told(limits.acceleration.has_value(), {"a_max"});
  told(limits.yaw_acceleration.has_value(), {"alpha_max"});
  refuse_unread(configuration.entries, reader);
  const auto of_motion = [&](const char* key) -> std::optional<double> {
    double value = 0.0;
    for (const ConfigEntry& entry : configuration.entries) {
      if (entry.path == std::string("robot.motion.") + key && parse_number(entry.value, value)) {
        return value;
      }
    }
    return std::nullopt;
  };
  if (!limits.speed) limits.speed = configuration.robot.model->max_speed();
  if (!limits.yaw_rate) limits.yaw_rate = configuration.robot.model->max_yaw_rate();
  if (!limits.acceleration) limits.acceleration = of_motion("a_max");
  if (!limits.yaw_acceleration) limits.yaw_acceleration = of_motion("alpha_max");
}

int relay(const RelayArguments& arguments, const Registries& registries, SignalGuard& signals) {
  DdsOptions options = read_dds_options(
      arguments.ros,
      ros_arguments(arguments.ros_arguments.remap, arguments.ros_arguments.parameters));
  BaseLimits& limits = options.command.limits;
  complete_limits(limits, read_told(arguments.configuration, registries, ConfigurationUse::kRelay));
  signals.note();  // the motors are told to stop
  // Before it starts threads, which pass commands on.
  const RealtimePriority first(DriverOptions().priority, RealtimePriority::Started::kLikewise);
  DdsRelay relay(options);
  std::cerr << "prospect relay: at most " << exact_text(*limits.speed) << " m/s, "
            << exact_text(*limits.yaw_rate) << " rad/s, " << exact_text(*limits.acceleration)
            << " m/s^2, " << exact_text(*limits.yaw_acceleration) << " rad/s^2; for "
            << exact_text(options.command.dead_man) << " s\n";
  if (!first.problem().empty()) std::cerr << "prospect relay: " << first.problem() << '\n';
  relay.run(signals.came(),
            [](const std::string& line) { std::cerr << "prospect relay: " << line << '\n'; });
  return kCancelled;
}

}  // namespace

Command relay_command(CLI::App& program) {
  const auto given = std::make_shared<RelayArguments>();
  RelayArguments& arguments = *given;
  CLI::App* command = program.add_subcommand(
      "relay", "The dead-man of a base behind topics of ROS 2, beside its motors");
  command->add_option("--ros", arguments.ros, "The robot's topics (YAML)")
      ->type_name("FILE")
      ->required();
  add_ros_arguments(command, arguments.ros_arguments);
  add_configuration(command, arguments.configuration,
                    ": the limits of the robot's motion that the topics' file leaves out");
  return {command,
          [given](const Invocation& in) { return relay(*given, in.registries, in.signals); }};
}

}  // namespace prospect
