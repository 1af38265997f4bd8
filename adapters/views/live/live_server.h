// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "adapters/missions/log/mission_messages.h"
#include "adapters/missions/run/run_record.h"
#include "adapters/views/live/live_feed.h"
#include "adapters/views/live/live_options.h"
#include "runtime/drive_requests.h"

namespace prospect {

/// What is known of a mission before its first step.
struct LiveMission {
  /// configured_record(), with world, solver and seed in its summary.
  RunRecord start;
  bool real_time = true;  ///< else in lockstep
  MissionMessageOptions messages;
};

/// Serves the live view of a mission, docs/reference/live.md, by a thread of its own: the page by
/// HTTP, what it shows by a WebSocket, and by another for programs that speak Foxglove's protocol.
/// The thread looks into the feed 20 times a second; no thread of the robot is ever made to wait
/// for it or for a viewer.
///
/// Who may what. Watching needs nothing, unless another page's script asks; commanding needs the
/// token. A request that names this server by a foreign name is refused (access.h).
///
/// Thread-safety: one thread makes and ends it. Errors: the constructor throws InputError, one
/// line, for a port, host or token that cannot be used or codecs of pictures that cannot be loaded,
/// and NotBuiltIn without Boost. After that nothing throws.
class LiveServer {
 public:
  /// feed and requests outlive it.
  LiveServer(const LiveOptions& options, const LiveMission& mission, LiveFeed& feed,
             DriveRequests& requests);
  /// Shows what is left in the feed, for half a second at most, and ends.
  ~LiveServer();

  int port() const;
  /// Where to open the page: with the token, which whoever has it may command by.
  std::string url() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
