// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "engine/maps/clearance_field.h"
#include "models/robot_shape.h"
#include "models/types.h"

namespace prospect {

/// Clearance of the robot's body at a pose: d(x) of the clearance terms.
///
/// The body is bounded by discs (planar field) or spheres (3-D field) with centres c_j in B and
/// radii r_j;  d_j = field(p + Rz(yaw) c_j) - r_j  and
///   d(pose) = -T log sum_j exp(-d_j / T),   T = temperature [m],
/// a smooth lower bound of min_j d_j: smaller by at most T log(number of bodies), equal for one.
/// Since the discs contain the body, min_j d_j is itself a lower bound of the body's distance, up
/// to the field's interpolation error.
///
/// Thread-safety: immutable. Smoothness: C1 in the pose.
/// Source: formulation, section 5; the bound by discs and the soft minimum are our choice.
class BodyClearance {
 public:
  /// field non-null. Throws std::invalid_argument for an invalid shape or a field whose cutoff does
  /// not exceed the largest bounding radius.
  BodyClearance(std::shared_ptr<const ClearanceField> field, const RobotShape& shape,
                double temperature = 0.01);
  /// The same body in another field, without bounding it anew, which takes milliseconds. Throws
  /// std::invalid_argument for a field that is planar where the other is not, and as above.
  BodyClearance(std::shared_ptr<const ClearanceField> field, const BodyClearance& body);

  /// d [m]; unless null, `gradient` gets dd/d(x, y, z, yaw) ([-], [-], [-], [m/rad]).
  double clearance(const Pose& pose, Eigen::Vector4d* gradient = nullptr) const;

  /// No clearance larger than this is ever reported [m]: cutoff - margin - largest bounding radius.
  double saturation() const { return saturation_; }
  double largest_radius() const { return largest_radius_; }
  const ClearanceField& field() const { return *field_; }
  const std::vector<Sphere>& bodies() const { return bodies_; }

 private:
  void fit();

  std::shared_ptr<const ClearanceField> field_;
  std::vector<Sphere> bodies_;
  double temperature_ = 0.01;
  double largest_radius_ = 0.0;
  double saturation_ = 0.0;
  bool centred_ = false;  // one body on B's z axis: yaw does not matter
};

}  // namespace prospect
