// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "adapters/views/live/live_feed.h"
#include "adapters/views/live/live_page.h"
#include "adapters/views/live/step_history.h"
#include "adapters/views/live/viewer.h"
#include "runtime/drive_commands.h"

namespace prospect {

/// What the page of the live view is shown: steps, all of them in order, and the newest of status,
/// pose and picture. A page that is slow gets steps in larger portions and misses what is not the
/// newest any more. Thread-safety: one thread.
class PageShow {
 public:
  /// resolution [m] of the ground cells. real_time: else a simulation in lockstep. `commands`
  /// outlives it. Throws InputError if the codecs of its pictures cannot be loaded.
  PageShow(double resolution, bool real_time, DriveCommands& commands);

  void add(const LiveFeed::News& news);
  /// Tells the viewers of each other.
  void count(const ViewerCounts& counts);
  /// One who may command by messages {"op":"command","name":"hold"}, with x and y [m] of "go"; else
  /// who only watches. It must not outlive this.
  std::unique_ptr<Viewer> viewer(bool may_command);

 private:
  friend class PageViewer;
  /// The newest of something, as a message that is made when it is first wanted.
  struct Newest {
    std::uint64_t number = 0;  // of all so far; 0: none yet
    std::function<std::string()> make;
    std::shared_ptr<const std::string> text;
    void set(std::function<std::string()> how) {
      ++number;
      make = std::move(how);
      text.reset();
    }
    const std::shared_ptr<const std::string>& get() {
      if (!text) text = std::make_shared<std::string>(make());
      return text;
    }
  };
  void renew_status();

  const double resolution_;
  const bool real_time_;
  DriveCommands& commands_;
  StepHistory history_;
  std::shared_ptr<const LiveDriver> driver_;
  std::deque<Event> events_;  // the newest
  ViewerCounts counts_;
  std::uint64_t dropped_steps_ = 0;
  std::optional<double> began_;  // LiveStatus
  /// Told to drive, stopped, what became of the place.
  using Asked = std::tuple<bool, bool, std::string>;
  Asked asked_{true, false, ""};
  Newest status_, pose_, picture_, end_;
  // The newest portion of steps, which most viewers want alike.
  int portion_after_ = -2, portion_to_ = -1;
  std::shared_ptr<const std::string> portion_;
};

}  // namespace prospect
