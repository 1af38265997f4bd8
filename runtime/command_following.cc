// SPDX-License-Identifier: Apache-2.0
#include "runtime/command_following.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "models/formatted.h"
#include "models/knobs.h"
#include "models/limited_twist.h"

namespace prospect {
namespace {

constexpr double kApart = 0.3;   // [s] between two samples that belong together
constexpr double kGoesOn = 0.4;  // share of the time that passes, by which stamps grow at least
constexpr double kHeld = 0.5, kForgotten = 4.0;  // [m] or [rad]
constexpr double kFresh = 0.6;                   // [s] that the newest pose or sample may be old
constexpr double kAgainst = 2.0;                 // weight of motion against all that was told
constexpr std::array kSides = {1.0, -1.0};

std::array<double, 3> axes(const Twist& twist) {
  return {twist.linear.x(), twist.linear.y(), twist.yaw_rate};
}

/// What a sum grows by, where it is beyond a bound, or falls by, where it is within a looser one.
double beyond(double strict, double loose) { return strict > 0.0 ? strict : std::min(0.0, loose); }

}  // namespace

std::string to_text(const Departure& d) {
  constexpr std::array kNames = {"forward", "to the left", "yaw"};
  const char* unit = d.axis == 2 ? "rad" : "m";
  const std::string told = d.told_low == d.told_high
                               ? formatted("%+.2f", d.told_low)
                               : formatted("%+.2f to %+.2f", d.told_low, d.told_high);
  return formatted("%s %+.2f of %s %s/s told: %+.2f %s, by %s",
                   kNames[static_cast<std::size_t>(d.axis)], d.measured, told.c_str(), unit, d.by,
                   unit, d.witness.c_str());
}

CommandFollowing::CommandFollowing(const CommandFollowingOptions& options,
                                   const ActuationDelay& delay)
    : options_(options), delay_(delay), gyro_rate_(options.gyro_bias) {
  check_knobs("command following", options_);
  check_knobs("command following: delay", delay_);
}

void CommandFollowing::told(const ToldCommand& command) {
  constexpr double kKept = 3.0;  // [s], longer than a belief may be old
  told_.push_back(command);
  while (told_.size() > 1 && told_[1].time < command.time - kKept) told_.pop_front();
}

CommandFollowing::Bands CommandFollowing::told_in(double from, double until) const {
  Bands bands;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    const double since = from - (axis == 2 ? delay_.angular : delay_.linear) - options_.lag;
    std::optional<Band> band;
    const auto take = [&](double value) {
      if (!band) band = Band{value, value};
      band = Band{std::min(band->low, value), std::max(band->high, value)};
    };
    // Before the first command it was told nothing.
    if (told_.empty() || told_.front().time > since) take(0.0);
    for (std::size_t k = 0; k < told_.size() && told_[k].time <= until; ++k) {
      const bool newest = k + 1 == told_.size();
      const double end = newest ? until : std::min(until, told_[k + 1].time);
      if (end < since) continue;
      take(axes(told_[k].twist)[axis]);
      if (told_[k].stop || end > told_[k].expires) take(0.0);
    }
    bands[axis] = *band;
  }
  return bands;
}

double CommandFollowing::limit(int axis, bool more) const {
  if (axis == 2) return options_.turn;
  return more ? options_.more_distance : options_.less_distance;
}

double CommandFollowing::unknown(const Sums& sums) const {
  return options_.slip + (options_.hold - options_.slip) * std::min(1.0, sums.held / kHeld);
}

void CommandFollowing::learn(Sums& sums, const Band& told, double measured, double least,
                             double dt) const {
  const double mean = 0.5 * (told.low + told.high);
  if (std::abs(mean) < 3.0 * least || told.high - told.low > 0.1 * std::abs(mean)) return;
  const double way = std::abs(mean) * dt;
  const double share = std::clamp(measured / mean, 1.0 - options_.slip, 1.0 + options_.slip);
  sums.held = std::min(sums.held + way, kHeld);
  sums.share +=
      (share - sums.share) * std::min(1.0, way / (sums.held < kHeld ? sums.held : kForgotten));
}

