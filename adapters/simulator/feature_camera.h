#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "adapters/simulator/feature_field.h"
#include "adapters/worlds/world.h"
#include "models/camera.h"
#include "models/types.h"

namespace prospect {

struct FeatureCameraOptions {
  StereoCamera stereo;
  double min_depth = 0.4;       ///< [m], along the optical axis
  double max_depth = 6.0;       ///< [m]
  double max_view_angle = 1.2;  ///< [rad] between the surface normal and the ray to the camera
  /// The tracker keeps at most per_bucket features in each of columns x rows parts of the image,
  /// the ones already tracked first: 250 at most by default, spread over the image.
  int bucket_columns = 10;
  int bucket_rows = 5;
  int per_bucket = 5;
};

/// One tracked feature in one stereo image.
struct FeatureObservation {
  std::uint32_t feature = 0;   ///< index in the FeatureField
  double u = 0.0, v = 0.0;     ///< [px], left image, with noise
  double disparity = 0.0;      ///< [px], with noise; positive
  Eigen::Vector3d true_point;  ///< [m], in C, without noise
};

/// Stereo camera that sees true features: a feature is visible if it projects inside both images,
/// its depth is within range, the surface is seen at most max_view_angle from its normal, and no
/// solid voxel lies between. All conditions are evaluated on the truth. Thread-safety: one thread.
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
  const World* world_;
  const FeatureField* field_;
  FeatureCameraOptions options_;
  CameraMount mount_;
  std::mt19937_64 noise_;
  std::vector<std::uint32_t> tracked_;
};

}  // namespace prospect
