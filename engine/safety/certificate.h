// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/maps/belief.h"
#include "engine/maps/surface_drift.h"
#include "engine/maps/unknown_policy.h"
#include "engine/task/zone_map.h"
#include "models/motion_model.h"
#include "models/robot_description.h"
#include "models/robot_shape.h"

namespace prospect {

/// Verdict on one motion.
struct Certificate {
  enum class Status {
    kOk,
    kCollision,     ///< the grown body touches an occupied voxel
    kUnknownSpace,  ///< the body enters unknown space, which the policy forbids
    kUnseenFloor,   ///< the body enters ground whose floor no ray has met
    kOutOfView,     ///< nothing bounds the pose's error, and the body leaves what is in view
    kForbidden,     ///< the grown body enters a keep-out or leaves the bound
    kTooFast,       ///< it would drive faster than a slow zone allows
    kNotStopping,   ///< the stopping tail does not come to rest in time
    kNonFinite,     ///< a state or input is not finite, or of the wrong size
    kOverBudget     ///< given up after max_checks: nothing is known of the rest
  };
  Status status = Status::kNonFinite;
  double time = 0.0;   ///< [s] from the motion's start to the first offence; its duration if ok
  Pose pose;           ///< there
  int poses = 0;       ///< poses checked
  std::string detail;  ///< one sentence
  bool ok() const { return status == Status::kOk; }
};

/// Inputs that bring the base to rest: model.braking_input repeated from state x with input
/// u_previous in force, each for dt [s], until neither speed exceeds 1 mm/s or 1 mrad/s. nu x n, n
/// >= 1; after at most max_steps columns it gives up and returns those.
Eigen::MatrixXd stopping_tail(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& x,
                              const Eigen::Ref<const Eigen::VectorXd>& u_previous, double dt,
                              int max_steps = 100);

/// Exact check of a motion before it may be executed: FCL `collide` of the robot's true shape
/// against the boxes of the occupied voxels, along the fine trajectory.
///
/// Why the result covers the poses between those checked: the body is grown by `margin`, and poses
/// are spaced so that no point of the body moves more than min(2 margin, half a voxel) from one to
/// the next. Every pose in between is within `margin` of a checked one, so its true body lies
/// inside a grown body that was found free. Sub-steps are x(t) = f(x_k, u_k, t), so the nodes are
/// those of the plan.
///
/// Planar bases: only voxels that overlap `slice` count (the floor does not), as in ClearanceField;
/// bases that move in 3-D: all voxels.
///
/// Unknown space under kBlocked and kBraking: the motion checked (committed part and stopping tail)
/// may not touch unknown columns (planar: ground cells; 3-D: voxels), except those that the body
/// overlaps already at the start. No margin is applied there; the border of the known is no wall.
/// Free space counts as known once enough was seen of it: with l the octree's log-odds of the free
/// voxels of a column within the slice (3-D: of the voxel), each the sum of its looks,
///   1 / (1 + exp(-sum l)) <= max_doubt,
/// so what a single ray has passed once, at the edge of the range or of a view, may still turn out
/// to be occupied: the stop has to end before it. What the octree has nothing of is as the mirror
/// has it.
///
/// Floor. Where the ground map says that the body cannot be and nothing stands, there is no floor
/// (floor_state.h): a planar base takes it for an obstacle of its own height. With
/// Options::seen_floor it enters no ground either whose floor no ray has met, whatever the policy
/// on unknown space, but for what it covers at the start.
///
/// A robot that starts within its margin can leave, and may not come nearer: the body is grown by
/// `reduced_margin_share` times the largest c <= margin with which it touches nothing at the start
/// (found by bisection, to 0.1 mm). If even the true body touches voxels there, these are tolerated
/// as long as every move takes the body's centre away from the nearest point of each of them or
/// leaves it in place; a voxel not touched at the start is never tolerated, nor is one that was
/// left and is touched again.
///
/// Surfaces that may not be where the map has them (`drift`, surface_drift.h) are kept farther
/// away: with the shares a = 1/4, 1/2, 1, the body grown by margin + a drift_margin may not touch
/// columns of voxels with sigma >= a drift_margin; for a robot that starts nearer than that the
/// same as above, share by share. Space with sigma > drift_limit counts as unknown: what a robot
/// remembers as free must not be driven into sideways or backwards once the estimate has moved
/// against it; driving where it looks, it has just seen it.
///
/// A pose whose error nothing bounds (pose_error.h: the covariance is none, or localization is lost
/// with more than max_lost_error): the map does not tell what is beside or behind the robot. The
/// motion may enter only ground that a depth sensor has in view now (present_view.h), besides
/// what the body overlaps at the start; without a sensor, none. It may turn on the spot, whatever
/// its shape, obstacles permitting: that is how it looks about. No margin is applied, as for the
/// unknown.
///
/// What moves by itself (Belief::movers, movers.h). With gap(t) the signed distance, on the ground,
/// from the body at time t of the motion to the centre of a mover predicted for then, less its
/// reach: where gap < margin, the body may not come nearer to that place than it was at the pose
/// before. So a robot never drives into where somebody may be, may go out of somebody's way, and
/// may stand: it does not answer for who walks into it. Of bases that move in 3-D, too, at all
/// heights.
///
/// Zones (zone_map.h), in the map's frame (Belief::map_frame): the grown body may enter no
/// forbidden part, by the rule for obstacles; where B's origin is in a slow zone, or within half
/// the spacing of the poses of one, the linear speed may not exceed its limit (by more than 0.1
/// mm/s), stopping tail included. A robot that is too fast in one gets no certificate until it has
/// braked.
///
/// The octree's finest occupied cells are mirrored in belief.voxels; walking that mirror finds the
/// few boxes near the body faster than descending the octree.
///
/// Bounded time: what a check does is counted (voxels looked at, poses, calls of FCL, weighted as
/// they cost), and after max_checks it is given up as not certified. The count depends on the
/// arguments alone, so a verdict does not depend on the machine's load. A body that fits the free
/// space about it touches few boxes and stays far below; one that overlaps hundreds does not.
///
/// Thread-safety: const; may be called concurrently. Errors: certify() never throws; it reports.
/// Source: formulation, section 5; the covering argument and the escape rule are our choice.
class Certifier {
 public:
  struct Options {
    double margin = 0.01;  ///< by which the body is grown [m], > 0
    UnknownPolicy unknown = UnknownPolicy::kBraking;
    VerticalExtent slice = {0.1, 0.5};  ///< RobotDescription::slice(); planar bases only
    bool seen_floor = false;  ///< ground whose floor no ray has met is closed; planar bases only
    double step = 0.05;       ///< [m] HeightSlice::step of the maps
    double max_tail_time = 10.0;  ///< [s]; a tail that has not come to rest by then fails
    /// What a robot within its margin keeps of the distance it has, 0 to 1. With 1 it cannot creep
    /// up to things, with 0 it may do all but touch: for who checks once more what was certified
    /// before, from a slightly different pose (guard.h).
    double reduced_margin_share = 0.0;
    double drift_margin = 0.12;  ///< the most that is added to the margin for drift [m], >= 0
    double drift_limit = 0.12;   ///< drift beyond which space counts as unknown [m]; 0: none does
    /// Probability that known free space is occupied after all, beyond which it counts as unknown,
    /// above 0 to 0.5 (then none does). One look of OctoMap's usual model leaves 0.4, two 0.31.
    double max_doubt = 1.0 / 3.0;
    std::vector<DepthSensor> sensors{};  ///< of the robot; without one nothing is in view
    /// One-sigma error of the position [m] up to which a lost robot drives by its map; >= 0.
    double max_lost_error = 1.0;
    std::shared_ptr<const ZoneMap> zones{};  ///< null: none
    /// certify() asks that the map knows the ground of the motion (known_ground.h): for who takes
    /// unknown space for free because an older map was asked.
    bool known_ground = false;
    /// Elementary checks of one motion, > 0; docs/results/performance.md says how long they take.
    long long max_checks = 1'500'000;
  };

