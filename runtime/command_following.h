// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <deque>
#include <optional>
#include <span>
#include <string>

#include "engine/maps/belief.h"
#include "models/imu_sample.h"
#include "models/types.h"
#include "runtime/base.h"
#include "runtime/gyro_rate.h"
#include "runtime/predicted_belief.h"

namespace prospect {

class Knobs;

struct CommandFollowingOptions {
  double lag = 0.25;          ///< [s] by which motion may be later than the known delay
  double slip = 0.3;          ///< [1] share by which it may be more or less than it is told
  double hold = 0.1;          ///< [1] by which the share that it makes of commands may change
  double least_speed = 0.03;  ///< [m/s] that counts
  double least_rate = 0.05;   ///< [rad/s] that counts
  /// [rad/s] most that a gyro may be off: above the zero-rate offset of data sheets, 5 deg/s.
  double gyro_bias = 0.1;
  // What makes it a base that does not follow: more than it is told, or half as much the other
  // way, or another speed than it has held; a turn that is less leads elsewhere, too ...
  double more_distance = 0.1;  ///< [m]
  double turn = 0.2;           ///< [rad]
  // ... and what stands, or is less from the beginning, leads nowhere that nobody has looked at.
  double less_distance = 0.3;  ///< [m]
};
/// The knobs (models/knobs.h).
void describe(Knobs& knobs, CommandFollowingOptions& options);

/// What a base was told.
struct ToldCommand {
  double time = 0.0, expires = 0.0;  ///< [s]
  Twist twist;
  bool stop = false;  ///< Base::stop(): `twist` is what it is taken to do then
};

/// A motion that is not the one that was told.
struct Departure {
  int axis = 0;                            ///< in B: 0 forward, 1 to the left [m/s], 2 yaw [rad/s]
  double by = 0.0;                         ///< beyond what is allowed, with its sign [m] or [rad]
  double told_low = 0.0, told_high = 0.0;  ///< least and most that was told [m/s] or [rad/s]
  double measured = 0.0;                   ///< the newest, of the same
  std::string witness;                     ///< "wheels", "pose", "gyro", "wheels and pose", ...
};
/// "forward -0.58 of +0.60 m/s told: -0.11 m, by wheels and pose"
std::string to_text(const Departure& departure);

/// Notices that a base moves otherwise than it is told: the other way, too far, or not at all.
///
/// Told. Between no delay at all and the known one plus `lag` a command acts, so on each axis
/// (forward, left, yaw) the velocity over a time [s, t] is told as a band: from the least, lo, to
/// the most, hi, of the commands in force in [s - delay - lag, t]. A command that has expired may
/// act or not, and so may one that was a stop: its band reaches to zero.
///
/// Measured are the mean velocities m over [s, t] by up to three witnesses: the wheels
/// (BaseReport), the pose of the belief while it is localized, and of yaw the gyro (GyroRate) once
/// its bias is known, which it learns while the base is told to stand and its wheels do. Each has
/// sums a side of each axis, +1 and -1, never below zero, which grow by what is beyond the band and
/// fall by what is within it (CUSUM, Page 1954), so a constant error of any size is found after a
/// way of its own, and noise about zero never. With to = max(0, most told to that side), away =
/// max(0, least told away from it):
///     more += w (side m - to - slip |(to, across)| - least_speed) dt
///     less += (away - slip |(away, across)| - least_speed - made) dt, made = max(0, -side m)
///     slower += the same, while made > least_speed: who moves was not stopped by anything
/// across: the most told on the other axis (of yaw: 0), as who slips or is turned a little in W
/// moves to the side, too; away from a side there is no slip to it. w = 2 where nothing was told to
/// that side and more than least_speed away from it, which no overshoot makes of it, else 1.
///
/// Slip is a number that nobody knows, within 1 - slip and 1 + slip, but it does not change with
/// each command. So each axis of each witness has a mean share g = m / told of the time in which it
/// was told nearly the same for the whole band, of its first 0.5 m or rad, then forgotten over 4.
/// With u from slip (nothing held yet) to hold (from 0.5 m or rad on) the sums grow also by
///     side m - max(1, g) to - max(u |(to, across)|, least_speed), of the wheels alone: what the
///                                                          ground adds may change at once
///     min(1, g) away - max(u |(away, across)|, least_speed) - made
/// but fall only where it is within slip, too.
/// One sample adds at most a third of the limit: one alone decides nothing. Who stands as it is
/// told to begins the sums anew.
///
/// First is who tells first how the base moves: the wheels; the pose, where the base measures
/// nothing itself (BaseReport::velocity_of_poses). A base does not follow, where a witness agrees
/// that has half of what it takes on that axis, to whatever side (so a pose that stands still does
/// not deny what others say),
///   * if by the first a sum is beyond its limit (more, slower: more_distance; less:
///     less_distance; turn), and another witness agrees, or there is none: wheels that
///     lie are not a base that goes astray;
///   * if by the pose it makes twice the limit of `more`, and a gyro that is there agrees. Less by
///     the pose alone is no fault of the base: wheels slip, the body touches something, a picture
///     stands still;
///   * if by the gyro a sum is beyond its limit, and the wheels agree, or of `more` the pose, or
///     there is no pose. Wheels say what they were told, but a heading that is theirs alone is
///     wrong once they slip; where there is a pose, who turns less than wheels say is not at fault.
///
/// Thread-safety: one thread. Errors: the constructor throws std::invalid_argument on options out
/// of range; numbers that are not finite, samples that are further than 0.3 s apart, and poses
/// whose stamps grow by less than 0.4 of the time that passes, say nothing. Source: our choice.
class CommandFollowing {
 public:
  explicit CommandFollowing(const CommandFollowingOptions& options = {},
                            const ActuationDelay& delay = {});

