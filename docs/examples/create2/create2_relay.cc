// SPDX-License-Identifier: Apache-2.0
#include "create2_relay.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "models/parameter_check.h"
#include "runtime/clock.h"
#include "runtime/relay_process.h"
#include "serial_port.h"

namespace prospect {
namespace {

constexpr double kRetry = 0.5;  // [s] from one try to enter the safe mode to the next

// What goes over the link.
struct Command {
  double speed, yaw_rate, expires;
};

/// The relay's own loop.
class Relay {
 public:
  Relay(const Create2Options& options, SerialPort& port, int link)
      : options_(options), port_(port), link_(link) {}

  void run() {
    begin();
    while (take() && !port_.closed()) {
      const double now = clock_.now();
      const double end = std::min(newest_ + options_.dead_man, expires_);
      if (now >= end && now - zero_ >= options_.period) {
        if (port_.write(create2_drive({}))) zero_ = now;
      }
      if (awaits_begin_) begin();
      listen();
      wait(now < end ? std::min(end - now, options_.period) : options_.period);
    }
    if (port_.closed()) {
      Create2Relay::Word gone;
      gone.stamp = clock_.now();
      gone.unplugged = true;
      tell(gone);
      return;
    }
    say_for_sure(create2_drive({}));
    say_for_sure(create2_end());
  }

 private:
  void begin() { awaits_begin_ = !port_.write(create2_begin()); }

  /// The commands that have come; false: the owner is gone.
  bool take() {
    for (;;) {
      Command command;
      const LinkRead read = receive_on(link_, command);
      if (read != LinkRead::kMessage) return read == LinkRead::kNothing;
      const double now = clock_.now();
      // One that the line does not take is followed by the next, or by the stop when it is due.
      if (now < command.expires &&
          port_.write(create2_drive({{command.speed, 0.0, 0.0}, command.yaw_rate}))) {
        newest_ = now;
        expires_ = command.expires;
        zero_ = -1e9;
      }
    }
  }

  void listen() {
    for (const Create2Sensors& sensors : stream_.add(port_.read())) {
      constexpr int kSafeMode = 2;
      const double now = clock_.now();
      if (sensors.mode < kSafeMode && may_enter_safe_mode(sensors) && now - tried_ >= kRetry) {
        tried_ = now;
        // At rest when it is back.
        expires_ = 0.0;
        port_.write(create2_safe_mode());
      }
      tell({now, sensors, false});
    }
  }

  void tell(const Create2Relay::Word& word) const { send_on(link_, word); }

  void wait(double seconds) const {
    std::array<pollfd, 2> waits = {pollfd{port_.descriptor(), POLLIN, 0}, pollfd{link_, POLLIN, 0}};
    const auto time = static_cast<long>(1e9 * std::clamp(seconds, 0.0, 1.0));
    const timespec limit{time / 1000000000, time % 1000000000};
    ::ppoll(waits.data(), waits.size(), &limit, nullptr);
  }

  /// Tries for as long as a line of this rate may need to be free.
  void say_for_sure(const std::vector<std::uint8_t>& bytes) {
    for (const double end = clock_.now() + 0.2; clock_.now() < end && !port_.write(bytes);) {
      ::usleep(1000);
    }
  }

  const Create2Options& options_;
  SerialPort& port_;
  int link_;
  SteadyClock clock_;
  Create2Stream stream_;
  bool awaits_begin_ = false;
  double newest_ = -1e9, expires_ = -1e9, zero_ = -1e9, tried_ = -1e9;  // [s]
};

}  // namespace

Create2Relay::Create2Relay(const Create2Options& options) {
  const auto within = [](bool so, const char* name, double value, const char* expected) {
    check_parameter(so, "create2", name, value, expected);
  };
  within(options.dead_man >= 0.05 && options.dead_man <= 2.0, "dead_man", options.dead_man,
         "0.05 to 2 s");
  within(options.period >= 0.01 && options.period <= 1.0, "period", options.period, "0.01 to 1 s");
  within(options.patience > 0.0 && options.patience <= 60.0, "patience", options.patience,
         "0 to 60 s, more than 0");
  SerialPort port(options.device, options.rate);
  process_.emplace(options.device, std::vector{port.descriptor()},
                   [&](int link) { Relay(options, port, link).run(); });
  const SteadyClock clock;
  for (const double until = clock.now() + options.patience; first_.empty() && !ended_;) {
    const double left = until - clock.now();
    if (!(left > 0.0)) break;
    process_->wait(left);
    first_ = newest();
  }
  if (first_.empty() || first_.front().unplugged) {
    throw std::invalid_argument(
        options.device +
        ": nothing that can be understood comes; expected a Create 2 that is switched "
        "on, at " +
        std::to_string(options.rate) + " baud");
  }
}

bool Create2Relay::send(const Twist& velocity, double expires) noexcept {
  return send_on(process_->link(), Command{velocity.linear.x(), velocity.yaw_rate, expires});
}

std::vector<Create2Relay::Word> Create2Relay::newest() noexcept {
  std::vector<Word> words = std::move(first_);
  first_.clear();
  Word word;
  LinkRead read;
  while ((read = receive_on(process_->link(), word)) == LinkRead::kMessage) words.push_back(word);
  ended_ = ended_ || read == LinkRead::kEnded;
  return words;
}

}  // namespace prospect
