// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "engine/features/footprint_kernel.h"
#include "engine/features/occlusion_table.h"
#include "models/camera.h"
#include "models/types.h"

namespace prospect {

/// Smooth probability that a depth sensor on the robot resolves each point of an occlusion table:
///
///   q_c(x) = P_fov P_range P_unoccluded
///   P_fov   = product over the four sides of s((sin(angle inside the side) / angle_scale) - inset)
///   P_range = s((r - min_range) / range_scale - inset) s((max_range - r) / range_scale - inset)
///
/// with s(a) = 1 / (1 + e^-a). The angle inside a side is h/2 -+ azimuth or v/2 -+ elevation of the
/// footprint (h, v its fields of view), azimuth and elevation in the camera frame C:
/// azimuth = atan2(X, Z), elevation = asin(Y / r). Its sine replaces the angle itself (equal to
/// within 2 % below 0.3 rad), which is smooth everywhere and needs no arctangent.
/// The sigmoids are moved `inset` scales inward: a sigmoid worth 1/2 at the true edge rewards
/// standing still before cells that the sensor never resolves.
///
/// Fields of view of any width. Of half an angle H (h/2 or v/2), the sine is
///   H <= pi/2   sin(H -+ angle), times 6 angle_scale / sin H where that is above 1: the axis of a
///               narrow field is in view all the same. A field narrower than 2 angle_scale, such as
///               a single layer of rays, counts as that wide: a target stands for a block of cells.
///   H >  pi/2   (cos azimuth - cos H) min(6, 1 / sin H), for both sides: of slope 1 at the edges,
///               even and smooth across the seam behind the sensor; at H = pi/2 the same as above.
///   within angle_scale of all round (H = pi; for v, pi/2): 1, there is no side.
///
/// So that most points need no work, g = P_fov P_range is cut off smoothly at e = e^-12 = 6e-6: it
/// counts as (g - e)^2 / g above and as 0 below, which is C1 and changes no q by more than 2 e.
///
/// Frames: poses in W, points in W, [m] and [rad]. Smoothness: C1 (that of the occlusion table).
/// Thread-safety: immutable; concurrent calls need separate Scratch. Finite for finite poses, also
/// with a point at the sensor (distances are regularised by 2 cm).
/// Source: formulation, section 4; the sigmoids' shape is our choice.
class FootprintVisibility {
 public:
  struct Options {
    double angle_scale = 0.06;  ///< [rad]
    double range_scale = 0.15;  ///< [m]
    double inset = 2.0;         ///< in scales
  };

  /// Per-thread memory of the calls below.
  struct Scratch {
    explicit Scratch(int points);
    Eigen::ArrayXd probability, d_x, d_y, d_z;  // of no occlusion: all points
    Eigen::ArrayXd X, Y, Z;                     // of the points looked at, in C
    Eigen::ArrayXd u, u_x, u_y, u_z;            // probability of no occlusion, of those
    Eigen::ArrayXf score_probability, score_X, score_Y, score_Z, score_u, score_q;  // of a score
    // What evaluate() and gradient() sum over.
    Eigen::ArrayXi point;
    Eigen::ArrayXd q, q_x, q_y, q_z, q_yaw;
  };

  /// Where look() writes: arrays of capacity() entries, one for each point looked at. With d_x all
  /// derivatives (by the base's position in W and its yaw) are asked for, without it none. A score
  /// has none; its q are computed in single precision and within 6e-6.
  struct Views {
    int* point = nullptr;  ///< its index, increasing
    double* q = nullptr;
    double* d_x = nullptr;
    double* d_y = nullptr;
    double* d_z = nullptr;
    double* d_yaw = nullptr;
    bool score = false;
  };

  /// Throws std::invalid_argument if the footprint is not valid (validate()) or a scale is not
  /// positive. `occlusion` must not be null.
  FootprintVisibility(const RgbdFootprint& footprint, const CameraMount& mount,
                      std::shared_ptr<const OcclusionTable> occlusion, const Options& options);
  FootprintVisibility(const RgbdFootprint& footprint, const CameraMount& mount,
                      std::shared_ptr<const OcclusionTable> occlusion)
      : FootprintVisibility(footprint, mount, std::move(occlusion), Options()) {}

  /// For in_footprint() alone: no points.
  FootprintVisibility(const RgbdFootprint& footprint, const CameraMount& mount);

  int size() const { return occlusion_ ? occlusion_->num_points() : 0; }
  /// size() rounded up to whole vectors.
  int capacity() const { return FootprintKernel::padded(size()); }

  /// P_fov P_range (cut off) of one point in W; 0 for a non-finite pose or point.
  double in_footprint(const Pose& pose, const Eigen::Vector3d& point) const;

  /// The points that can have q > 0 at a pose of B (their number; -1 for a non-finite pose), with
  /// q and, if asked for, its derivatives. All other points have q = 0 and derivatives of 0. The
  /// entries up to FootprintKernel::padded() of it are overwritten with numbers of no meaning. q
  /// has the same bits with and without derivatives.
  int view(const Pose& pose, Scratch& scratch, const Views& views) const;

  /// Writes size() probabilities q_c at a pose of B; NaN for a non-finite pose.
  void evaluate(const Pose& pose, Scratch& scratch, double* q) const;

  /// sum_c weight[c] dq_c / d(x, y, z, yaw) of the pose; NaN for a non-finite pose.
  Eigen::Vector4d gradient(const Pose& pose, const double* weight, Scratch& scratch) const;

 private:
  void prepare();
  FootprintKernelPose kernel_pose(const Pose& pose) const;
  int score(FootprintKernelPose pose, Scratch& scratch, const Views& views) const;

  RgbdFootprint footprint_;
  CameraMount mount_;
  Options options_;
  std::shared_ptr<const OcclusionTable> occlusion_;
  Eigen::ArrayXd px_, py_, pz_;  // the points, structure of arrays, padded
  Eigen::Vector3d score_origin_ = Eigen::Vector3d::Zero();
  Eigen::ArrayXf score_px_, score_py_, score_pz_;  // the same from there
  FootprintKernelConstants constants_;
  FootprintKernel kernel_ = footprint_kernel(best_instruction_set());
};

}  // namespace prospect
