#include "engine/leftovers_clock.h"

#include <algorithm>

#include "models/parameter_check.h"

namespace prospect {
namespace {

// A robot that has not got kHeldWithin [m] away for kHeldAfter [s] is held.
constexpr double kHeldWithin = 1.0, kHeldAfter = 20.0;

}  // namespace

LeftoversClock::LeftoversClock(const Options& options) : options_(options) {
  const auto require = [](const char* name, double value, double most, const char* expected) {
    check_parameter(value >= 0.0 && value <= most, "leftovers", name, value, expected);
  };
  require("share", options.share, 1000.0, "0 to 1000");
  require("least", options.least, 1e6, "0 to 1e6 s");
  require("growth", options.growth, 1000.0, "0 to 1000");
}

bool LeftoversClock::update(double stamp, const Eigen::Vector2d& position, double explored) {
  const bool grown = until_ && explored >= (1.0 + options_.growth) * area_;
  if (grown) {
    until_ = std::max(*until_, stamp + options_.least);
    area_ = explored;
    held_for_ = 0.0;
  }
  if (!started_at_ || (position - arrived_).norm() >= kHeldWithin) {
    arrived_ = position;
    arrived_at_ = stamp;
  }
  if (until_ && stamp - arrived_at_ >= kHeldAfter) {
    const double left = std::max(0.0, options_.least - held_for_);
    const double held = std::clamp(stamp - last_, 0.0, left);
    held_for_ += held;
    *until_ += held;
  }
  if (!started_at_) started_at_ = stamp;
  last_ = stamp;
  return grown;
}

void LeftoversClock::begin(double stamp, double explored) {
  if (until_) return;
  const double took = started_at_ ? stamp - *started_at_ : 0.0;
  until_ = stamp + std::max(options_.least, options_.share * took);
  area_ = explored;
}

}  // namespace prospect
