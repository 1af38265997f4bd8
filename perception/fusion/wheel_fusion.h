// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <deque>
#include <string>

#include "engine/maps/belief.h"
#include "models/types.h"
#include "perception/fusion/scale_agreement.h"
#include "perception/fusion/visual_motion.h"

namespace prospect {

class Knobs;

/// Mean velocity of the wheels over the time since the sample before, in the body frame B.
struct WheelSample {
  double stamp = 0.0;                                  ///< [s], end of that time
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< forward and to the left [m/s]
  double yaw_rate = 0.0;                               ///< [rad/s]
};

/// Standard deviations of what wheels measure; variances grow with the way and the turn made.
struct WheelNoise {
  double along = 0.02;    ///< of the distance [m per sqrt(m)]
  double across = 0.01;   ///< to the side [m per sqrt(m)]
  double turn = 0.03;     ///< of the yaw, from turning [rad per sqrt(rad)]
  double heading = 0.02;  ///< of the yaw, from driving [rad per sqrt(m)]
  /// Of the scales of speed and yaw rate, which stay as they are [-]. Wheels of a real floor slip,
  /// and nobody has measured how much.
  double sigma_scale = 0.1;
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, WheelNoise& noise);

struct WheelFusionOptions {
  WheelNoise noise;             ///< sigma_scale: of s and r at the start
  double scale_walk = 0.0005;   ///< of s and r [1 per sqrt(m), 1 per sqrt(rad)]
  double gate = 16.3;           ///< of an innovation: chi^2_3, 0.999
  int slips = 3;                ///< visual frames in a row beyond the gate: the wheels have slipped
  double max_wheel_gap = 0.25;  ///< [s] without a sample: what moves the robot is not known
  double unknown_speed = 0.5;   ///< [m and rad per sqrt(s)] the way it may make then
  double max_wait = 1.0;        ///< [s] that a visual frame may arrive late
  /// Standard deviation [m] of the way made on wheels alone above which the robot is lost.
  double max_dead_reckoning = 0.25;
  /// Lengths by vision and by wheels are compared over pieces of the way of this length [m], the
  /// newest `pieces` of them; sigma_scale is what the wheels' own scale may be off by.
  double piece = 0.25;
  int pieces = 16;
  ScaleAgreementOptions agreement;
  Pose start;  ///< of B in W; z is not used
};

/// The knobs (models/knobs.h); start is where the robot stands.
void describe(Knobs& knobs, WheelFusionOptions& options);

struct FusedOdometry {
  double stamp = 0.0;
  double newest = 0.0;  ///< [s], of the newest measurement taken in, by wheels or vision
  Pose pose;            ///< of B in W, from WheelFusionOptions::start on; z = 0
  /// Of (x, y, yaw), against the start.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Twist twist;  ///< of the newest wheel sample, scaled
  Localization state = Localization::kLost;
  std::string reason;        ///< why it is not ok
  ScaleAgreement agreement;  ///< of lengths by vision with those by wheels, as they measure
  double scale = 1.0, sigma_scale = 0.0;            ///< s: true over measured speed
  double turn_scale = 1.0, sigma_turn_scale = 0.0;  ///< r: true over measured yaw rate
  double chi2 = 0.0;        ///< of the last innovation, 3 degrees of freedom
  double correction = 0.0;  ///< by how far the last visual frame moved the position [m]
};

/// Extended Kalman filter over wheel odometry and visual odometry of a robot in the plane.
///
/// State (x_k, y_k, psi_k, x, y, psi, s, r): the pose of B in W at the visual reference frame k,
/// the motion of B since then in B at k, and the scales of the wheels' speed and yaw rate. The pose
/// is
///   p_W = p_k + R(psi_k) p,   psi_W = psi_k + psi;
/// it becomes that of k, and the motion zero, where vision takes a new reference.
///
/// Wheels add to the motion: with v = s v_m, w = r w_m over dt, phi = w dt / 2,
///   p' = p + dt sinc(phi) R(psi + phi) v,   psi' = psi + w dt,
/// noise along^2 |v| dt and across^2 |v| dt in B, (turn^2 |w| + heading^2 |v|) dt in yaw.
/// Vision measures it:
///   h = (x, y, psi),   chi^2 = nu^T S^-1 nu against the gate.
/// So h is linear in the state, and neither it nor the wheels depend on the pose at k: a frame
/// moves that only as far as the scales have a part in both. A filter over two poses in W, one a
/// clone of the other (stochastic cloning: Roumeliotis and Burdick 2002), is the same to first
/// order, but takes from frames a knowledge of the yaw in W that they do not have, the more the
/// larger its variance (as with maps: Castellanos et al. 2007), and jumps after losses of vision.
/// A frame beyond the gate is not taken and makes the state degraded; `slips` of them in a row mean
/// that the wheels have slipped, if vision is ok, since it has checks of its own and wheels have
/// none: then the motion since the reference is taken from vision alone. Degraded vision may be as
/// wrong as the wheels: what it says beyond the gate is not taken, and after `slips` frames nobody
/// knows, the state is lost, until vision is ok. References that vision takes meanwhile are counted
/// from: the filter keeps its own until a frame is taken, so that wheels which slipped are found
/// out. If one of them was degraded, the innovation nu is what vision or the wheels were wrong by,
/// one as likely as the other: nu nu^T / 2 is added to the covariance of what is taken.
///
/// Late frames. A frame is worked in at its own time, once the wheels have told of that time, too;
/// at() works in those that wait, and moves the pose over the samples that came after. So a frame
/// that is late by less than max_wait gives the same bits as one that arrives at once.
///
/// Scale. What the gate lets through, and what is taken from vision after a slip, may still be of
/// the wrong size: of each piece of the way, from one visual reference to another and turning by
/// less than 1.5 rad, the ratio of the straight lines between its ends by vision and by the wheels
/// alone (s = r = 1) is kept, and scale_agreement.h judges them. As long as cameras may be out of
/// step by enough to explain it (VisualMotion::scale_sigma), no scale is blamed. Pieces that vision
/// calls less than a fifth or more than five times as long say nothing of a scale: the wheels have
/// slipped, or vision is wrong.
///
/// States. Ok: the newest visual frame was taken. Degraded: it was not, or was degraded itself, or
/// wheels are missing: dead reckoning. Lost: dead reckoning beyond max_dead_reckoning, or nothing
/// has been measured yet, or degraded vision and wheels disagree for `slips` frames, or vision and
/// wheels disagree about the scale: then one of them is calibrated wrongly, and no length is known.
///
/// Thread-safety: one thread at a time. Errors: the constructor throws std::invalid_argument on an
/// option out of range; the rest never throws: a sample or frame that is not finite or not possible
/// (100 m/s), is older than the one before or an hour ahead, or has a covariance that is none, is
/// left out, and at() says so. Deterministic.
class WheelFusion {
 public:
  explicit WheelFusion(const WheelFusionOptions& options = {});

