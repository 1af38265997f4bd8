// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/live/live_feed.h"

#include <utility>

namespace prospect {
namespace {

using Time = std::chrono::steady_clock::time_point;
constexpr std::chrono::milliseconds kEvery(200);

/// Whether it is time again.
bool is_due(std::optional<Time>& last) {
  const Time now = std::chrono::steady_clock::now();
  if (last && now - *last < kEvery) return false;
  last = now;
  return true;
}

/// Appends; what is too much at the front is dropped, and counted.
template <typename Value>
void add(std::vector<Value>& list, Value value, std::uint64_t& dropped) {
  if (list.size() == LiveFeed::kMost) {
    list.erase(list.begin());
    ++dropped;
  }
  list.push_back(std::move(value));
}

}  // namespace

void LiveFeed::on_record(const StepRecord& record, const MissionStep&) {
  std::shared_ptr<const StepRecord> copy = std::make_shared<StepRecord>(record);
  const std::lock_guard lock(mutex_);
  add(news_.steps, std::move(copy), news_.dropped);
}

void LiveFeed::on_belief(const Belief& belief) {
  std::shared_ptr<const LivePose> copy = std::make_shared<LivePose>(
      LivePose{belief.stamp, belief.pose, belief.covariance, belief.twist, belief.localization});
  const std::lock_guard lock(mutex_);
  news_.pose.swap(copy);
}

void LiveFeed::on_events(std::span<const Event> events) {
  const std::lock_guard lock(mutex_);
  for (const Event& event : events) add(news_.events, event, news_.dropped);
}

void LiveFeed::on_status(const DriverStatus& status, const HealthReport& health) {
  std::shared_ptr<const LiveDriver> copy = std::make_shared<LiveDriver>(LiveDriver{status, health});
  const std::lock_guard lock(mutex_);
  news_.driver.swap(copy);
}

void LiveFeed::on_picture(const CameraPicture& picture) {
  if (!wants_pictures() || picture.image->pixels.empty() || !is_due(picture_at_)) return;
  std::shared_ptr<const CameraPicture> copy = std::make_shared<CameraPicture>(picture);
  const std::lock_guard lock(mutex_);
  news_.picture.swap(copy);
}

bool LiveFeed::wants_pictures() const {
  const std::lock_guard lock(mutex_);
  return watched_;
}

void LiveFeed::end(const Summary& summary) {
  std::shared_ptr<const Summary> copy = std::make_shared<Summary>(summary);
  const std::lock_guard lock(mutex_);
  news_.end.swap(copy);
}

LiveFeed::News LiveFeed::take(bool watched) {
  News taken;
  const std::lock_guard lock(mutex_);
  taken.dropped = news_.dropped;
  std::swap(taken, news_);
  watched_ = watched;
  return taken;
}

}  // namespace prospect
