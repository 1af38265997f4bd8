#include "adapters/views/live/live_commands.h"

#include "models/types.h"

namespace prospect {
namespace {

constexpr const char* kStopped = "it is stopped; expected acknowledge before";

}  // namespace

std::vector<std::string> LiveCommands::names() { return {"stop", "acknowledge", "hold", "resume"}; }

std::string LiveCommands::give(const std::string& name) {
  if (name == "stop") {
    requests_.hold();
    requests_.emergency_stop();
  } else if (name == "acknowledge") {
    requests_.acknowledge();
  } else if (name == "hold") {
    requests_.hold();
  } else if (name == "resume") {
    if (requests_.stopped()) return kStopped;
    requests_.resume();
  } else {
    return "unknown; expected stop, acknowledge, hold, resume or go";
  }
  return "";
}

std::string LiveCommands::go(const Eigen::Vector2d& place) {
  if (!place.allFinite() || !(place.cwiseAbs().maxCoeff() < kFarthest)) {
    return "no place; expected one within 1000 km";
  }
  if (requests_.stopped()) return kStopped;
  requests_.go_to(place);
  return "";
}

}  // namespace prospect
