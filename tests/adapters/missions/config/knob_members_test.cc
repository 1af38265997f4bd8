// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeinfo>
#include <vector>

#include "adapters/robots/gazebo/gazebo_options.h"
#include "adapters/robots/simulator/camera_rig.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/feature_camera.h"
#include "adapters/robots/simulator/kinematic_robot.h"
#include "adapters/robots/simulator/landmark_builder.h"
#include "adapters/robots/simulator/odometry_model.h"
#include "adapters/robots/simulator/simulated_base_options.h"
#include "adapters/robots/simulator/simulator_options.h"
#include "engine/behaviour/behaviour.h"
#include "engine/behaviour/monitors/progress_monitor.h"
#include "engine/features/visibility_prediction.h"
#include "engine/frontiers/cost_to_go_field.h"
#include "engine/frontiers/frontier_order.h"
#include "engine/frontiers/frontier_planner.h"
#include "engine/frontiers/frontier_utility.h"
#include "engine/frontiers/frontiers.h"
#include "engine/maps/traversability.h"
#include "engine/planner/planner.h"
#include "engine/safety/guard.h"
#include "engine/terms/visible_features.h"
#include "models/camera.h"
#include "models/holonomic.h"
#include "models/knobs.h"
#include "models/multirotor.h"
#include "models/robot_shape.h"
#include "models/unicycle.h"
#include "models/unicycle_accel.h"
#include "perception/fusion/inertial_witness.h"
#include "perception/fusion/scale_agreement.h"
#include "perception/fusion/wheel_fusion.h"
#include "perception/mapping/mover_tracker.h"
#include "perception/mapping/occupancy_mapper.h"
#include "perception/odometry/camera_time_offset.h"
#include "perception/odometry/corner_detector.h"
#include "perception/odometry/disparity_offset.h"
#include "perception/odometry/keyframe_policy.h"
#include "perception/odometry/motion_prior.h"
#include "perception/odometry/patch_tracker.h"
#include "perception/odometry/pose_estimation.h"
#include "perception/odometry/shared_errors.h"
#include "perception/odometry/stereo_matcher.h"
#include "perception/odometry/stereo_odometry.h"
#include "perception/odometry/track_survival.h"
#include "perception/pipeline/feature_density.h"
#include "perception/pipeline/perception_options.h"
#include "runtime/drive_options.h"
#include "runtime/mission.h"

// Every number and switch of the structures that a mission is set by is a knob of its own name. The
// bindings name
// all members, so a new member does not compile here until it is named; those that are left out of
// the lists are filled in by others (models/knobs.h), structures, which have a line of their own,
// or no numbers.
namespace prospect::knob_members_test {
namespace {

/// The names by which members are described, by their addresses.
class Names final : public Knobs {
 public:
  void number(const char* name, double& value, Range, const char*, const char*) override {
    of[&value] = name;
  }
  void degrees(const char* name, double& value, Range, const char*) override { of[&value] = name; }
  void integer(const char* name, int& value, WholeRange, const char*, const char*) override {
    of[&value] = name;
  }
  void boolean(const char* name, bool& value, const char*) override { of[&value] = name; }
  void numbers(const char* name, double* values, std::size_t, Range, const char*,
               const char*) override {
    of[values] = name;
  }
  void require(bool, const char*, const char*) override {}

  std::map<const void*, std::string> of;

