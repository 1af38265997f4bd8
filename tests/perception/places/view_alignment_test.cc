// SPDX-License-Identifier: Apache-2.0
#include "perception/places/view_alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "perception/odometry/se3.h"
#include "tests/perception/rendered_room.h"

namespace prospect::view_alignment_test {
namespace {

StereoCamera camera() {
  StereoCamera camera;
  camera.left = {330.0, 330.0, 239.5, 179.5, 480.0, 360.0};
  return camera;
}

StereoView view_from(const test::RenderedRoom& room, const Eigen::Isometry3d& T_WC, int seed) {
  const auto pair = room.render(camera(), T_WC, 2.0, static_cast<std::uint64_t>(seed));
  return stereo_view(camera(), pair.left.view(), pair.right.view());
}

TEST(ViewAlignment, FindsThePoseAndItsCovariance) {
  const test::RenderedRoom room;
  double nees = 0.0;
  int found = 0;
  for (int n = 0; n < 8; ++n) {
    const double by = 0.1 + 0.06 * n;
    const auto T_a = test::RenderedRoom::looking(-1.4, -0.3, 1.05, 0.1 * n - 0.3);
    const auto T_b = test::RenderedRoom::looking(-1.4 + by, -0.3 + 0.5 * by, 1.05, 0.1 * n - 0.15);
    const auto alignment =
        align_views(camera(), view_from(room, T_a, 2 * n), view_from(room, T_b, 2 * n + 1));
    if (!alignment) continue;
    ++found;
    const Eigen::Isometry3d off = alignment->measured.T.inverse() * T_a.inverse() * T_b;
    EXPECT_LT(off.translation().norm(), 0.06) << n;
    EXPECT_LT(Eigen::AngleAxisd(off.linear()).angle(), 0.02) << n;
    const Eigen::Matrix<double, 6, 1> e = log_se3(off);
    nees += e.dot(alignment->measured.information * e) / 6.0;
  }
  ASSERT_GE(found, 7);
  EXPECT_LT(nees / found, 3.0);
}

TEST(ViewAlignment, FindsTheSameFromMuchNearer) {
  const test::RenderedRoom room;
  const auto T_a = test::RenderedRoom::looking(-1.6, -0.2, 1.05, 0.0);
  const auto T_b = test::RenderedRoom::looking(-0.8, -0.1, 1.05, 0.12);
  const StereoView a = view_from(room, T_a, 1), b = view_from(room, T_b, 2);
  ViewPrior prior;
  // Where it is expected is off by as much as drift of a short way.
  prior.b_in_a = T_a.inverse() * T_b;
  prior.b_in_a->translation().x() += 0.1;
  const auto alignment = align_views(camera(), a, b, prior);
  ASSERT_TRUE(alignment);
  const Eigen::Isometry3d off = alignment->measured.T.inverse() * T_a.inverse() * T_b;
  EXPECT_LT(off.translation().norm(), 0.08);
  EXPECT_LT(Eigen::AngleAxisd(off.linear()).angle(), 0.03);
}

TEST(ViewAlignment, TheDisparitiesZeroIsCorrectedAndClaimed) {
  const test::RenderedRoom room;
  const auto T_a = test::RenderedRoom::looking(-1.6, -0.2, 1.05, 0.0);
  const auto T_b = test::RenderedRoom::looking(-1.1, -0.1, 1.05, 0.1);
  StereoView a = view_from(room, T_a, 1), b = view_from(room, T_b, 2);
  constexpr double kWrong = 1.0;  // [px]
  for (StereoView* view : {&a, &b}) {
    for (StereoView::Point& p : view->points) p.disparity -= kWrong;
  }
  const auto off = [&](const ViewAlignment& found) {
    return Eigen::Isometry3d(found.measured.T.inverse() * T_a.inverse() * T_b);
  };
  ViewPrior prior;
  prior.disparity_offset = kWrong;
  prior.disparity_offset_sigma = 0.05;
  const auto corrected = align_views(camera(), a, b, prior);
  ASSERT_TRUE(corrected);
  prior.disparity_offset = 0.0;
  prior.disparity_offset_sigma = kWrong;
  const auto wrong = align_views(camera(), a, b, prior);
  ASSERT_TRUE(wrong);
  EXPECT_LT(off(*corrected).translation().norm(), 0.7 * off(*wrong).translation().norm());
  for (const ViewAlignment& found : {*corrected, *wrong}) {
    const Eigen::Matrix<double, 6, 1> e = log_se3(off(found));
    EXPECT_LT(e.dot(found.measured.information * e) / 6.0, 4.0);
  }
}

TEST(ViewAlignment, OtherPlacesAreNotTheSame) {
  const test::RenderedRoom room, other(70.0, 0.0);
  const StereoView a = view_from(room, test::RenderedRoom::looking(-1.4, 0.0, 1.05, 0.0), 1);
  // The opposite wall, and the wall beside it.
  for (const double yaw : {M_PI, 0.5 * M_PI, -0.5 * M_PI}) {
    const StereoView b = view_from(other, test::RenderedRoom::looking(0.5, 0.0, 1.05, yaw), 2);
    EXPECT_FALSE(align_views(camera(), a, b)) << yaw;
  }
  EXPECT_FALSE(align_views(camera(), a, {}));
}

}  // namespace
}  // namespace prospect::view_alignment_test
