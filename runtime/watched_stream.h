// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "engine/maps/belief.h"
#include "runtime/sensor_inbox.h"

namespace prospect {

/// A stream that a robot needs: what pre-flight waits for, and health reports tell of.
struct WatchedStream {
  std::string source;
  double limit = 0.0;  ///< [s] age
  /// Capture of its newest measurement [s]; none so far. `newest` may be null.
  std::function<std::optional<double>(const Belief* newest)> stamp;
  /// What became of its frames, and its clock; empty: nobody counts, and it is stamped by the
  /// runtime's clock.
  std::function<StreamCount()> count{};
};

/// A stream of an inbox, which outlives it. Thread-safety: as the inbox.
WatchedStream watched(const SensorInbox& inbox, SensorStream stream, const std::string& source,
                      double limit);
/// Likewise what a depth sensor from 1 on delivers.
WatchedStream watched_sensor(const SensorInbox& inbox, int sensor, double limit);

}  // namespace prospect
