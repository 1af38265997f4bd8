// SPDX-License-Identifier: Apache-2.0
#include "create2_protocol.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace prospect {
namespace {

using Bytes = std::vector<std::uint8_t>;

enum Opcode : std::uint8_t {
  kStart = 128,
  kSafe = 131,
  kDriveDirect = 145,
  kStream = 148,
  kPauseStream = 150,
  kStop = 173
};

// Packets of the stream and their sizes [bytes], in the order in which they are asked for.
struct Packet {
  std::uint8_t id;
  std::size_t size;
};
constexpr std::array kPackets = {Packet{7, 1},  // bumps and wheel drops
                                 Packet{9, 1},  Packet{10, 1},
                                 Packet{11, 1}, Packet{12, 1},   // cliffs
                                 Packet{14, 1},                  // overcurrents
                                 Packet{21, 1},                  // charging state
                                 Packet{25, 2}, Packet{26, 2},   // charge, capacity
                                 Packet{34, 1},                  // charging sources
                                 Packet{35, 1},                  // mode
                                 Packet{43, 2}, Packet{44, 2}};  // encoders
constexpr std::uint8_t kHeader = 19;

constexpr std::size_t payload_size() {
  std::size_t size = 0;
  for (const Packet& packet : kPackets) size += 1 + packet.size;
  return size;
}
constexpr std::size_t kFrame = payload_size() + 3;  // with header, length, checksum

bool is_frame(const std::uint8_t* bytes) {
  if (bytes[0] != kHeader || bytes[1] != payload_size()) return false;
  std::size_t at = 2;
  for (const Packet& packet : kPackets) {
    if (bytes[at] != packet.id) return false;
    at += 1 + packet.size;
  }
  const unsigned sum = std::accumulate(bytes, bytes + kFrame, 0U);
  return (sum & 0xFFU) == 0;
}

Create2Sensors sensors_in(const std::uint8_t* bytes) {
  Create2Sensors s;
  std::size_t at = 2;
  for (const Packet& packet : kPackets) {
    const unsigned value = packet.size == 1 ? bytes[at + 1] : bytes[at + 1] * 256U + bytes[at + 2];
    at += 1 + packet.size;
    const auto bit = [&](unsigned k) { return (value >> k & 1U) != 0; };
    switch (packet.id) {
      case 7:
        s.bump_right = bit(0), s.bump_left = bit(1);
        s.drop_right = bit(2), s.drop_left = bit(3);
        break;
      case 14:
        s.overcurrent_right = bit(3), s.overcurrent_left = bit(4);
        break;
      case 21:
        s.charging_state = static_cast<int>(value);
        break;
      case 25:
        s.charge = static_cast<int>(value);
        break;
      case 26:
        s.capacity = static_cast<int>(value);
        break;
      case 34:
        s.charger = value != 0;
        break;
      case 35:
        s.mode = static_cast<int>(value);
        break;
      case 43:
        s.left_count = static_cast<std::int16_t>(value);
        break;
      case 44:
        s.right_count = static_cast<std::int16_t>(value);
        break;
      default:
        s.cliff = s.cliff || bit(0);
    }
  }
  return s;
}

void add_16_bits(double value, Bytes& bytes) {
  const auto bits = static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(value)));
  bytes.push_back(static_cast<std::uint8_t>(bits >> 8));
  bytes.push_back(static_cast<std::uint8_t>(bits & 0xFFU));
}

}  // namespace

std::vector<std::string> faults_of(const Create2Sensors& s) {
  constexpr int kChargingFault = 5, kSafeMode = 2;
  constexpr double kLeastCharge = 0.1;
  std::vector<std::string> faults;
  const auto fault = [&](bool so, const char* text) {
    if (so) faults.emplace_back(text);
  };
  fault(s.bump_left || s.bump_right, "the bumper is pressed");
  fault(s.cliff, "a cliff sensor sees no floor");
  fault(s.drop_left || s.drop_right, "a wheel hangs");
  fault(s.overcurrent_left || s.overcurrent_right, "a wheel's motor draws too much current");
  fault(s.charging_state == kChargingFault, "its battery cannot be charged");
  fault(s.charger, "it stands at its charger");
  fault(s.capacity > 0 && s.charge < kLeastCharge * s.capacity, "its battery is below 10 %");
  fault(s.mode < kSafeMode, "it is not in its safe mode, in which it drives");
  return faults;
}

bool may_enter_safe_mode(const Create2Sensors& s) {
  return !(s.cliff || s.drop_left || s.drop_right || s.charger);
}

Bytes create2_begin() {
  Bytes bytes = {kStart, kSafe, kStream, static_cast<std::uint8_t>(kPackets.size())};
  for (const Packet& packet : kPackets) bytes.push_back(packet.id);
  return bytes;
}

Bytes create2_safe_mode() { return {kSafe}; }

Bytes create2_end() { return {kPauseStream, 0, kStop}; }

Bytes create2_drive(const Twist& velocity) {
  double speed = velocity.linear.x(), turn = 0.5 * kCreate2WheelBase * velocity.yaw_rate;
  if (!std::isfinite(speed) || !std::isfinite(turn)) speed = turn = 0.0;
  const double fastest = std::abs(speed) + std::abs(turn);
  const double share = fastest > kCreate2WheelSpeed ? kCreate2WheelSpeed / fastest : 1.0;
  Bytes bytes = {kDriveDirect};
  add_16_bits(1e3 * share * (speed + turn), bytes);  // right
  add_16_bits(1e3 * share * (speed - turn), bytes);  // left
  return bytes;
}

std::vector<Create2Sensors> Create2Stream::add(std::span<const std::uint8_t> bytes) {
  waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
  std::vector<Create2Sensors> found;
  std::size_t at = 0;
  while (waiting_.size() - at >= kFrame) {
    if (is_frame(waiting_.data() + at)) {
      found.push_back(sensors_in(waiting_.data() + at));
      at += kFrame;
    } else {
      ++at;
      ++dropped_;
    }
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(at));
  return found;
}

int counts_between(std::int16_t before, std::int16_t after) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(static_cast<std::uint16_t>(after) -
                                                              static_cast<std::uint16_t>(before)));
}

}  // namespace prospect
