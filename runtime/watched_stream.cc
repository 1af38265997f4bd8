// SPDX-License-Identifier: Apache-2.0
#include "runtime/watched_stream.h"

namespace prospect {

WatchedStream watched(const SensorInbox& inbox, SensorStream stream, const std::string& source,
                      double limit) {
  return {source, limit, [&inbox, stream](const Belief*) { return inbox.count(stream).newest; },
          [&inbox, stream] { return inbox.count(stream); }};
}

WatchedStream watched_sensor(const SensorInbox& inbox, int sensor, double limit) {
  return {sensor_name(sensor), limit,
          [&inbox, sensor](const Belief*) { return inbox.count_of_sensor(sensor).newest; },
          [&inbox, sensor] { return inbox.count_of_sensor(sensor); }};
}

}  // namespace prospect