  /// What the base is told from now on; times grow.
  void told(const ToldCommand& command);
  /// belief: the newest, null: none, or none but that of the wheels. imu: what came since the look
  /// before, oldest first.
  std::optional<Departure> look(double now, const BaseReport& base, const Belief* belief,
                                std::span<const ImuSample> imu = {});

 private:
  static constexpr int kAxes = 3, kYaw = 2;
  struct Band {
    double low = 0.0, high = 0.0;
  };
  using Bands = std::array<Band, kAxes>;
  struct Sums {
    std::array<double, 2> more{}, slower{}, less{};  // of sides +1, -1
    double measured = 0.0;                           // the newest
    Band told;                                       // likewise
    double share = 1.0, held = 0.0;                  // g of the header; the way it was told for it
  };
  struct Witness {
    std::optional<double> stamp;  // of the newest sample
    std::array<Sums, kAxes> sums;
    void forget() { *this = {}; }
  };

  Bands told_in(double from, double until) const;
  /// Of the axes from `first` on.
  void add(Witness& witness, double from, double until, const std::array<double, kAxes>& measured,
           int first = 0);
  void learn(Sums& sums, const Band& told, double measured, double least, double dt) const;
  double unknown(const Sums& sums) const;  // u of the header
  void add_wheels(const BaseReport& base);
  void add_pose(double now, const Belief* belief);
  void add_gyro(double now, const BaseReport& base, std::span<const ImuSample> imu);
  double limit(int axis, bool more) const;
  /// Whether a witness is there, and has half of what it takes on an axis, to whatever side.
  bool agrees(const Witness& witness, int axis) const;
  /// What a witness has of more to that side [m] or [rad], if that is `times`
  /// its limit; else 0.
  double more_by(const Witness& witness, int axis, std::size_t side, double times = 1.0) const;
  double less_by(const Witness& witness, int axis, std::size_t side) const;  // likewise
  /// To that side (0: +1, 1: -1), by whichever witness has enough.
  std::optional<Departure> departure(int axis, std::size_t side) const;

  CommandFollowingOptions options_;
  ActuationDelay delay_;
  std::deque<ToldCommand> told_;
  Witness wheels_, pose_, gyro_;
  bool pose_first_ = false;
  GyroRate gyro_rate_;
  Pose newest_pose_;        // at pose_.stamp
  double pose_came_ = 0.0;  // [s] when it was looked at first
};

}  // namespace prospect
