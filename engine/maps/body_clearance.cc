// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/body_clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace prospect {

BodyClearance::BodyClearance(std::shared_ptr<const ClearanceField> field, const RobotShape& shape,
                             double temperature)
    : field_(std::move(field)), temperature_(temperature) {
  if (field_ == nullptr) throw std::invalid_argument("body clearance: no clearance field");
  if (!(temperature > 0.0) || !std::isfinite(temperature)) {
    throw std::invalid_argument("body clearance: temperature is " + std::to_string(temperature) +
                                " m; expected > 0");
  }
  validate(shape);
  if (field_->options().vertical) {
    bodies_ = bounding_spheres(shape);
  } else {
    for (const Disc& disc : bounding_discs(shape)) {
      bodies_.push_back({{disc.center.x(), disc.center.y(), 0.0}, disc.radius});
    }
  }
  fit();
}

BodyClearance::BodyClearance(std::shared_ptr<const ClearanceField> field, const BodyClearance& body)
    : field_(std::move(field)), bodies_(body.bodies_), temperature_(body.temperature_) {
  if (field_ == nullptr) throw std::invalid_argument("body clearance: no clearance field");
  if (field_->options().vertical != body.field_->options().vertical) {
    throw std::invalid_argument(
        "body clearance: one field is planar and one is not; expected two of a kind");
  }
  fit();
}

void BodyClearance::fit() {
  for (const Sphere& s : bodies_) largest_radius_ = std::max(largest_radius_, s.radius);
  saturation_ = field_->options().cutoff - field_->options().margin - largest_radius_;
  if (!(saturation_ > 0.0)) {
    throw std::invalid_argument("body clearance: the field's cutoff less its margin is " +
                                std::to_string(saturation_ + largest_radius_) +
                                " m; expected more than the largest bounding radius, " +
                                std::to_string(largest_radius_));
  }
  centred_ = bodies_.size() == 1 && bodies_.front().center.head<2>().isZero(0.0);
}

double BodyClearance::clearance(const Pose& pose, Eigen::Vector4d* gradient) const {
  Eigen::Vector3d g;
  Eigen::Vector3d* const g_out = gradient != nullptr ? &g : nullptr;
  if (centred_) {
    const Sphere& s = bodies_.front();
    const double d = field_->distance(pose.position + s.center, g_out) - s.radius;
    if (gradient != nullptr) *gradient << g, 0.0;
    return d;
  }
  const double c = std::cos(pose.yaw);
  const double s = std::sin(pose.yaw);
  // One pass: sums of exp(-(d_j - smallest) / T), rescaled whenever a smaller d_j turns up.
  double smallest = std::numeric_limits<double>::infinity();
  double sum = 0.0;
  Eigen::Vector4d weighted = Eigen::Vector4d::Zero();
  for (const Sphere& body : bodies_) {
    const Eigen::Vector3d arm(c * body.center.x() - s * body.center.y(),
                              s * body.center.x() + c * body.center.y(), body.center.z());
    const double d = field_->distance(pose.position + arm, g_out) - body.radius;
    const double above = (d - smallest) / temperature_;
    if (above > 40.0) continue;  // exp(-40) is below the rounding of the sum
    double weight = 1.0;
    if (d < smallest) {
      const double rescale = std::exp(above);
      sum *= rescale;
      weighted *= rescale;
      smallest = d;
    } else {
      weight = std::exp(-above);
    }
    sum += weight;
    if (gradient != nullptr) {
      weighted += weight * Eigen::Vector4d(g.x(), g.y(), g.z(), g.y() * arm.x() - g.x() * arm.y());
    }
  }
  if (gradient != nullptr) *gradient = weighted / sum;
  return smallest - temperature_ * std::log(sum);
}

}  // namespace prospect
