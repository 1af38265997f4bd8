// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "adapters/missions/log/mission_messages.h"
#include "adapters/views/live/live_feed.h"
#include "adapters/views/live/viewer.h"
#include "runtime/drive_commands.h"

namespace prospect {

/// A mission for programs that speak Foxglove's protocol: the topics of the log (docs/reference/
/// log.md), the commands as services, and go by publishing a pose. Who comes late gets the newest
/// message of each topic at once. For a viewer at most kWaiting messages of a topic wait, of maps
/// and pictures one; then the oldest of that topic is dropped, and counted. Each map is the whole
/// map, so a dropped one leaves no gap.
///
/// Thread-safety: one thread.
class FoxgloveShow {
 public:
  static constexpr std::size_t kWaiting = 20;

  /// options: as of the mission's log, if it has one. `commands` outlive it. Throws InputError if
  /// the codecs of its pictures cannot be loaded.
  FoxgloveShow(const MissionMessageOptions& options, DriveCommands& commands);
  ~FoxgloveShow();

  void add(const LiveFeed::News& news);
  /// One who may command or only watches. It must not outlive this.
  std::unique_ptr<Viewer> viewer(bool may_command);

 private:
  friend class FoxgloveViewer;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
