#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "engine/occlusion_table.h"
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
/// Values that the factors bound below e^-24 = 4e-11 are set to 0, far beneath any solver's
/// tolerance.
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

  /// Per-thread memory of a value or gradient call.
  struct Scratch {
    explicit Scratch(int points);
    Eigen::ArrayXd probability, d_x, d_y, d_z;  // of all points
    Eigen::ArrayXi seen;                        // indices of points with probability > 0
    Eigen::ArrayXd X, Y, Z, rho, r;             // of the seen points, in C
    Eigen::ArrayXd e;                           // e^-a of the six sigmoids, one after the other
    Eigen::ArrayXd q;
  };

  /// Throws std::invalid_argument unless 0 < fields of view < pi, 0 <= min_range < max_range and
  /// the scales are positive. `occlusion` must not be null.
  FootprintVisibility(const RgbdFootprint& footprint, const CameraMount& mount,
                      std::shared_ptr<const OcclusionTable> occlusion, const Options& options);
  FootprintVisibility(const RgbdFootprint& footprint, const CameraMount& mount,
                      std::shared_ptr<const OcclusionTable> occlusion)
      : FootprintVisibility(footprint, mount, std::move(occlusion), Options()) {}

  /// For in_footprint() alone: no points.
  FootprintVisibility(const RgbdFootprint& footprint, const CameraMount& mount);

  int size() const { return occlusion_ ? occlusion_->num_points() : 0; }

  /// P_fov P_range of one point in W; 0 for a non-finite pose or point.
  double in_footprint(const Pose& pose, const Eigen::Vector3d& point) const;

  /// Writes size() probabilities q_c at a pose of B.
  void evaluate(const Pose& pose, Scratch& scratch, double* q) const;

  /// sum_c weight[c] dq_c / d(x, y, z, yaw) of the pose.
  Eigen::Vector4d gradient(const Pose& pose, const double* weight, Scratch& scratch) const;

 private:
  void prepare();
  /// Camera position in W and the rotation from W to C at a pose.
  struct View {
    Eigen::Vector3d position;
    Eigen::Matrix3d R_CW;
  };
  View view(const Pose& pose) const;
  /// Fills scratch.seen and what follows it from scratch.probability; returns the number seen.
  int look(const View& view, Scratch& scratch) const;
  /// Exponents -a of the six sigmoids of a point at (X, Y, Z) in C, and its distances.
  struct Exponents {
    double a0, a1, a2, a3, a4, a5, rho, r;
  };
  Exponents exponents(double X, double Y, double Z) const;

  RgbdFootprint footprint_;
  CameraMount mount_;
  Options options_;
  std::shared_ptr<const OcclusionTable> occlusion_;
  Eigen::ArrayXd px_, py_, pz_;  // the points, structure of arrays
  double sin_h_ = 0.0, cos_h_ = 1.0, sin_v_ = 0.0, cos_v_ = 1.0;
};

}  // namespace prospect