  /// False: left out, at() says why.
  bool add(const WheelSample& sample);
  void add(const VisualMotion& visual);

  /// The estimate at `stamp` [s], which is taken as the newest time known if it is older. Beyond
  /// the newest sample the robot is taken to go on as it does, with the covariance of that.
  FusedOdometry at(double stamp) const;

 private:
  using State = Eigen::Matrix<double, 8, 1>;
  using Covariance = Eigen::Matrix<double, 8, 8>;

  void begin(double stamp);
  /// Moves the estimate by what was measured over dt.
  void move(const Eigen::Vector2d& velocity, double yaw_rate, double dt);
  /// The robot may have moved, nothing says how.
  void drift(double dt);
  void advance(double stamp);
  void work_in(const VisualMotion& visual);
  void work_in_waiting(double known);
  /// The pose is that of the visual reference from here on.
  void take_reference();
  Eigen::Vector3d pose() const;
  /// Vision has a new reference: lengths by it and by the wheels.
  void compare(const VisualMotion& visual);
  double motion_variance() const;

  WheelFusionOptions options_;
  bool started_ = false;
  double stamp_ = 0.0;  // of the estimate
  State x_ = State::Zero();
  Covariance P_ = Covariance::Zero();

  std::deque<WheelSample> wheels_;    // the newest one up to stamp_, and all after it
  std::deque<VisualMotion> waiting_;  // for samples of its time
  // Motion from the reference to vision's reference, of frames that were not taken; (0, 0, 0)
  // mostly.
  Eigen::Vector3d detour_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d detour_covariance_ = Eigen::Matrix3d::Zero();
  bool unsure_detour_ = false;  // by way of a degraded frame
  bool has_wheels_ = false, has_visual_ = false, has_reference_ = false;
  double newest_visual_ = 0.0;  // stamp of the newest frame that was given
  Localization visual_ = Localization::kLost;
  std::string visual_reason_ = "no visual odometry yet";
  std::string left_out_;  // what was refused since the last frame that was taken
  int beyond_gate_ = 0;
  bool contradicted_ = false;  // by degraded vision, for as long as would mean a slip
  // Of the motion, when vision last confirmed it [m^2]; less than zero if the reference is newer.
  double variance_at_fix_ = 0.0;
  double fix_stamp_ = 0.0;
  double chi2_ = 0.0, correction_ = 0.0;
  // The piece of the way that grows: its motion by wheels as they measure, and by vision up to its
  // newest reference; false: the wheels were silent in it.
  Eigen::Vector3d piece_by_wheels_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d piece_by_vision_ = Eigen::Vector3d::Zero();
  bool piece_known_ = false;
  std::deque<double> log_ratios_;
  double scale_sigma_ = 0.0;  // of the newest frame
};

}  // namespace prospect
