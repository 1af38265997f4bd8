// SPDX-License-Identifier: Apache-2.0
// The descriptions of options, in a library of their own: reading a configuration builds nothing
// that acts on them.

#include <algorithm>
#include <limits>
#include <string>

#include "adapters/robots/simulator/camera_effects.h"
#include "adapters/robots/simulator/camera_rig_options.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/feature_camera.h"
#include "adapters/robots/simulator/kinematic_robot.h"
#include "adapters/robots/simulator/landmark_builder.h"
#include "adapters/robots/simulator/odometry_model.h"
#include "adapters/robots/simulator/simulated_base_options.h"
#include "adapters/robots/simulator/simulated_imu.h"
#include "adapters/robots/simulator/simulator_options.h"
#include "adapters/robots/simulator/walkers.h"
#include "models/depth_sensors.h"
#include "models/formatted.h"
#include "models/knobs.h"

namespace prospect {

void describe(Knobs& knobs, CameraRigOptions& o) {
  knobs.number("exposure", o.exposure, {0.0, 100.0}, "1", "gain on the grey levels");
  knobs.number("exposure_time", o.exposure_time, {0.0, 1.0}, "s", "motion blur of a turning robot");
  knobs.number("vignetting", o.vignetting, {0.0, 1.0}, "1", "share of light lost in the corners");
  knobs.number("blur", o.blur, {0.0, 20.0}, "px", "of the lens, one standard deviation");
  knobs.number("read_noise", o.read_noise, {0.0, 255.0}, "1",
               "grey levels, one standard deviation");
  knobs.number("shot_noise", o.shot_noise, {0.0, 255.0}, "1", "variance a grey level");
  knobs.integer("depth_width", o.depth_width, {1, 16384}, "px", "of the depth image");
  knobs.integer("depth_height", o.depth_height, {1, 16384}, "px", "of the depth image");
  knobs.number("max_incidence", o.max_incidence, {0.0, 1.6}, "rad",
               "between ray and surface normal; beyond, no depth is measured");
  knobs.integer("threads", o.threads, {1, 256}, "1", "of the renderer; the same bits with any");
}

void describe(Knobs& knobs, CameraEffects& o) {
  knobs.number("focal_length", o.focal_length, {0.0, 0.1}, "1",
               "error of the calibration, drawn for a mission, share of itself");
  knobs.number("principal_point", o.principal_point, {0.0, 50.0}, "px",
               "likewise, each coordinate, of both cameras alike");
  knobs.number("baseline", o.baseline, {0.0, 0.1}, "1",
               "likewise; also of the lengths that the depth camera measures");
  knobs.degrees("rotation", o.rotation, {0.0, 2.0},
                "likewise, of the right camera against the left, each axis");
  knobs.degrees("mount", o.mount, {0.0, 5.0}, "likewise, of each camera against the body");
  knobs.number("light", o.light, {0.0, 1.0}, "1",
               "log brightness of places and directions, one standard deviation");
  knobs.number("exposure_lag", o.exposure_lag, {0.0, 60.0}, "s",
               "in which the exposure follows the light; 0: it does not");
  knobs.number("shutter", o.shutter, {0.0, 0.3}, "s",
               "exposure in mean light, for motion blur and flicker");
  knobs.number("flicker", o.flicker, {0.0, 1.0}, "1", "of lamps, share of their light");
  knobs.number("readout", o.readout, {0.0, 1.0}, "s",
               "from the first row's exposure to the last's");
  knobs.number("glare", o.glare, {0.0, 255.0}, "1", "grey levels of stray light near the window");
  knobs.number("people", o.people, {0.0, 20.0}, "1/(100 m2)", "who walk");
  knobs.number("dirt", o.dirt, {0.0, 0.3}, "1", "share of light that a spot on the lens takes");
  knobs.number("floor_shine", o.floor_shine, {0.0, 0.3}, "1",
               "share of light that the floor mirrors, straight down");
}

void describe(Knobs& knobs, DepthCameraOptions& o) {
  knobs.number("noise_constant", o.noise_constant, {0.0, 1.0}, "m",
               "error of a range, one standard deviation");
  knobs.number("noise_quadratic", o.noise_quadratic, {0.0, 1.0}, "1/m",
               "the same, times the squared depth");
  knobs.number("dropout", o.dropout, {0.0, 1.0}, "1", "probability that a ray measures nothing");
}

void describe(Knobs& knobs, FeatureCameraOptions& o) {
  knobs.number("min_depth", o.min_depth, {0.01, 1000.0}, "m", "nearest at which one is tracked");
  knobs.number("max_depth", o.max_depth, {0.01, 1000.0}, "m", "farthest at which one is tracked");
  knobs.require(o.max_depth > o.min_depth, "max_depth", "max_depth <= min_depth; expected more");
  knobs.number("max_view_angle", o.max_view_angle, {0.01, 1.57}, "rad",
               "between the surface's normal and the line of sight");
  knobs.number("size", o.size, {0.001, 10.0}, "m", "of a feature");
  knobs.number("min_pixels", o.min_pixels, {0.0, 1e4}, "px",
               "of its shorter side in the image; less: not tracked");
  knobs.number("border", o.border, {0.0, 1e4}, "px", "without features along the images' edges");
  knobs.integer("cells", o.cells, {1, 1000000}, "1",
                "that the image is divided into: a feature each");
}

void describe(Knobs& knobs, ActuationNoise& o) {
  knobs.number("linear", o.linear, {0.0, 1.0}, "sqrt(s)", "noise of the distance");
  knobs.number("angular", o.angular, {0.0, 1.0}, "sqrt(s)", "noise of the angle");
  knobs.number("coupling", o.coupling, {0.0, 1.0}, "rad sqrt(s)/m",
               "noise of the heading from driving");
}

void describe(Knobs& knobs, LandmarkBuilderOptions& o) {
  knobs.integer("max_landmarks", o.max_landmarks, {1, 1000000}, "1",
                "in the map; beyond, the least surviving are dropped");
  knobs.number("max_scale", o.max_scale, {1.001, 100.0}, "1",
               "a landmark seen this much nearer or farther is detected again");
  knobs.number("max_view_change", o.max_view_change, {0.001, 10.0}, "rad",
               "likewise from another direction");
  knobs.number("survival_prior_tracked", o.survival_prior_tracked, {0.001, 1e6}, "1",
               "views in which a new landmark counts as tracked");
  knobs.number("survival_prior_missed", o.survival_prior_missed, {0.001, 1e6}, "1",
               "views in which it counts as missed");
  knobs.number("cull_survival", o.cull_survival, {0.0, 0.99}, "1",
               "share of views below which a landmark is dropped");
  knobs.integer("cull_views", o.cull_views, {1, 1000000}, "1", "after so many expected views");
}

void describe(Knobs& knobs, OdometryOptions& o) {
  knobs.boolean("perfect", o.perfect, "the estimate is the truth");
  knobs.number("keyframe_distance", o.keyframe_distance, {0.001, 100.0}, "m",
               "driven between two keyframes");
  knobs.number("keyframe_angle", o.keyframe_angle, {0.001, 10.0}, "rad",
               "turned between two keyframes");
  knobs.number("position_sigma", o.position_sigma, {0.0, 1.0}, "m",
               "error of a keyframe at 200 points");
  knobs.number("heading_sigma", o.heading_sigma, {0.0, 1.0}, "rad",
               "error of a keyframe at 200 points");
  knobs.number("scale_error", o.scale_error, {0.0, 0.3}, "1",
               "of the length of all motions, drawn for a mission");
  knobs.number("direction_error", o.direction_error, {0.0, 0.3}, "rad",
               "likewise of their direction in the body");
  knobs.number("turn_error", o.turn_error, {0.0, 0.3}, "1", "likewise, share of the angle turned");
  knobs.integer("lost_below", o.lost_below, {0, 10000}, "1", "tracked points: lost");
  knobs.integer("degraded_below", o.degraded_below, {0, 10000}, "1", "tracked points: degraded");
  knobs.require(o.degraded_below >= o.lost_below, "degraded_below",
                "degraded_below < lost_below; expected at least as many");
  knobs.number("reckoning_distance", o.reckoning_distance, {0.0, 1.0}, "1",
               "error of the wheels while lost, share of the distance");
  knobs.number("reckoning_angle", o.reckoning_angle, {0.0, 1.0}, "1",
               "error of the wheels while lost, share of the angle");
  knobs.number("reckoning_heading", o.reckoning_heading, {0.0, 1.0}, "rad/m",
               "error of the wheels while lost, of the heading");
  knobs.number("after_loss_position", o.after_loss_position, {0.0, 1.0}, "m/sqrt(rad)",
               "error of the position that turning adds after a loss");
  knobs.number("after_loss_heading", o.after_loss_heading, {0.0, 1.0}, "rad/sqrt(rad)",
               "error of the heading that turning adds after a loss");
  knobs.number("after_loss_turning", o.after_loss_turning, {0.01, 1e4}, "rad",
               "of turning after which these have fallen to 1/e");
}

void describe(Knobs& knobs, CameraSensorsOptions& o) {
  knobs.number("texture_quality", o.texture_quality, {0.0, 1.0}, "1",
               "contrast of surfaces, 0 blank to 1 rich");
  knobs.number("focal_error", o.focal_error, {-0.9, 9.0}, "1",
               "by which the stereo pair's focal length is believed too large");
  knobs.number("baseline_error", o.baseline_error, {-0.9, 9.0}, "1",
               "by which its baseline is believed too large");
  describe(knobs, o.rig);
  knobs.number("realism", o.realism, {0.0, 3.0}, "1",
               "times all of effects: 0 ideal cameras in an empty world, 1 as real ones");
  knobs.group("effects", [&] { describe(knobs, o.effects); });
}

void describe(Knobs& knobs, WalkersOptions& o) {
  knobs.integer("count", o.count, {0, 1000}, "1", "people who walk about");
  knobs.number("keep", o.keep, {0.0, 10.0}, "m",
               "to the robot's middle, within which they go no nearer to it");
}

void describe(Knobs& knobs, SimulatedImuOptions& o) {
  knobs.number("rate", o.rate, {0.0, 1000.0}, "1/s", "samples; 0: the robot has no IMU");
  knobs.number("gyro_bias", o.gyro_bias, {0.0, 1.0}, "rad/s",
               "of each axis, one standard deviation, drawn for a mission");
  knobs.number("gyro_noise", o.gyro_noise, {0.0, 1.0}, "rad/s",
               "of a sample, one standard deviation");
  knobs.number("acceleration_bias", o.acceleration_bias, {0.0, 10.0}, "m/s2",
               "of each axis, one standard deviation, drawn for a mission");
  knobs.number("acceleration_noise", o.acceleration_noise, {0.0, 10.0}, "m/s2",
               "of a sample, one standard deviation");
}

void describe(Knobs& knobs, SimulatorOptions& o) {
  knobs.choice("sensors", o.sensors, {"model", "camera"},
               "odometry as a model of its errors, or rendered images through perception");
  knobs.boolean("place_known", o.place_known,
                "where the robot starts in `simulator.map`; else it looks for its place");
  knobs.number("depth_rate", o.depth_rate, {0.1, 1000.0}, "1/s", "depth images");
  knobs.number("image_rate", o.image_rate, {0.1, 1000.0}, "1/s", "stereo images");
  knobs.group("actuation", [&] { describe(knobs, o.actuation); });
  knobs.group("odometry", [&] { describe(knobs, o.odometry); });
  knobs.group("depth", [&] { describe(knobs, o.depth); });
  knobs.group("features", [&] { describe(knobs, o.features); });
  knobs.group("landmarks", [&] { describe(knobs, o.landmarks); });
  knobs.group("wheels", [&] { describe(knobs, o.wheels); });
  knobs.group("imu", [&] { describe(knobs, o.imu); });
  knobs.group("camera", [&] { describe(knobs, o.camera); });
  knobs.group("walkers", [&] { describe(knobs, o.walkers); });
}

PerceptionOptions simulated_perception(const SimulatorOptions& options) {
  PerceptionOptions perception;
  perception.wheel_fusion.noise = options.wheels;
  perception.max_ahead = std::numeric_limits<double>::infinity();
  const CameraEffects effects = scaled(options.camera.effects, options.camera.realism);
  const auto at_least = [](double& sigma, double drawn) { sigma = std::max(sigma, drawn); };
  CalibrationErrorOptions& calibration = perception.odometry.calibration;
  at_least(calibration.principal_point, effects.principal_point);
  at_least(calibration.focal_length, effects.focal_length);
  at_least(calibration.baseline, effects.baseline);
  at_least(perception.odometry.disparity_offset.prior_angle, 1e3 * effects.rotation);
  return perception;
}

OccupancyMapperOptions mapping_options(const SimulatorOptions& options,
                                       OccupancyMapperOptions mapping) {
  const VerticalExtent slice = body_slice(options.shape, options.base_height);
  mapping.slice.z_min = slice.z_min;
  mapping.slice.z_max = slice.z_max;
  mapping.slice.sight = options.base_height + options.depth_mount.T_BC.translation().z();
  mapping.max_range = longest_range(options.depth.footprint.max_range, options.more_depth);
  return mapping;
}

std::string simulator_misfit(const SimulatorOptions& options, const OccupancyMapperOptions& map) {
  const OccupancyMapperOptions mapping = mapping_options(options, map);
  // What is not mapped at the heights of the body could be driven into.
  if (!(mapping.slice.z_min >= mapping.z_min && mapping.slice.z_max <= mapping.z_max)) {
    return formatted(
        "the body is at heights from %.4g to %.4g m; expected it between perception.mapping.z_min, "
        "%.4g m, and z_max, %.4g m, the heights that are mapped",
        mapping.slice.z_min, mapping.slice.z_max, mapping.z_min, mapping.z_max);
  }
  if (const std::string range = range_misfit(mapping); !range.empty()) {
    return "robot.depth." + range;
  }
  const std::string layers = layers_misfit(mapping);
  return layers.empty() ? "" : "perception.mapping." + layers;
}

void describe(Knobs& knobs, SimulatedBaseOptions& o) {
  knobs.number("dead_man", o.dead_man, {0.01, 10.0}, "s",
               "of silence after which the base stops by itself");
  knobs.number("delay", o.delay, {0.0, 2.0}, "s", "from a command to when it acts");
  knobs.number("belief_period", o.belief_period, {0.01, 1.0}, "s", "from one belief to the next");
}

}  // namespace prospect