void CommandFollowing::add(Witness& witness, double from, double until,
                           const std::array<double, kAxes>& measured, int first) {
  const double dt = until - from;
  const Bands bands = told_in(from, until);
  const auto farthest = [](const Band& band) {
    return std::max(std::abs(band.low), std::abs(band.high));
  };
  // What the ground adds may change at once.
  const bool at_wheels = &witness == &wheels_;
  bool stands = true;
  for (int axis = 0; axis < kAxes; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    const Band band = bands[at];
    const double m = measured[at];
    if (axis < first) {
      stands = stands && band.low == 0.0 && band.high == 0.0;
      continue;
    }
    const double least = axis == 2 ? options_.least_rate : options_.least_speed;
    // What slips, or is turned a little in W, moves to the side, too.
    const double across = axis == 2 ? 0.0 : farthest(bands[1 - at]);
    stands = stands && band.low == 0.0 && band.high == 0.0 && std::abs(m) <= least;
    Sums& sums = witness.sums[at];
    sums.measured = m;
    sums.told = band;
    const double u = unknown(sums);
    const auto grow = [&](double& sum, double by, double most) {
      // What holds on is over soon after it has ended.
      sum = std::clamp(sum + std::min(by, most / 3.0), 0.0, 2.5 * most);
    };
    for (std::size_t k = 0; k < kSides.size(); ++k) {
      const double side = kSides[k];
      // Who is told to move to that side at most, and away from it at least.
      const double to = std::max(0.0, side > 0.0 ? band.high : -band.low);
      const double away = std::max(0.0, side > 0.0 ? -band.high : band.low);
      const double away_at_most = std::max(0.0, side > 0.0 ? -band.low : band.high);
      const double weight = to == 0.0 && away_at_most > least ? kAgainst : 1.0;
      const double along = std::hypot(to, across), back = std::hypot(away, across);
      const double made = std::max(0.0, -side * m);
      // By what has been learned, and by slip alone: what is between grows and falls least.
      const double most = at_wheels ? std::max(1.0, sums.share) * to + std::max(u * along, least)
                                    : std::numeric_limits<double>::infinity();
      const double slips = to + options_.slip * along + least;
      grow(sums.more[k], weight * beyond(side * m - std::min(most, slips), side * m - slips) * dt,
           limit(axis, true));
      const double asked = std::min(1.0, sums.share) * away - std::max(u * back, least);
      const double slipped = std::max(0.0, away - options_.slip * back - least);
      const double wanted = std::max(asked, slipped);
      const double by = wanted > 0.0 ? beyond(wanted - made, slipped - made) * dt : -least * dt;
      grow(sums.less[k], by, limit(axis, false));
      // Who moves, but less, was not stopped by anything.
      grow(sums.slower[k], made > least ? by : -least * dt, limit(axis, true));
    }
    learn(sums, band, m, least, dt);
  }
  if (!stands) return;
  for (Sums& sums : witness.sums) sums.more = sums.slower = sums.less = {};
}

void CommandFollowing::add_wheels(const BaseReport& base) {
  pose_first_ = base.velocity_of_poses;
  if (!base.connected || !is_finite(base.velocity) || base.velocity_of_poses) {
    wheels_.forget();
    return;
  }
  if (wheels_.stamp && !(base.stamp > *wheels_.stamp)) return;
  if (wheels_.stamp && base.stamp - *wheels_.stamp <= kApart) {
    add(wheels_, *wheels_.stamp, base.stamp, axes(base.velocity));
  }
  wheels_.stamp = base.stamp;
}

void CommandFollowing::add_pose(double now, const Belief* belief) {
  if (!belief || belief->localization != Localization::kOk || !(now - belief->stamp <= kFresh) ||
      !belief->pose.position.allFinite() || !std::isfinite(belief->pose.yaw)) {
    pose_.forget();
    return;
  }
  const double dt = pose_.stamp ? belief->stamp - *pose_.stamp : 0.0;
  if (pose_.stamp && dt == 0.0) return;
  // The stamps of a clock that is stuck hardly grow while the pose goes on.
  if (dt <= kApart && dt > kGoesOn * (now - pose_came_)) {
    const double turned = std::remainder(belief->pose.yaw - newest_pose_.yaw, 2.0 * M_PI);
    const Eigen::Vector2d moved = Eigen::Rotation2Dd(-newest_pose_.yaw - 0.5 * turned) *
                                  (belief->pose.position - newest_pose_.position).head<2>();
    add(pose_, *pose_.stamp, belief->stamp, {moved.x() / dt, moved.y() / dt, turned / dt});
  }
  pose_.stamp = belief->stamp;
  pose_came_ = now;
  newest_pose_ = belief->pose;
}

