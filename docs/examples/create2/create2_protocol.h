// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "models/types.h"

namespace prospect {

// Source: iRobot Create 2 Open Interface (OI) specification.

inline constexpr double kCreate2WheelBase = 0.235;             ///< [m]
inline constexpr double kCreate2Count = M_PI * 0.072 / 508.8;  ///< [m] a count of an encoder
inline constexpr double kCreate2WheelSpeed = 0.5;              ///< [m/s] most of a wheel
inline constexpr double kCreate2StreamPeriod = 0.015;          ///< [s] from packet to packet

/// What the base says of itself, in one packet of its stream.
struct Create2Sensors {
  bool bump_right = false, bump_left = false;
  bool drop_right = false, drop_left = false;  ///< a wheel hangs
  bool cliff = false;                          ///< any of the four
  bool overcurrent_right = false, overcurrent_left = false;
  int charging_state = 0;        ///< 5: a charging fault
  bool charger = false;          ///< it touches a charger
  int mode = 0;                  ///< 0 off, 1 passive, 2 safe, 3 full; it drives in the last two
  int charge = 0, capacity = 0;  ///< of the battery [mAh]
  std::int16_t left_count = 0, right_count = 0;  ///< of the encoders; they wrap around

  bool operator==(const Create2Sensors&) const = default;
};

/// What is wrong, a sentence each.
std::vector<std::string> faults_of(const Create2Sensors& sensors);
/// Nothing is wrong that keeps it from its safe mode but the mode itself.
bool may_enter_safe_mode(const Create2Sensors& sensors);

/// Start, safe mode, and the stream of the sensors.
std::vector<std::uint8_t> create2_begin();
std::vector<std::uint8_t> create2_safe_mode();
/// Stops the stream and leaves the interface: the motors are off.
std::vector<std::uint8_t> create2_end();
/// A velocity, by its wheels. Both are slowed down alike where one would be too fast, so that the
/// arc stays. Only linear.x and yaw_rate count; a velocity that is not finite is a stop.
std::vector<std::uint8_t> create2_drive(const Twist& velocity);

/// Finds the packets in the bytes of a stream, wherever these begin and whatever stands between.
/// A packet counts if it has the length that was asked for, the ids in their order, and its
/// checksum. A value; one thread.
class Create2Stream {
 public:
  /// The sensors of each packet that ends in these bytes, oldest first.
  std::vector<Create2Sensors> add(std::span<const std::uint8_t> bytes);
  std::size_t dropped() const { return dropped_; }  ///< bytes that belong to no packet, so far

 private:
  std::vector<std::uint8_t> waiting_;
  std::size_t dropped_ = 0;
};

/// Counts of an encoder from one packet to the next; the short way round where it has wrapped.
int counts_between(std::int16_t before, std::int16_t after);

}  // namespace prospect
