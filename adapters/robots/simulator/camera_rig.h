// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "adapters/robots/simulator/camera_effects.h"
#include "adapters/robots/simulator/camera_rig_options.h"
#include "adapters/robots/simulator/image_sensor.h"
#include "adapters/robots/simulator/people.h"
#include "adapters/robots/simulator/scene_renderer.h"
#include "models/camera.h"
#include "models/image.h"
#include "models/types.h"
#include "perception/mapping/depth_image.h"

namespace prospect {

/// Whether an image in perspective holds it: 1 to 170 degrees wide and high.
bool is_rendered(const RgbdFootprint& footprint);

/// Pinhole camera of width x height pixels that sees the footprint's field of view:
///   fx = (width / 2) / tan(horizontal_fov / 2),  cx = (width - 1) / 2;  likewise fy, cy.
PinholeCamera depth_camera(const RgbdFootprint& footprint, int width, int height);

/// The cameras of the robot in a textured scene: a rectified stereo pair and a depth camera, with
/// what is imperfect in real ones.
///
/// Where they are wrong by effects (camera_effects.h), options() and depth_camera() are what the
/// robot believes in; images are those of the true cameras.
///
/// Grey images: the renderer's grey, people in it, through an ImageSensor.
/// Depth: z of the pixel's own ray, times the error of its length (CameraEffects::baseline), plus
/// noise; NaN by drop-out, where the range along the ray is outside the footprint's, where the
/// surface is met at a grazing angle, and where there is none.
///
/// Noise is a function of (seed, frame, camera, pixel), as ImageSensor's. Immutable: concurrent
/// calls are safe.
class CameraRig {
 public:
  /// Throws std::invalid_argument on options out of range, or without a renderer.
  CameraRig(std::shared_ptr<const SceneRenderer> scene, const CameraRigOptions& options);

  /// The pair of frame number `frame`, from the true pose of the body that moves with `twist`.
  ImagePair stereo(const Pose& true_pose, const Twist& twist, std::uint64_t frame) const {
    return stereo(true_pose, ImageMoment{.frame = frame, .yaw_rate = twist.yaw_rate},
                  std::span<const Person>());
  }
  ImagePair stereo(const Pose& true_pose, const ImageMoment& moment,
                   std::span<const Person> people) const;
  DepthImage depth(const Pose& true_pose, std::uint64_t frame,
                   std::span<const Person> people = {}) const;

  const CameraRigOptions& options() const { return options_; }
  const PinholeCamera& depth_camera() const { return depth_camera_; }
  const std::shared_ptr<const SceneRenderer>& scene() const { return scene_; }

 private:
  std::shared_ptr<const SceneRenderer> scene_;
  CameraRigOptions options_;
  PinholeCamera depth_camera_;
  // As they are in truth.
  TrueStereo stereo_;
  CameraMount stereo_mount_, depth_mount_;
  PinholeCamera true_depth_;
  float depth_scale_ = 1.0f;
  ImageSensor left_, right_;
};

}  // namespace prospect
