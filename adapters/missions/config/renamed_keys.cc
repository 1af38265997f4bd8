// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/renamed_keys.h"

namespace prospect {

const std::vector<RenamedKey>& renamed_keys() {
  // What wheels really do was said where the fusion is told of it, which follows it now.
  static const std::vector<RenamedKey> keys = {
      {"simulator.camera.wheel_fusion.along", "simulator.wheels.along"},
      {"simulator.camera.wheel_fusion.across", "simulator.wheels.across"},
      {"simulator.camera.wheel_fusion.turn", "simulator.wheels.turn"},
      {"simulator.camera.wheel_fusion.heading", "simulator.wheels.heading"},
      {"simulator.camera.wheel_fusion.sigma_scale", "simulator.wheels.sigma_scale"},
      {"simulator.camera.wheel_fusion", "perception.wheel_fusion"},
      {"simulator.camera.wheels", "perception.wheels"},
      {"simulator.camera.odometry", "perception.odometry"},
      {"simulator.camera.depth_mapping", "perception.depth_mapping"},
      {"simulator.camera.feature_density", "perception.feature_density"},
      {"simulator.landmarks.density", "perception.feature_density"},
      {"simulator.loops", "perception.loops"},
      {"simulator.mapping", "perception.mapping"},
      {"simulator.map_resolution", "perception.mapping.resolution"},
      {"drive.odometry", "perception.odometry"},
      {"drive.perception", "perception"},
      {"planner.recovery.time", "planner.recovery.retreat_time"},
      {"planner.recovery.turn", "planner.recovery.turn_time"},
      {"planner.recovery.pause", "planner.recovery.retreat_pause"},
      {"planner.recovery.patience", "planner.recovery.lost_patience"},
      {"planner.visibility.prior", "planner.visibility.feature_prior"},
      {"planner.visibility.lattice", "planner.visibility.visibility_lattice"},
      {"planner.visibility.attenuation", "planner.visibility.unknown_attenuation"},
      {"planner.visibility.occlusion", "planner.visibility.feature_occlusion"},
      {"planner.visibility.covariance", "planner.visibility.feature_covariance"},
      {"planner.frontiers.failed_look", "planner.frontiers.failed_observation"},
      {"planner.frontiers.look_interval", "planner.frontiers.observation_interval"},
      {"planner.frontiers.look_margin", "planner.frontiers.view_margin"},
      {"planner.frontiers.least_trust", "planner.frontiers.least_confidence"},
      {"planner.frontiers.look_time", "planner.frontiers.observation_time"},
      {"planner.frontiers.look_length", "planner.frontiers.observation_length"},
      {"drive.following.more_way", "drive.following.more_distance"},
      {"drive.following.less_way", "drive.following.less_distance"},
      {"drive.preflight.checks.way_warn", "drive.preflight.checks.distance_warn"},
      {"drive.preflight.checks.way_fail", "drive.preflight.checks.distance_fail"},
      {"drive.preflight.checks.least_way", "drive.preflight.checks.least_distance"},
      {"drive.preflight.way", "drive.preflight.distance"},
      {"drive.preflight.way_speed", "drive.preflight.speed"},
      {"mission.return", "mission.return_when_done"},
  };
  return keys;
}

const std::vector<GoneKey>& gone_keys() {
  static const std::vector<GoneKey> keys = {
      {"perception.odometry.disparity_offset.prior_sigma", "0.3",
       "perception.odometry.disparity_offset.prior_angle is the same over the focal length, in "
       "mrad"},
      {"perception.odometry.disparity_offset.trust", "0.5",
       "perception.odometry.shared_errors says what errors share"},
      {"perception.odometry.corners.min_strength", "3",
       "perception.odometry.corners.min_strength_over_noise is the same over the variance of the "
       "image's noise"},
      {"planner.frontiers.horizon", "20",
       "planner.frontiers.patience is the same in seconds, so that turning and observing count"},
      {"planner.frontiers.every_observation", "0.3",
       "planner.frontiers.observation_time says what an observation costs"},
  };
  return keys;
}

}  // namespace prospect
