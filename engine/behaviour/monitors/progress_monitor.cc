// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/monitors/progress_monitor.h"

#include <utility>

#include "engine/behaviour/monitors/nearest_place.h"
#include "models/knobs.h"

namespace prospect {

ProgressMonitor::ProgressMonitor(const Options& options) : options_(options) {
  check_knobs("progress", options);
}

void ProgressMonitor::begin(double stamp, double explored) {
  if (!progress_at_) explored_ = explored;
  // A clock that jumps back must not freeze it.
  if (!progress_at_ || stamp < *progress_at_) progress_at_ = stamp;
  stamp_ = stamp;
}

void ProgressMonitor::hold(double stamp) {
  if (!progress_at_ || !(stamp > stamp_)) return;
  *progress_at_ += stamp - stamp_;
  stamp_ = stamp;
}

void ProgressMonitor::no_target() {
  stalled_ = false;
  progress_at_ = stamp_;
  stalled_for_ = 0.0;
}

void ProgressMonitor::got_on() {
  progress_at_ = stamp_;
  lost_ = false;
}

bool ProgressMonitor::lost_again() { return std::exchange(lost_, true); }

void ProgressMonitor::follow(const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& now) {
  if (nearest_) nearest_ = now(*nearest_);
}

void ProgressMonitor::update(bool same, const Eigen::Vector2d& position,
                             const CostToGoAt& cost_to_go, double explored) {
  if (!same) {
    stalled_ = false;
    lost_ = false;
    nearest_.reset();
  }
  if (got_nearer(nearest_, position, cost_to_go, options_.distance)) got_on();
  if (explored - explored_ >= options_.area) {
    explored_ = explored;
    stalled_ = false;
    got_on();
  }
  stalled_for_ = stamp_ - *progress_at_;
  if (stalled_for_ >= options_.stalled_after - 1e-9) {
    if (!stalled_) stalled_at_ = position;
    stalled_ = true;
  } else if ((position - stalled_at_).norm() >= options_.away) {
    stalled_ = false;
  }
}

bool ProgressMonitor::hopeless() const { return stalled_for_ >= options_.hopeless_after - 1e-9; }

void ProgressMonitor::given_up(double explored) {
  stalled_ = false;
  progress_at_ = stamp_;
  explored_ = explored;
  stalled_for_ = 0.0;
}

void describe(Knobs& knobs, ProgressMonitor::Options& o) {
  knobs.number("stalled_after", o.stalled_after, {0.01, 1e6}, "s",
               "without progress until the path is reconsidered");
  knobs.number("hopeless_after", o.hopeless_after, {0.01, 1e6}, "s",
               "without progress until the target is given up");
  knobs.require(o.hopeless_after > o.stalled_after, "hopeless_after",
                "hopeless_after <= stalled_after; expected more");
  knobs.number("distance", o.distance, {0.001, 1e3}, "m", "nearer to the target: progress");
  knobs.number("area", o.area, {0.001, 1e4}, "m2", "explored besides: progress");
  knobs.number("away", o.away, {0.001, 1e3}, "m",
               "from where it stalled, a robot that gets on has got away");
}

}  // namespace prospect
