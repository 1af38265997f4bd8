// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/repeated_content.h"

#include <gtest/gtest.h>

#include <optional>

namespace prospect::repeated_content_test {
namespace {

using Eigen::Isometry3d;

Isometry3d at(double x, double turn = 0.0) {
  Isometry3d T(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()));
  T.translation().x() = x;
  return T;
}

TEST(RepeatedContent, CountsMotionFromWhereTheContentWasNew) {
  RepeatedContent content;
  EXPECT_FALSE(content.hangs(false, at(0.0)));
  EXPECT_FALSE(content.hangs(true, at(0.019)));
  EXPECT_FALSE(content.hangs(true, at(0.0, -0.019)));
  EXPECT_TRUE(content.hangs(true, at(0.021)));
  EXPECT_TRUE(content.hangs(true, at(0.0))) << "it does so until there is new content";
  EXPECT_FALSE(content.hangs(false, at(5.0))) << "who sees something new may be anywhere";
  EXPECT_TRUE(content.hangs(true, at(5.0, 0.021)));
}

TEST(RepeatedContent, WhereNobodyKnowsThePoseNothingIsSaid) {
  RepeatedContent content;
  EXPECT_FALSE(content.hangs(false, std::nullopt));
  EXPECT_FALSE(content.hangs(true, at(7.0)));
  EXPECT_FALSE(content.hangs(true, std::nullopt));
  EXPECT_FALSE(content.hangs(true, at(8.0))) << "found again elsewhere";
  EXPECT_TRUE(content.hangs(true, at(8.1)));
  EXPECT_TRUE(content.hangs(true, std::nullopt));
  EXPECT_TRUE(content.hangs(true, at(9.0)));
}

}  // namespace
}  // namespace prospect::repeated_content_test
