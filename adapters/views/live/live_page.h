// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/missions/run/run_record.h"
#include "adapters/views/live/live_feed.h"

namespace prospect {

// The page of the live view and what is sent to it: text in JSON, an object with "op" each.

/// Name of its WebSocket protocol.
inline constexpr std::string_view kPageProtocol = "prospect.live.v1";

/// The report's page for a mission that goes on: live.js opens a WebSocket to where it came from.
/// start: configured_record(), with world, solver and seed in its summary.
std::string live_page(const RunRecord& start);

/// {"op":"steps"}: further ones; resolution [m] of the ground cells.
std::string steps_message(const std::vector<std::shared_ptr<const StepRecord>>& steps,
                          double resolution);
std::string pose_message(const LivePose& pose);
std::string picture_message(const CameraPicture& picture);
std::string end_message(const Summary& summary);

/// What the robot's viewers are told of each other.
struct ViewerCounts {
  std::size_t viewers = 0;
  std::uint64_t dropped = 0;  ///< messages that viewers were too slow for, of all so far
};
struct LiveStatus {
  const LiveDriver* driver = nullptr;  ///< null: in lockstep, or nothing is known yet
  std::vector<Event> events;           ///< the newest
  ViewerCounts counts;
  std::uint64_t missed = 0;   ///< steps and events that no viewer can get any more
  bool told_to_drive = true;  ///< DriveRequests, as the next two
  bool stopped = false;
  std::string told;
  std::optional<double> began;  ///< [s] of the clock of events, at which the mission's was 0
};
std::string status_message(const LiveStatus& status);
/// What a viewer is told first.
struct Welcome {
  bool may_command = false;
  bool real_time = false;
};
std::string welcome_message(const Welcome& welcome);

}  // namespace prospect
