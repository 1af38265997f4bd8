// SPDX-License-Identifier: Apache-2.0
#include "runtime/drive_commands.h"

#include <cmath>

#include "models/types.h"

namespace prospect {
namespace {

constexpr const char* kAcknowledgeFirst = "it is stopped; expected acknowledge before";

}  // namespace

std::vector<std::string> DriveCommands::names() {
  return {"stop", "acknowledge", "hold", "resume", "cancel"};
}

std::string DriveCommands::give(const std::string& name) {
  if (name == "stop") {
    requests_.hold();
    requests_.emergency_stop();
  } else if (name == "acknowledge") {
    requests_.acknowledge();
  } else if (name == "hold") {
    requests_.hold();
  } else if (name == "resume") {
    if (requests_.stopped()) return kAcknowledgeFirst;
    requests_.resume();
  } else if (name == "cancel") {
    if (!requests_.cancel()) return "it is not on its way to a place; nothing is done";
  } else {
    return "unknown; expected stop, acknowledge, hold, resume, cancel or go";
  }
  return "";
}

std::string DriveCommands::go(const Eigen::Vector2d& place, std::optional<double> yaw,
                              int* number) {
  if (!place.allFinite() || !std::isfinite(yaw.value_or(0.0)) ||
      !(place.cwiseAbs().maxCoeff() < kFarthest)) {
    return "no place; expected one within 1000 km";
  }
  if (requests_.stopped()) return kAcknowledgeFirst;
  const int its = requests_.go_to(place, yaw);
  if (number) *number = its;
  return "";
}

}  // namespace prospect
