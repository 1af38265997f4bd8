// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "docs/examples/create2/create2_protocol.h"

namespace prospect::test {

/// A packet of the stream, as the base sends it.
inline std::vector<std::uint8_t> create2_packet(const Create2Sensors& s) {
  const auto high = [](int v) { return static_cast<std::uint8_t>((v >> 8) & 0xFF); };
  const auto low = [](int v) { return static_cast<std::uint8_t>(v & 0xFF); };
  const auto bits = [](bool b0, bool b1, bool b2, bool b3) {
    return static_cast<std::uint8_t>(b0 + 2 * b1 + 4 * b2 + 8 * b3);
  };
  const auto cliff = static_cast<std::uint8_t>(s.cliff);
  std::vector<std::uint8_t> bytes = {
      19,
      30,
      7,
      bits(s.bump_right, s.bump_left, s.drop_right, s.drop_left),
      9,
      0,
      10,
      cliff,
      11,
      0,
      12,
      0,
      14,
      static_cast<std::uint8_t>(8 * s.overcurrent_right + 16 * s.overcurrent_left),
      21,
      static_cast<std::uint8_t>(s.charging_state),
      25,
      high(s.charge),
      low(s.charge),
      26,
      high(s.capacity),
      low(s.capacity),
      34,
      static_cast<std::uint8_t>(s.charger),
      35,
      static_cast<std::uint8_t>(s.mode),
      43,
      high(s.left_count),
      low(s.left_count),
      44,
      high(s.right_count),
      low(s.right_count)};
  unsigned sum = 0;
  for (const std::uint8_t byte : bytes) sum += byte;
  bytes.push_back(static_cast<std::uint8_t>(256U - (sum & 0xFFU)));
  return bytes;
}

/// A Create 2 behind a pseudo-terminal: obeys the commands, drives as it is told to until it is
/// told otherwise, and streams its sensors every 15 ms.
class FakeCreate2 {
 public:
  FakeCreate2() {
    master_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    ::grantpt(master_);
    ::unlockpt(master_);
    device_ = ::ptsname(master_);
    sensors_.charge = 2000, sensors_.capacity = 2600;
    sensors_.left_count = sensors_.right_count = 32700;  // wraps after 30 mm
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  ~FakeCreate2() {
    thread_ = {};
    if (master_ >= 0) ::close(master_);
  }

  const std::string& device() const { return device_; }
  std::atomic<bool> silent{false};   ///< sends nothing
  std::atomic<bool> corrupt{false};  ///< a bit of every other packet is wrong
  std::atomic<bool> unplug{false};

  double left() const { return left_; }      ///< velocity that the wheel was told last [m/s]
  double right() const { return right_; }    ///< [m/s]
  double driven() const { return driven_; }  ///< [m]
  int stops() const { return stops_; }       ///< how often it was told to leave the interface

  void set(const std::function<void(Create2Sensors&)>& change) {
    const std::lock_guard lock(mutex_);
    change(sensors_);
  }

 private:
  static double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

  void run(const std::stop_token& stop) {
    double before = now();
    bool odd = false;
    while (!stop.stop_requested()) {
      pollfd waits{master_, POLLIN, 0};
      ::poll(&waits, 1, 5);
      // Nobody has opened the other end: what is polled then is always ready.
      if ((waits.revents & POLLHUP) != 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
      if (unplug) {
        ::close(std::exchange(master_, -1));
        return;
      }
      std::uint8_t bytes[256];
      const ssize_t came = ::read(master_, bytes, sizeof bytes);
      if (came > 0) received_.insert(received_.end(), bytes, bytes + came);
      obey();
      const double time = now();
      if (time - before < kCreate2StreamPeriod) continue;
      const std::lock_guard lock(mutex_);
      const bool drives = sensors_.mode >= 2;
      left_way_ += drives ? left_ * (time - before) : 0.0;
      right_way_ += drives ? right_ * (time - before) : 0.0;
      before = time;
      driven_ = 0.5 * (left_way_ + right_way_);
      Create2Sensors told = sensors_;
      told.left_count = static_cast<std::int16_t>(
          sensors_.left_count + static_cast<int>(std::floor(left_way_ / kCreate2Count)));
      told.right_count = static_cast<std::int16_t>(
          sensors_.right_count + static_cast<int>(std::floor(right_way_ / kCreate2Count)));
      std::vector<std::uint8_t> packet = create2_packet(told);
      odd = !odd;
      if (corrupt && odd) packet[20] ^= 4;
      if (streams_ && !silent && ::write(master_, packet.data(), packet.size()) < 0) return;
    }
  }

  void obey() {
    const auto number = [&](std::size_t at) {
      return 1e-3 * static_cast<std::int16_t>(received_[at] * 256 + received_[at + 1]);
    };
    while (!received_.empty()) {
      std::size_t length = 1;
      const std::uint8_t code = received_[0];
      if (code == 145) length = 5;
      if (code == 150) length = 2;
      if (code == 148) length = received_.size() < 2 ? 2 : 2U + received_[1];
      if (received_.size() < length) return;
      const std::lock_guard lock(mutex_);
      if (code == 131) sensors_.mode = 2;
      if (code == 145) right_ = number(1), left_ = number(3);
      if (code == 148) streams_ = true;
      if (code == 173) {
        streams_ = false;
        sensors_.mode = 0;
        left_ = right_ = 0.0;
        ++stops_;
      }
      received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(length));
    }
  }

  int master_ = -1;
  std::string device_;
  std::mutex mutex_;
  Create2Sensors sensors_;
  std::vector<std::uint8_t> received_;
  bool streams_ = false;
  double left_way_ = 0.0, right_way_ = 0.0;  // [m]
  std::atomic<double> left_{0.0}, right_{0.0}, driven_{0.0};
  std::atomic<int> stops_{0};
  std::jthread thread_;
};

}  // namespace prospect::test