  /// The options that are facts of a robot, slice and sensors; the others as above.
  static Options options_for(const RobotDescription& robot);

  /// Throws std::invalid_argument for an invalid shape or options out of range.
  Certifier(const RobotShape& shape, Options options);
  ~Certifier();
  Certifier(Certifier&&) noexcept;
  Certifier& operator=(Certifier&&) noexcept;

  /// Checks the inputs (nu x n, n >= 0, each for dt [s]) from x0. drift: of the belief's surfaces;
  /// null: they are where the map has them.
  Certificate certify_inputs(const Belief& belief, const MotionModel& model,
                             const Eigen::Ref<const Eigen::VectorXd>& x0,
                             const Eigen::Ref<const Eigen::MatrixXd>& inputs, double dt,
                             const SurfaceDrift* drift = nullptr) const;

  /// Checks the committed inputs (nu x n) and the stopping tail that follows them; u_previous is
  /// the input in force at the start (used when n = 0).
  Certificate certify(const Belief& belief, const MotionModel& model,
                      const Eigen::Ref<const Eigen::VectorXd>& x0,
                      const Eigen::Ref<const Eigen::VectorXd>& u_previous,
                      const Eigen::Ref<const Eigen::MatrixXd>& committed, double dt,
                      const SurfaceDrift* drift = nullptr) const;

  /// Whether the true body (no margin) touches an occupied voxel at this pose; true for a pose that
  /// is not finite, or if max_checks did not suffice.
  bool in_collision(const Belief& belief, const Pose& pose, bool planar) const;

  const Options& options() const { return options_; }
  /// Other zones from now on; null: none. Not while another thread certifies.
  void set_zones(std::shared_ptr<const ZoneMap> zones) { options_.zones = std::move(zones); }
  /// Stages of a committed part that max_checks can pay for.
  int max_stages() const;

 private:
  struct Body;
  class Check;
  Options options_;
  std::unique_ptr<const Body> body_;
};

}  // namespace prospect
