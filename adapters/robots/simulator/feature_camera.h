// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "adapters/formats/worlds/world.h"
#include "adapters/robots/simulator/feature_field.h"
#include "models/camera.h"
#include "models/types.h"

namespace prospect {

class Knobs;

/// What of the features is tracked. The numbers are those of StereoOdometry, or were measured with
/// it on marks rendered at the same places (docs/results/simulator.md, "One fidelity against the
/// other").
struct FeatureCameraOptions {
  StereoCamera stereo;
  double min_depth = 0.4;       ///< [m], along the optical axis
  double max_depth = 10.0;      ///< [m]; 3 % of what is tracked lies beyond
  double max_view_angle = 1.5;  ///< [rad] between the surface normal and the ray to the camera
  /// A feature is `size` wide [m], the mean of the marks of world_mesh.h, and seen as long as its
  /// shorter side in the image, size fx cos(view angle) / depth, is at least min_pixels.
  double size = 0.055;
  double min_pixels = 1.0;
  double border = 10.0;  ///< [px] along the edges of both images, CornerDetectorOptions::border
  /// One feature is tracked in each of about so many square cells. Measured: of the detector's 300
  /// (CornerDetectorOptions::cells) light, blur and dirt leave so many.
  int cells = 180;
};

/// The knobs (models/knobs.h); the stereo pair is the robot's.
void describe(Knobs& knobs, FeatureCameraOptions& options);

/// One tracked feature in one stereo image.
struct FeatureObservation {
  std::uint32_t feature = 0;   ///< index in the FeatureField
  double u = 0.0, v = 0.0;     ///< [px], left image, with noise
  double disparity = 0.0;      ///< [px], with noise; positive
  Eigen::Vector3d true_point;  ///< [m], in C, without noise
};

/// Stereo camera that sees true features: a feature is visible if it projects inside both images
/// less their border, its depth is within range, the surface is seen at most max_view_angle from
/// its normal, it is large enough in the image, and no solid voxel lies between. All conditions are
/// evaluated on the truth.
///
/// Of the visible ones an image keeps those tracked already, one an image cell, and adds others to
/// cells without one, the largest in the image first, at least half a cell from all that are kept:
/// as detect_corners() does, whose strongest corners are the least foreshortened.
/// Thread-safety: one thread.
/// Deterministic in (world, field, options, seed, sequence of poses).
class FeatureCamera {
 public:
  /// Throws std::invalid_argument on options out of range.
  FeatureCamera(const World& world, const FeatureField& field, const FeatureCameraOptions& options,
                const CameraMount& mount, std::uint64_t seed);

  /// Indices of all features visible from a true body pose, ascending.
  std::vector<std::uint32_t> visible(const Pose& true_pose) const;

  /// One image: which of the visible features are tracked, with measurement noise; by ascending
  /// index. Remembers them as the ones tracked already. `visible_count`, if given, receives the
  /// number visible before the limit.
  std::vector<FeatureObservation> observe(const Pose& true_pose, int* visible_count = nullptr);

  const FeatureCameraOptions& options() const { return options_; }
  const CameraMount& mount() const { return mount_; }

 private:
  /// Shorter side of a feature in the image [px].
  double pixels(double cosine, double depth) const;

  const World* world_;
  const FeatureField* field_;
  FeatureCameraOptions options_;
  CameraMount mount_;
  std::mt19937_64 noise_;
  std::vector<std::uint32_t> tracked_;
};

}  // namespace prospect
