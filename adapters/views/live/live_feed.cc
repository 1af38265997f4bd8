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

void LiveFeed::step(const StepRecord& step) {
  std::shared_ptr<const StepRecord> copy = std::make_shared<StepRecord>(step);
  const std::lock_guard lock(mutex_);
  add(news_.steps, std::move(copy), news_.dropped);
}

void LiveFeed::belief(const Belief& belief) {
  std::shared_ptr<const LivePose> copy = std::make_shared<LivePose>(
      LivePose{belief.stamp, belief.pose, belief.covariance, belief.twist, belief.localization});
  const std::lock_guard lock(mutex_);
  news_.pose.swap(copy);
}

void LiveFeed::driver(const RealTimeDriver& driver, double now) {
  if (!is_due(driver_at_)) return;
  EventLog::Reading reading = driver.events().since(next_event_);
  next_event_ = reading.next;
  std::shared_ptr<const LiveDriver> copy =
      std::make_shared<LiveDriver>(LiveDriver{now, driver.status(), driver.health()});
  const std::lock_guard lock(mutex_);
  news_.driver.swap(copy);
  for (Event& event : reading.events) add(news_.events, std::move(event), news_.dropped);
}

void LiveFeed::picture(const Image& left, const std::vector<LandmarkSighting>& sightings) {
  if (!wants_pictures() || left.pixels.empty() || !is_due(picture_at_)) return;
  std::shared_ptr<const LivePicture> copy =
      std::make_shared<LivePicture>(LivePicture{left, sightings});
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
