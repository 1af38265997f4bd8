// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/program/python/arrays.h"
#include "models/types.h"

/// Poses and velocities as arrays of four: x, y, z, and the angle about z.
namespace prospect::python {

inline Numbers array_of(const Pose& pose) {
  const double p[] = {pose.position.x(), pose.position.y(), pose.position.z(), pose.yaw};
  return array_of(p, {4});
}

inline Numbers array_of(const Twist& twist) {
  const double t[] = {twist.linear.x(), twist.linear.y(), twist.linear.z(), twist.yaw_rate};
  return array_of(t, {4});
}

inline Twist twist_of(const ArrayLike& array, const std::string& name,
                      Entries entries = Entries::kFinite) {
  const Eigen::VectorXd t = vector_of(array, 4, name, entries);
  return {t.head<3>(), t[3]};
}

}  // namespace prospect::python