void CommandFollowing::add_gyro(double now, const BaseReport& base,
                                std::span<const ImuSample> imu) {
  const std::optional<GyroRate::Turn> turn = gyro_rate_.look(imu);
  if (turn) {
    const Bands bands = told_in(turn->from, turn->until);
    const bool told = std::any_of(bands.begin(), bands.end(),
                                  [](const Band& b) { return b.low != 0.0 || b.high != 0.0; });
    if (!told && base.connected && base.velocity.linear.norm() <= options_.least_speed &&
        std::abs(base.velocity.yaw_rate) <= options_.least_rate) {
      gyro_rate_.stood(*turn);
    }
    if (gyro_rate_.knows_bias()) {
      gyro_.stamp = turn->until;
      add(gyro_, turn->from, turn->until, {0.0, 0.0, turn->rate}, kYaw);
    }
  }
  if (gyro_.stamp && !(std::abs(now - *gyro_.stamp) <= kFresh)) gyro_.forget();
}

bool CommandFollowing::agrees(const Witness& witness, int axis) const {
  if (!witness.stamp) return false;
  const auto at = static_cast<std::size_t>(axis);
  const Sums& sums = witness.sums[at];
  const auto most = [](const std::array<double, 2>& of) { return std::max(of[0], of[1]); };
  return most(sums.more) >= 0.5 * limit(axis, true) ||
         most(sums.slower) >= 0.5 * limit(axis, true) ||
         most(sums.less) >= 0.5 * limit(axis, false);
}

double CommandFollowing::more_by(const Witness& witness, int axis, std::size_t side,
                                 double times) const {
  if (!witness.stamp) return 0.0;
  const auto at = static_cast<std::size_t>(axis);
  const double more = witness.sums[at].more[side];
  return more >= times * limit(axis, true) ? more : 0.0;
}

double CommandFollowing::less_by(const Witness& witness, int axis, std::size_t side) const {
  if (!witness.stamp) return 0.0;
  const Sums& sums = witness.sums[static_cast<std::size_t>(axis)];
  const double slower = sums.slower[side], less = sums.less[side];
  return std::max(slower >= limit(axis, true) ? slower : 0.0,
                  less >= limit(axis, false) ? less : 0.0);
}

std::optional<Departure> CommandFollowing::departure(int axis, std::size_t side) const {
  const bool gyro = axis == kYaw && gyro_.stamp;
  const bool by_wheels = agrees(wheels_, axis), by_pose = agrees(pose_, axis);
  const bool by_gyro = gyro && agrees(gyro_, axis);
  const auto made = [&](const Witness& witness, double by) {
    std::string who;
    for (const auto& [agreed, name] :
         {std::pair(by_wheels, "wheels"), {by_pose, "pose"}, {by_gyro, "gyro"}}) {
      if (agreed) who += (who.empty() ? "" : " and ") + std::string(name);
    }
    const Sums& sums = witness.sums[static_cast<std::size_t>(axis)];
    return Departure{axis, kSides[side] * by, sums.told.low, sums.told.high, sums.measured, who};
  };
  const Witness& first = pose_first_ ? pose_ : wheels_;
  const bool other = by_gyro || (!pose_first_ && by_pose);
  const bool alone = !gyro && (pose_first_ || !pose_.stamp);
  const double by_first = std::max(more_by(first, axis, side), less_by(first, axis, side));
  if (by_first > 0.0 && (other || alone)) return made(first, by_first);

  const double by_one = more_by(pose_, axis, side, 2.0);
  if (by_one > 0.0 && (!gyro || by_gyro)) return made(pose_, by_one);

  if (!gyro) return std::nullopt;
  const double turned_more = more_by(gyro_, axis, side), turned_less = less_by(gyro_, axis, side);
  if (turned_more > 0.0 && (by_wheels || by_pose || !pose_.stamp)) return made(gyro_, turned_more);
  if (turned_less > 0.0 && (by_wheels || !pose_.stamp)) return made(gyro_, turned_less);
  return std::nullopt;
}

std::optional<Departure> CommandFollowing::look(double now, const BaseReport& base,
                                                const Belief* belief,
                                                std::span<const ImuSample> imu) {
  add_wheels(base);
  add_pose(now, belief);
  add_gyro(now, base, imu);
  for (int axis = 0; axis < kAxes; ++axis) {
    for (std::size_t side = 0; side < kSides.size(); ++side) {
      if (auto found = departure(axis, side)) return found;
    }
  }
  return std::nullopt;
}

}  // namespace prospect