 private:
  void word(const char*, std::size_t&, const std::vector<std::string>&, const char*) override {}
  void enter(const char*) override {}
  void leave() override {}
};

struct Member {
  std::string_view name;  ///< "lag", "delay.linear" of a structure that is described with it
  const void* address;
};

template <typename Options>
void expect_knobs(Options& options, std::initializer_list<Member> members) {
  Names names;
  describe(names, options);
  if constexpr (std::is_same_v<Options, FrontierPlannerOptions>) describe_end(names, options);
  for (const Member& member : members) {
    SCOPED_TRACE(std::string(typeid(Options).name()) + " " + std::string(member.name));
    const auto knob = names.of.find(member.address);
    if (knob == names.of.end()) {
      ADD_FAILURE() << "is no knob";
    } else {
      EXPECT_EQ(knob->second, member.name.substr(member.name.rfind('.') + 1));
    }
  }
}

// EXPECT_KNOBS(o, a, b.c): expect_knobs(o, {{"a", &o.a}, {"b.c", &o.b.c}}).
#define KNOBS_PARENTHESES ()
#define KNOBS_AGAIN(...) KNOBS_4(KNOBS_4(KNOBS_4(KNOBS_4(__VA_ARGS__))))
#define KNOBS_4(...) KNOBS_3(KNOBS_3(KNOBS_3(KNOBS_3(__VA_ARGS__))))
#define KNOBS_3(...) KNOBS_2(KNOBS_2(KNOBS_2(KNOBS_2(__VA_ARGS__))))
#define KNOBS_2(...) __VA_ARGS__
#define KNOBS_EACH(o, name, ...) \
  Member{#name, &o.name}, __VA_OPT__(KNOBS_REST KNOBS_PARENTHESES(o, __VA_ARGS__))
#define KNOBS_REST() KNOBS_EACH
#define EXPECT_KNOBS(o, ...) expect_knobs(o, {KNOBS_AGAIN(KNOBS_EACH(o, __VA_ARGS__))})

TEST(KnobMembers, EveryNumberAndSwitchIsAKnob) {
  {
    BehaviourOptions o;
    [[maybe_unused]] auto& [retreat_time, turn_time, retreat_pause, lost_patience, turn_away_time,
                            look_around] = o;
    EXPECT_KNOBS(o, retreat_time, turn_time, retreat_pause, lost_patience, look_around);
  }
  {
    ProgressMonitor::Options o;
    [[maybe_unused]] auto& [stalled_after, hopeless_after, distance, area, away] = o;
    EXPECT_KNOBS(o, stalled_after, hopeless_after, distance, area, away);
  }
  {
    TraversabilityOptions o;
    [[maybe_unused]] auto& [hard_radius, comfortable_radius, lattice_slack, tight_factor,
                            narrow_slack, narrow_factor, unknown_factor, body, free_moves, facing,
                            unknown_travel, extent, zones, top_speed] = o;
    EXPECT_KNOBS(o, lattice_slack, tight_factor, narrow_slack, narrow_factor, unknown_factor);
  }
  {
    FrontierOptions o;
    [[maybe_unused]] auto& [min_length, sensor_range, range_margin, rays, near_distance,
                            near_slope] = o;
    EXPECT_KNOBS(o, min_length, range_margin, rays, near_distance, near_slope);
  }
  {
    FrontierUtilityOptions o;
    [[maybe_unused]] auto& [depth, opening, failed_observation, failed_visit, visit_radius,
                            observation_interval, sensor_range, view_margin, sensor_fov, fov_margin,
                            renewal_cells, least_confidence, nearer, nearest] = o;
    EXPECT_KNOBS(o, depth, opening, failed_observation, failed_visit, visit_radius,
                 observation_interval, view_margin, fov_margin, renewal_cells, least_confidence,
                 nearer, nearest);
  }
  {
    FrontierOrderOptions o;
    [[maybe_unused]] auto& [patience, candidates, sequence_length] = o;
    EXPECT_KNOBS(o, patience, candidates, sequence_length);
  }
  {
    CostToGoOptions o;
    [[maybe_unused]] auto& [v_max, stop_beyond, fill_slope, window_radius, lambda,
                            features_required] = o;
    EXPECT_KNOBS(o, stop_beyond, fill_slope, window_radius, lambda);
  }
  {
    FrontierPlannerOptions o;
    [[maybe_unused]] auto& [traversability, frontiers, worth, order, cost_to_go, area, progress,
                            least_area, least_rate, observation_time, turn_time, observation_length,
                            reconsider, commitment, resolved, target_radius, closing_time, rule] =
        o;
    EXPECT_KNOBS(o, least_area, least_rate, observation_time, observation_length, reconsider,
                 commitment, resolved, target_radius, closing_time);
  }
  {
    OdometryNoise o;
    [[maybe_unused]] auto& [position_per_metre, position_per_radian, yaw_per_metre, yaw_per_radian,
                            reference_count, floor_count, scale] = o;
    EXPECT_KNOBS(o, position_per_metre, position_per_radian, yaw_per_metre, yaw_per_radian,
                 reference_count, floor_count, scale);
  }
  {
    VisibilityParameters o;
    [[maybe_unused]] auto& [sigma_px, border_px, border_sigma_px, r_min, r_max, r_min_width,
                            r_max_width, scale_min, scale_max, scale_width, view_angle,
                            view_angle_width, odometry] = o;
    EXPECT_KNOBS(o, sigma_px, border_px, border_sigma_px, r_min, r_max, r_min_width, r_max_width,
                 scale_min, scale_max, scale_width, view_angle, view_angle_width);
  }
  {
    VisibleFeaturesParameters o;
    [[maybe_unused]] auto& [criterion, N_req, beta, N_min, z, chance_beta, chance_weight,
                            required_translation, required_rotation, prior_translation,
                            prior_rotation, information_beta, rho] = o;
    EXPECT_KNOBS(o, N_req, beta, N_min, z, chance_beta, required_translation, required_rotation,
                 prior_translation, prior_rotation, information_beta);
  }
  {
    Guard::Options o;
    [[maybe_unused]] auto& [max_belief_age, max_pose_age, max_map_age, max_landmarks_age,
                            max_ranges_age, plan_slack, max_step, tolerance, mismatch] = o;
    EXPECT_KNOBS(o, max_belief_age, max_pose_age, max_map_age, max_landmarks_age, max_ranges_age,
                 plan_slack, max_step, tolerance, mismatch);
  }
  {
    PlannerParameters o;
    [[maybe_unused]] auto& [N, dt, M, weights, w_c, desired_speed, terms, terms_left_out, d_safe,
                            d_des, unknown, unseen_floor, step, certificate_margin, drift_margin,
                            drift_limit, lost_margin, committed, polished, polish_evaluations,
                            solver_options, threads, deadline, map_resolution, max_landmarks,
                            visibility_lattice, visibility, features, feature_prior,
                            feature_attenuation, feature_occlusion, feature_covariance, max_targets,
                            target_frontier_only, unknown_attenuation, frontier_planner, task,
                            zones, goal_unknown_price, return_unknown_price, behaviour] = o;
    auto& [w_u, w_du, w_o, w_l, w_e, w_T, w_h] = weights;
    EXPECT_KNOBS(o, N, dt, M, w_c, desired_speed, d_safe, d_des, certificate_margin, drift_margin,
                 drift_limit, lost_margin, committed, polished, polish_evaluations, threads,
                 deadline, max_landmarks, visibility_lattice, feature_prior, feature_attenuation,
                 feature_occlusion, feature_covariance, max_targets, target_frontier_only,
                 unknown_attenuation, goal_unknown_price, return_unknown_price);
    // Members are named as the terms, knobs as the symbols of the formulation (builtin_terms.cc).
    expect_knobs(o, {{"w_u", &w_u},
                     {"w_du", &w_du},
                     {"w_o", &w_o},
                     {"w_l", &w_l},
                     {"w_e", &w_e},
                     {"w_T", &w_T},
                     {"w_h", &w_h}});
  }
  {
    MissionOptions o;
    [[maybe_unused]] auto& [time_limit, lost_limit, missing, return_when_done, task, observers,
                            cancelled, truth] = o;
    EXPECT_KNOBS(o, time_limit, lost_limit, return_when_done);
  }
  {
    Unicycle::Parameters o;
    [[maybe_unused]] auto& [v_min, v_max, omega_max, a_max, alpha_max, fixed_z] = o;
    EXPECT_KNOBS(o, v_min, v_max, omega_max, a_max, alpha_max, fixed_z);
  }
  {
    UnicycleAccel::Parameters o;
    [[maybe_unused]] auto& [v_min, v_max, omega_max, a_max, alpha_max, fixed_z] = o;
    EXPECT_KNOBS(o, v_min, v_max, omega_max, a_max, alpha_max, fixed_z);
  }
  {
    Holonomic::Parameters o;
    [[maybe_unused]] auto& [vx_min, vx_max, vy_max, omega_max, a_max, alpha_max, fixed_z] = o;
    EXPECT_KNOBS(o, vx_min, vx_max, vy_max, omega_max, a_max, alpha_max, fixed_z);
  }
  {
    Multirotor::Parameters o;
    [[maybe_unused]] auto& [v_max, vz_max, a_max, az_max, omega_max, alpha_max] = o;
    EXPECT_KNOBS(o, v_max, vz_max, a_max, az_max, omega_max, alpha_max);
  }
  {
    PinholeCamera o;
    [[maybe_unused]] auto& [fx, fy, cx, cy, width, height] = o;
    EXPECT_KNOBS(o, fx, fy, cx, cy, width, height);
  }
  {
    StereoCamera o;
    [[maybe_unused]] auto& [left, baseline, sigma_u, sigma_v, sigma_d] = o;
    EXPECT_KNOBS(o, baseline, sigma_u, sigma_v, sigma_d);
  }
  {
    RgbdFootprint o;
    [[maybe_unused]] auto& [horizontal_fov, vertical_fov, min_range, max_range] = o;
    EXPECT_KNOBS(o, horizontal_fov, vertical_fov, min_range, max_range);
  }
  {
    Sphere o;
    [[maybe_unused]] auto& [center, radius] = o;
    EXPECT_KNOBS(o, center, radius);
  }
  {
    BoxShape o;
    [[maybe_unused]] auto& [center, size] = o;
    EXPECT_KNOBS(o, center, size);
  }
  {
    CylinderShape o;
    [[maybe_unused]] auto& [center, radius, height] = o;
    EXPECT_KNOBS(o, center, radius, height);
  }
  {
    CornerDetectorOptions o;
    [[maybe_unused]] auto& [cells, min_strength_over_noise, border] = o;
    EXPECT_KNOBS(o, cells, min_strength_over_noise, border);
  }
  {
    StereoMatcherOptions o;
    [[maybe_unused]] auto& [max_disparity, min_disparity, min_correlation, distinctness,
                            max_row_error, max_inconsistency] = o;
    EXPECT_KNOBS(o, max_disparity, min_disparity, min_correlation, distinctness, max_row_error,
                 max_inconsistency);
  }
  {
    PatchTrackerOptions o;
    [[maybe_unused]] auto& [min_texture, min_agreement, max_return, shift_per_level] = o;
    EXPECT_KNOBS(o, min_texture, min_agreement, max_return, shift_per_level);
  }
  {
    PoseEstimatorOptions o;
    [[maybe_unused]] auto& [sigma_left, sigma_right, ransac_hypotheses, ransac_confidence,
                            ransac_gate, final_gate, huber] = o;
    EXPECT_KNOBS(o, sigma_left, sigma_right, ransac_hypotheses, ransac_confidence, ransac_gate,
                 final_gate, huber);
  }
  {
    KeyframePolicyOptions o;
    [[maybe_unused]] auto& [min_points, max_shift, min_share, min_cells, max_sigma, significance] =
        o;
    EXPECT_KNOBS(o, min_points, max_shift, min_share, min_cells, max_sigma, significance);
  }
  {
    DisparityOffsetOptions o;
    [[maybe_unused]] auto& [prior_angle, walk_sigma, min_baseline, min_points, max_offset] = o;
    EXPECT_KNOBS(o, prior_angle, walk_sigma, min_baseline, min_points, max_offset);
  }
  {
    CameraTimeOffsetOptions o;
    [[maybe_unused]] auto& [prior_sigma, prior_rows, trust, memory, max_error] = o;
    EXPECT_KNOBS(o, prior_sigma, prior_rows, trust, memory, max_error);
  }
  {
    TrackSurvival::Options o;
    [[maybe_unused]] auto& [prior_loss, prior_views, memory] = o;
    EXPECT_KNOBS(o, prior_loss, prior_views, memory);
  }
  {
    CalibrationErrorOptions o;
    [[maybe_unused]] auto& [principal_point, focal_length, baseline] = o;
    EXPECT_KNOBS(o, principal_point, focal_length, baseline);
  }
  {
    SharedErrorOptions o;
    [[maybe_unused]] auto& [lasting, area, image, memory, left_right] = o;
    EXPECT_KNOBS(o, lasting, area, image, memory, left_right);
  }
  {
    MotionPriorOptions o;
    [[maybe_unused]] auto& [acceleration, turn_acceleration] = o;
    EXPECT_KNOBS(o, acceleration, turn_acceleration);
  }
  {
    StereoOdometryOptions o;
    [[maybe_unused]] auto& [corners, matching, tracking, pose, keyframes, disparity_offset,
                            time_offset, calibration, shared_errors, motion, survival,
                            pyramid_levels, sigma_corner, sigma_disparity, texture_noise, max_scale,
                            max_misses, lost_points, degraded_points, lost_share, degraded_share,
                            lost_right_share, degraded_right_share, max_sigma_position, max_speed,
                            max_turn_rate, max_acceleration, max_turn_acceleration, max_gap,
                            recovery_keyframes, restart_after, background_mapping, seed] = o;
    EXPECT_KNOBS(o, pyramid_levels, sigma_corner, sigma_disparity, texture_noise, max_scale,
                 max_misses, lost_points, degraded_points, lost_share, degraded_share,
                 lost_right_share, degraded_right_share, max_sigma_position, max_speed,
                 max_turn_rate, max_acceleration, max_turn_acceleration, max_gap,
                 recovery_keyframes, restart_after, background_mapping);
  }
  {
    ScaleAgreementOptions o;
    [[maybe_unused]] auto& [least, significance, least_samples] = o;
    EXPECT_KNOBS(o, least, significance, least_samples);
  }
  {
    WheelNoise o;
    [[maybe_unused]] auto& [along, across, turn, heading, sigma_scale] = o;
    EXPECT_KNOBS(o, along, across, turn, heading, sigma_scale);
  }
  {
    InertialOptions o;
    [[maybe_unused]] auto& [gyro_bias, bias_walk, gyro_noise, gyro_share, acceleration, gate,
                            max_gap] = o;
    EXPECT_KNOBS(o, gyro_bias, bias_walk, gyro_noise, gyro_share, acceleration, gate, max_gap);
  }
  {
    WheelFusionOptions o;
    [[maybe_unused]] auto& [noise, scale_walk, gate, slips, max_wheel_gap, unknown_speed, max_wait,
                            max_dead_reckoning, piece, pieces, agreement, start] = o;
    EXPECT_KNOBS(o, noise.along, scale_walk, gate, slips, max_wheel_gap, unknown_speed, max_wait,
                 max_dead_reckoning, piece, pieces);
  }
  {
    GroundPlaneOptions o;
    [[maybe_unused]] auto& [range, stride, score_stride, noise_constant, noise_quadratic,
                            unevenness, gate, confidence, most_draws, patch, min_share, most_below,
                            most_sigma_tilt, most_sigma_height, seed] = o;
    EXPECT_KNOBS(o, stride, score_stride, noise_constant, noise_quadratic, unevenness, gate,
                 confidence, most_draws, patch, min_share, most_below, most_sigma_tilt,
                 most_sigma_height);
  }
  {
    DepthMapperOptions o;
    [[maybe_unused]] auto& [map, range, mismatches, ground, tilt_tolerance, height_tolerance,
                            pose_sigma_tilt, pose_sigma_height, plane_sigma_tilt,
                            plane_sigma_height, floor_margin, most_margin, ray_spacing, edge,
                            least_valid, little_valid, most_rough, most_below_floor, max_speed,
                            max_turn_rate, max_gap] = o;
    EXPECT_KNOBS(o, tilt_tolerance, height_tolerance, pose_sigma_tilt, pose_sigma_height,
                 plane_sigma_tilt, plane_sigma_height, floor_margin, most_margin, ray_spacing, edge,
                 least_valid, little_valid, most_rough, most_below_floor, max_speed, max_turn_rate,
                 max_gap);
  }
  {
    ScanMapperOptions o;
    [[maybe_unused]] auto& [map, floor_margin, point_spacing, most_below_floor, max_speed,
                            max_turn_rate] = o;
    EXPECT_KNOBS(o, floor_margin, point_spacing, most_below_floor, max_speed, max_turn_rate);
  }
  {
    PerceptionOptions o;
    [[maybe_unused]] auto& [stereo_mount, depth_camera, more_depth_cameras, odometry, mapping,
                            depth_mapping, scan_mapping, movers, wheels, wheel_fusion, inertial,
                            feature_density, loops, poses_drift, start, start_floor, start_in_space,
                            same_time, max_age, max_leap, max_ahead, pose_degraded, pose_lost,
                            most_waiting] = o;
    EXPECT_KNOBS(o, wheels, loops, start_floor, same_time, max_age, max_leap, max_ahead,
                 pose_degraded, pose_lost, most_waiting);
  }
  {
    MoverTrackerOptions o;
    [[maybe_unused]] auto& [enabled, moved, stands_after, rests_after, largest, acceleration,
                            spread, keep] = o;
    EXPECT_KNOBS(o, enabled, moved, stands_after, rests_after, largest, acceleration, spread, keep);
  }
  {
    FeatureDensityOptions o;
    [[maybe_unused]] auto& [quantile, area, window, initial] = o;
    EXPECT_KNOBS(o, quantile, area, window, initial);
  }
  {
    OccupancyMapperOptions o;
    [[maybe_unused]] auto& [resolution, max_range, z_min, z_max, slice, probability_hit,
                            probability_miss, probability_min, probability_max, offset_constant,
                            offset_quadratic, core, slopes] = o;
    EXPECT_KNOBS(o, resolution, z_min, z_max, probability_hit, probability_miss, probability_min,
                 probability_max, offset_constant, offset_quadratic, core, slopes);
  }
  {
    ActuationNoise o;
    [[maybe_unused]] auto& [linear, angular, coupling] = o;
    EXPECT_KNOBS(o, linear, angular, coupling);
  }
  {
    OdometryOptions o;
    [[maybe_unused]] auto& [perfect, keyframe_distance, keyframe_angle, position_sigma,
                            heading_sigma, scale_error, direction_error, turn_error, lost_below,
                            degraded_below, reckoning_distance, reckoning_angle, reckoning_heading,
                            after_loss_position, after_loss_heading, after_loss_turning] = o;
    EXPECT_KNOBS(o, perfect, keyframe_distance, keyframe_angle, position_sigma, heading_sigma,
                 scale_error, direction_error, turn_error, lost_below, degraded_below,
                 reckoning_distance, reckoning_angle, reckoning_heading, after_loss_position,
                 after_loss_heading, after_loss_turning);
  }
  {
    DepthCameraOptions o;
    [[maybe_unused]] auto& [footprint, columns, rows, noise_constant, noise_quadratic, dropout] = o;
    EXPECT_KNOBS(o, noise_constant, noise_quadratic, dropout);
  }
  {
    FeatureCameraOptions o;
    [[maybe_unused]] auto& [stereo, min_depth, max_depth, max_view_angle, size, min_pixels, border,
                            cells] = o;
    EXPECT_KNOBS(o, min_depth, max_depth, max_view_angle, size, min_pixels, border, cells);
  }
  {
    LandmarkBuilderOptions o;
    [[maybe_unused]] auto& [max_landmarks, max_scale, max_view_change, survival_prior_tracked,
                            survival_prior_missed, cull_survival, cull_views, density] = o;
    EXPECT_KNOBS(o, max_landmarks, max_scale, max_view_change, survival_prior_tracked,
                 survival_prior_missed, cull_survival, cull_views);
  }
  {
    CameraRigOptions o;
    [[maybe_unused]] auto& [stereo, stereo_mount, footprint, depth_width, depth_height, depth_mount,
                            exposure, vignetting, blur, exposure_time, read_noise, shot_noise,
                            depth_noise_constant, depth_noise_quadratic, depth_dropout,
                            max_incidence, effects, threads, seed] = o;
    EXPECT_KNOBS(o, depth_width, depth_height, exposure, vignetting, blur, exposure_time,
                 read_noise, shot_noise, max_incidence, threads);
  }
  {
    CameraEffects o;
    [[maybe_unused]] auto& [focal_length, principal_point, baseline, rotation, mount, light,
                            exposure_lag, shutter, flicker, readout, glare, people, dirt,
                            floor_shine] = o;
    EXPECT_KNOBS(o, focal_length, principal_point, baseline, rotation, mount, light, exposure_lag,
                 shutter, flicker, readout, glare, people, dirt, floor_shine);
  }
  {
    CameraSensorsOptions o;
    [[maybe_unused]] auto& [rig, realism, effects, texture_quality, focal_error, baseline_error] =
        o;
    EXPECT_KNOBS(o, realism, effects.dirt, texture_quality, focal_error, baseline_error, rig.blur);
  }
  {
    SimulatedImuOptions o;
    [[maybe_unused]] auto& [rate, gyro_bias, gyro_noise, acceleration_bias, acceleration_noise] = o;
    EXPECT_KNOBS(o, rate, gyro_bias, gyro_noise, acceleration_bias, acceleration_noise);
  }
  {
    SimulatorOptions o;
    [[maybe_unused]] auto& [seed, sensors, shape, base_height, actuation, depth_mount, depth,
                            depth_rate, more_depth, stereo_mount, features, image_rate, odometry,
                            landmarks, wheels, imu, map, place_known, camera, walkers, corrections,
                            carried] = o;
    EXPECT_KNOBS(o, place_known, depth_rate, image_rate, walkers.count, walkers.keep);
  }
}

TEST(KnobMembers, EveryNumberAndSwitchOfDrivingIsAKnob) {
  {
    CommandLoopOptions o;
    [[maybe_unused]] auto& [period, hold, delay] = o;
    EXPECT_KNOBS(o, period, hold, delay.linear, delay.angular);
  }
  {
    DriveModeOptions o;
    [[maybe_unused]] auto& [live_time, rest_time, recover_time, stop_time, degraded_share,
                            lost_share, unchecked_share] = o;
    EXPECT_KNOBS(o, live_time, rest_time, recover_time, stop_time, degraded_share, lost_share,
                 unchecked_share);
  }
  {
    DriveWatchOptions o;
    [[maybe_unused]] auto& [max_silence, rest_speed, rest_rate, stray_speed, stray_rate, stray_time,
                            settle_time] = o;
    EXPECT_KNOBS(o, max_silence, rest_speed, rest_rate, stray_speed, stray_rate, stray_time,
                 settle_time);
  }
  {
    CommandFollowingOptions o;
    [[maybe_unused]] auto& [lag, slip, hold, least_speed, least_rate, gyro_bias, more_distance,
                            turn, less_distance] = o;
    EXPECT_KNOBS(o, lag, slip, hold, least_speed, least_rate, gyro_bias, more_distance, turn,
                 less_distance);
  }
  {
    DriverOptions o;
    [[maybe_unused]] auto& [command, mode, watch, following, replan_period, least_latency,
                            most_latency, perception_limit, planner_limit, command_limit,
                            priority] = o;
    EXPECT_KNOBS(o, command.period, mode.live_time, watch.max_silence, following.lag, replan_period,
                 least_latency, most_latency, perception_limit, planner_limit, command_limit,
                 priority);
  }
  {
    PreflightOptions o;
    [[maybe_unused]] auto& [height_warn, height_fail, tilt_warn, tilt_fail, stereo_warn,
                            stereo_fail, yaw_warn, yaw_fail, distance_warn, distance_fail,
                            floor_noise, longest_dead_man, live_time, least_turn, least_distance] =
        o;
    EXPECT_KNOBS(o, height_warn, height_fail, tilt_warn, tilt_fail, stereo_warn, stereo_fail,
                 yaw_warn, yaw_fail, distance_warn, distance_fail, floor_noise, longest_dead_man,
                 live_time, least_turn, least_distance);
  }
  {
    PreflightRunOptions o;
    [[maybe_unused]] auto& [checks, patience, turn, turn_rate, distance, speed, settle] = o;
    EXPECT_KNOBS(o, checks.live_time, patience, turn, turn_rate, distance, speed, settle);
  }
  {
    SensorInboxOptions o;
    [[maybe_unused]] auto& [pair_tolerance, capacity, wheel_capacity, max_image_age, max_wheel_age,
                            max_range_age, cameras_in_runtime_clock, wheels_in_runtime_clock,
                            depth_in_runtime_clock, scan_in_runtime_clock, poses_in_runtime_clock,
                            imu_in_runtime_clock, one_clock, clock_drift, pose_jump] = o;
    EXPECT_KNOBS(o, pair_tolerance, capacity, wheel_capacity, max_image_age, max_wheel_age,
                 max_range_age, cameras_in_runtime_clock, wheels_in_runtime_clock,
                 depth_in_runtime_clock, scan_in_runtime_clock, poses_in_runtime_clock,
                 imu_in_runtime_clock, one_clock, clock_drift);
  }
  {
    PoseJumpOptions o;
    [[maybe_unused]] auto& [distance, turn, speed, yaw_rate] = o;
    EXPECT_KNOBS(o, distance, turn);
  }
  {
    RangeStopOptions o;
    [[maybe_unused]] auto& [front, rear, left, right, corner_radius, lowest, highest, floor, drop,
                            margin, reaction_time, deceleration, yaw_deceleration, max_age,
                            least_points, least_valid, blind_speed] = o;
    EXPECT_KNOBS(o, front, rear, left, right, corner_radius, lowest, highest, floor, drop, margin,
                 reaction_time, deceleration, yaw_deceleration, max_age, least_points, least_valid,
                 blind_speed);
  }
  {
    DriveOptions o;
    [[maybe_unused]] auto& [driver, preflight, inbox, ranges] = o;
    EXPECT_KNOBS(o, driver.replan_period, preflight.turn, inbox.capacity, ranges.margin);
  }
  {
    SimulatedBaseOptions o;
    [[maybe_unused]] auto& [dead_man, delay, belief_period] = o;
    EXPECT_KNOBS(o, dead_man, delay, belief_period);
  }
  {
    GazeboOptions o;
    [[maybe_unused]] auto& [address, world, model, link, stereo, depth, depth_sensors, imu,
                            left_wheel, right_wheel, depth_width, image_noise, wheel_radius,
                            wheel_separation, turned_yaw, dead_man, period, silence, depth_range,
                            seed] = o;
    EXPECT_KNOBS(o, address.port, address.timeout, depth_width, image_noise, wheel_radius,
                 wheel_separation, turned_yaw, dead_man, period, silence);
  }
}

}  // namespace
}  // namespace prospect::knob_members_test
