// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/camera_sensors.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <variant>

#include "adapters/robots/simulator/depth_cameras.h"
#include "adapters/robots/simulator/feature_field.h"
#include "adapters/robots/simulator/known_free.h"
#include "adapters/robots/simulator/noise_stream.h"
#include "adapters/robots/simulator/scene_renderer.h"
#include "adapters/robots/simulator/world_mesh.h"
#include "models/mixed_bits.h"
#include "models/parameter_check.h"
#include "models/sinc.h"

namespace prospect {
namespace {

CameraEffects effects_of(const SimulatorOptions& options) {
  return scaled(options.camera.effects, options.camera.realism);
}

std::shared_ptr<const SceneRenderer> scene_of(const World& world, const SimulatorOptions& options) {
  SceneRendererOptions scene;
  scene.floor_shine = std::min(effects_of(options).floor_shine, 1.0);
  if (world.mesh) {
    scene.texture_contrast = options.camera.texture_quality;
    return std::make_shared<const SceneRenderer>(*world.mesh, scene);
  }
  return std::make_shared<const SceneRenderer>(seen_mesh(world, options), scene);
}

CameraRigOptions rig_of(const SimulatorOptions& options) {
  CameraRigOptions rig = options.camera.rig;
  rig.stereo = options.features.stereo;
  rig.stereo_mount = options.stereo_mount;
  rig.footprint = options.depth.footprint;
  rig.depth_mount = options.depth_mount;
  rig.depth_noise_constant = options.depth.noise_constant;
  rig.depth_noise_quadratic = options.depth.noise_quadratic;
  rig.depth_dropout = options.depth.dropout;
  rig.effects = effects_of(options);
  rig.seed = stream_seed(options.seed, NoiseStream::kImages);
  return rig;
}

/// Of the depth cameras besides the first, in its scene, by their number.
std::map<int, CameraRig> more_rigs(const CameraRig& first, const SimulatorOptions& options) {
  std::map<int, CameraRig> rigs;
  int number = 0;
  for (const DepthSensor& sensor : options.more_depth) {
    ++number;
    if (!is_rendered(sensor.footprint)) continue;
    CameraRigOptions rig = first.options();
    rig.footprint = sensor.footprint;
    rig.depth_mount = sensor.mount;
    rig.seed = mixed_bits(rig.seed + static_cast<std::uint64_t>(number));
    rigs.emplace(number, CameraRig(first.scene(), rig));
  }
  return rigs;
}

/// The stereo pair as the robot takes it to be.
StereoCamera believed(const SimulatorOptions& options) {
  const CameraSensorsOptions& errors = options.camera;
  StereoCamera camera = options.features.stereo;
  camera.left.fx *= 1.0 + errors.focal_error;
  camera.left.fy *= 1.0 + errors.focal_error;
  camera.baseline *= 1.0 + errors.baseline_error;
  return camera;
}

/// `perception`, with what the robot has.
PerceptionOptions perception_of(const SimulatorOptions& options, PerceptionOptions perception,
                                const PinholeCamera& depth_camera,
                                const std::map<int, CameraRig>& more, const Pose& start) {
  perception.stereo_mount = options.stereo_mount;
  perception.depth_mapping.range = {options.depth.footprint.min_range,
                                    options.depth.footprint.max_range};
  // The map may reach farther than the first camera.
  perception.depth_camera = {depth_camera, options.depth_mount, perception.depth_mapping.range};
  for (const auto& [sensor, rig] : more) {
    const RgbdFootprint& f = rig.options().footprint;
    perception.more_depth_cameras[sensor] = {rig.depth_camera(), rig.options().depth_mount,
                                             DepthRange{f.min_range, f.max_range}};
  }
  perception.start = start;
  return perception;
}

}  // namespace

TexturedMesh seen_mesh(const World& world, const SimulatorOptions& options) {
  if (world.mesh) return *world.mesh;
  WorldMeshOptions mesh;
  mesh.texture_quality = options.camera.texture_quality;
  mesh.seed = stream_seed(options.seed, NoiseStream::kTexture);
  return world_mesh(world, simulated_features(world, options.seed), mesh);
}

CameraSensors::CameraSensors(const World& world, const SimulatorOptions& options,
                             const PerceptionOptions& perception, const Pose& start,
                             const std::vector<Disc>& known_free)
    : options_(options),
      rig_(scene_of(world, options), rig_of(options)),
      more_(more_rigs(rig_, options)),
      looking_(depth_cameras(world, options)),
      exposure_(rig_.options().effects.exposure_lag),
      people_(stream_seed(options.seed, NoiseStream::kPeople)),
      has_wheels_(perception.wheels),
      perception_(believed(options),
                  perception_of(options, perception, rig_.depth_camera(), more_, start)),
      wheel_noise_(stream_seed(options.seed, NoiseStream::kWheels)),
      wheel_pose_(start) {
  if (!world.slopes.empty()) {
    throw std::invalid_argument("world '" + world.name + "': ramps are for the kinematic fidelity");
  }
  if (options.map) {
    perception_.map().load(*options.map);
    check_parameter(perception_.give_map(options.place_known), "simulator", "place_known", 0.0,
                    "with perception.loops, built with Ceres");
  }
  free_height_ = perception.mapping.slice.z_max - start.position.z();
  clear_free(perception_.map(), known_free, start.position.z(), free_height_);
  perception_.map().assume_floor(start.position.head<2>(), perception.start_floor);
  std::normal_distribution<double> normal;
  wheel_scale_ += options.wheels.sigma_scale * normal(wheel_noise_);
  turn_scale_ += options.wheels.sigma_scale * normal(wheel_noise_);
}

WheelSample CameraSensors::wheels(double stamp, const Pose& true_pose) {
  const WheelNoise& errors = options_.wheels;
  const double dt = stamp - wheel_stamp_;
  const double turn = std::remainder(true_pose.yaw - wheel_pose_.yaw, 2.0 * M_PI);
  // p' = p + dt sinc(turn / 2) R(yaw + turn / 2) v
  const Eigen::Vector2d v = Eigen::Rotation2Dd(-(wheel_pose_.yaw + 0.5 * turn)) *
                            (true_pose.position - wheel_pose_.position).head<2>() /
                            (dt * sinc(0.5 * turn));
  const double speed = v.norm(), w = turn / dt;
  std::normal_distribution<double> normal;
  const double noise_along = normal(wheel_noise_), noise_across = normal(wheel_noise_),
               noise_turn = normal(wheel_noise_);
  const double root = std::sqrt(speed / dt);
  const Eigen::Vector2d forward = speed > 0.0 ? Eigen::Vector2d(v / speed) : Eigen::Vector2d(1, 0);
  const Eigen::Vector2d aside(-forward.y(), forward.x());
  WheelSample sample;
  sample.stamp = stamp;
  sample.velocity =
      (v + root * (errors.along * noise_along * forward + errors.across * noise_across * aside)) /
      wheel_scale_;
  sample.yaw_rate = (w + std::sqrt((errors.turn * errors.turn * std::abs(w) +
                                    errors.heading * errors.heading * speed) /
                                   dt) *
                             noise_turn) /
                    turn_scale_;
  wheel_stamp_ = stamp;
  wheel_pose_ = true_pose;
  return sample;
}

void CameraSensors::image(double stamp, const Pose& true_pose, const Twist& twist) {
  const bool was_lost = images_ > 0 && localization() == Localization::kLost;
  const ImageMoment moment{images_++, stamp, exposure_.exposure(), twist.yaw_rate};
  ImagePair images = rig_.stereo(true_pose, moment, people_.of(walkers()));
  exposure_.measured(stamp, images.left);
  pair_ = {stamp, stamp, std::make_shared<const Image>(std::move(images.left)),
           std::make_shared<const Image>(std::move(images.right))};
  deliver(pair_);
  if (stamp > wheel_stamp_ && has_wheels_) {
    const WheelSample sample = wheels(stamp, true_pose);
    deliver(sample);
    perception_.wheels(sample);
  }
  perception_.stereo({stamp, stamp, pair_.left->view(), pair_.right->view()});
  losses_ += localization() == Localization::kLost && !was_lost;
}

Pose CameraSensors::estimate(double stamp, const Pose&) const { return perception_.pose(stamp); }

void CameraSensors::scan(double stamp, const Pose& true_pose, SeenArea& seen) {
  const std::uint64_t number = scans_++;
  const std::span<const Person> others = people_.of(walkers());
  const auto measured = [&](const SensorFrame& frame) {
    deliver(frame);
    if (enters_ranges_) enter(stamp, frame);
  };
  for (std::size_t n = 0; n < looking_.size(); ++n) {
    const auto sensor = static_cast<int>(n);
    DepthScan rays = seen.look(looking_[n], true_pose, walkers());
    const auto more = more_.find(sensor);
    if (n > 0 && more == more_.end()) {
      measured(
          ScanFrame{stamp, std::make_shared<const DepthScan>(std::move(rays)), nullptr, sensor});
    } else {
      const CameraRig& rig = n == 0 ? rig_ : more->second;
      measured(DepthFrame{
          stamp, std::make_shared<const DepthImage>(rig.depth(true_pose, number, others)), sensor});
    }
  }
}

void CameraSensors::imu(const ImuSample& sample) {
  if (enters_ranges_) perception_.imu(sample);
}

void CameraSensors::enter(double stamp, const SensorFrame& ranges) {
  if (const auto* depth = std::get_if<DepthFrame>(&ranges)) {
    perception_.depth(stamp, *depth->image, depth->sensor);
  } else if (const auto* scan = std::get_if<ScanFrame>(&ranges)) {
    perception_.scan(stamp, *scan->in_B, scan->sensor);
  } else if (const auto* sample = std::get_if<ImuSample>(&ranges)) {
    ImuSample then = *sample;
    then.stamp = stamp;
    perception_.imu(then);
  }
}

void CameraSensors::carry(const Pose&, const Pose& true_pose, const std::vector<Disc>& known_free) {
  wheel_pose_ = true_pose;  // wheels do not turn meanwhile
  perception_.lift();
  const Pose now = perception_.pose(wheel_stamp_);
  clear_free(perception_.map(), known_free, now.position.z(), free_height_,
             move_between(true_pose, now));
}

void CameraSensors::correct(const Correction& correction, const Pose&) {
  perception_.correct(correction);
}

PlanarMove CameraSensors::origin() const {
  return perception_.straight_map() ? perception_.straight_map()->origin() : PlanarMove{};
}

std::shared_ptr<const Belief> CameraSensors::belief(double stamp, const Pose&, const Twist&) {
  return perception_.belief(stamp);
}

CameraPicture CameraSensors::picture() const {
  return {pair_.left, perception_.odometry().sightings()};
}

}  // namespace prospect
