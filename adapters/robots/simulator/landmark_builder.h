// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "adapters/robots/simulator/feature_camera.h"
#include "engine/maps/landmark_map.h"
#include "engine/maps/planar_move.h"
#include "engine/maps/voxel_grid.h"
#include "models/camera.h"
#include "models/types.h"
#include "perception/pipeline/feature_density.h"

namespace prospect {

class Knobs;

struct LandmarkBuilderOptions {
  int max_landmarks = 4000;  ///< beyond it the least surviving and then oldest unseen are dropped
  /// A landmark seen again from outside these bounds of its creation view is created anew.
  double max_scale = 1.5;        ///< ratio of ranges, either way
  double max_view_change = 0.5;  ///< [rad]
  /// Survival rate: (a + tracked) / (a + b + expected).
  double survival_prior_tracked = 4.5;
  double survival_prior_missed = 0.5;
  double cull_survival = 0.25;  ///< dropped below this ...
  int cull_views = 12;          ///< ... after so many expected views
  FeatureDensityOptions density;
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, LandmarkBuilderOptions& options);

/// The odometry's landmark map, built in the estimated frame from what is tracked at keyframes.
///
/// A new feature is triangulated from its noisy measurement, l = T_WC Y(u, v, d) with the estimated
/// T_WC and Sigma = R Sigma_Y R^T (formulation, eq. (1)); so the map bends with the estimate. A
/// feature seen again with less than half of its former uncertainty replaces its position; one seen
/// from a very different view is created anew, as its appearance would be.
/// Survival counts the keyframes in which a landmark was expected (inside both images, within the
/// depth range and the bounds of its creation view, unoccluded in the map) and tracked.
/// Thread-safety: one thread updates; snapshots never change.
class LandmarkBuilder {
 public:
  LandmarkBuilder(const LandmarkBuilderOptions& options, const FeatureCameraOptions& camera,
                  const CameraMount& mount);

  /// One keyframe, taken at an estimated pose. surface_area [m^2]: all surface mapped so far.
  /// anchor: of the map (anchored_map.h), from which it is seen.
  void update(const std::vector<FeatureObservation>& observations, const Pose& estimated_pose,
              const VoxelGrid& voxels, double surface_area, int anchor = 0);

  /// What was seen from each anchor has moved so in W.
  void follow(const std::vector<PlanarMove>& anchors);
  /// Where all of them are is not known any more.
  void forget();

  /// The landmark of a feature, or null; valid until the next update.
  const Landmark* find(std::uint64_t id) const {
    const auto it = position_.find(id);
    return it == position_.end() ? nullptr : &map_->landmarks[it->second];
  }

  /// The map now. It is copied before the next update only if somebody still holds it.
  std::shared_ptr<const LandmarkMap> map() const { return map_; }

 private:
  struct Statistics {
    int expected = 0;
    int tracked = 0;
    std::uint64_t last_seen = 0;  // keyframe
    int anchor = 0;               // that its place was measured from
  };
  void cull();

  LandmarkBuilderOptions options_;
  FeatureCameraOptions camera_;
  CameraMount mount_;
  std::shared_ptr<LandmarkMap> map_;
  std::vector<Statistics> statistics_;                         // parallel to map_->landmarks
  std::unordered_map<std::uint64_t, std::uint32_t> position_;  // id -> index in both
  std::uint64_t keyframe_ = 0;
  FeatureDensity density_;
};

}  // namespace prospect
