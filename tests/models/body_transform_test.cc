// SPDX-License-Identifier: Apache-2.0
#include "models/body_transform.h"

#include <gtest/gtest.h>

#include <cmath>

namespace prospect::body_transform_test {
namespace {

TEST(BodyTransform, TurnsByTheYawAndMovesToThePosition) {
  const Eigen::Isometry3d T_WB = body_transform({{1.0, 2.0, 3.0}, M_PI / 2.0});
  EXPECT_TRUE((T_WB * Eigen::Vector3d(0.5, 0.2, 0.1)).isApprox(Eigen::Vector3d(0.8, 2.5, 3.1)));
  EXPECT_TRUE((T_WB * T_WB.inverse()).isApprox(Eigen::Isometry3d::Identity()));
}

}  // namespace
}  // namespace prospect::body_transform_test
