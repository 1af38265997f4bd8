// SPDX-License-Identifier: Apache-2.0
#include "engine/features/tracked_calibration.h"

#include <gtest/gtest.h>

namespace prospect::tracked_calibration_test {
namespace {

struct View {
  std::vector<Landmark> landmarks;
  Eigen::VectorXd visible;
};

/// Ten in view, five on the border of the image, five elsewhere.
View some_in_view() {
  View view;
  view.visible.resize(20);
  for (int i = 0; i < 20; ++i) {
    Landmark l;
    l.survival = 0.8;
    l.multiplicity = 1.0 + i % 3;
    view.landmarks.push_back(l);
    view.visible[i] = 0.8 * (i < 10 ? 1.0 : i < 15 ? 0.4 : 0.0);
  }
  return view;
}

double predicted(const View& view) {
  double sum = 0.0;
  for (int i = 0; i < view.visible.size(); ++i) {
    sum += view.landmarks[static_cast<std::size_t>(i)].multiplicity * view.visible[i];
  }
  return sum;
}

TEST(TrackedCalibration, ThePresentViewCountsAsItIsTracked) {
  for (const double tracked : {8.0, 15.0, 40.0}) {
    View view = some_in_view();
    calibrate_to_tracked(view.landmarks, view.visible, tracked);
    EXPECT_NEAR(predicted(view), tracked, 1e-9);
    const View before = some_in_view();
    const auto factor = [&](std::size_t i) {
      return view.landmarks[i].multiplicity / before.landmarks[i].multiplicity;
    };
    EXPECT_EQ(factor(17), 1.0) << "what is not in view stays as it is";
    EXPECT_NEAR(factor(12) - 1.0, 0.4 * (factor(3) - 1.0), 1e-12);
  }
}

TEST(TrackedCalibration, IsBounded) {
  View view = some_in_view();
  calibrate_to_tracked(view.landmarks, view.visible, 0.0);
  EXPECT_NEAR(view.landmarks[0].multiplicity, 0.25, 1e-12);
  view = some_in_view();
  calibrate_to_tracked(view.landmarks, view.visible, 1e4);
  EXPECT_NEAR(view.landmarks[0].multiplicity, 4.0, 1e-12);
}

TEST(TrackedCalibration, WithNothingInViewNothingChanges) {
  View view = some_in_view();
  view.visible.setZero();
  calibrate_to_tracked(view.landmarks, view.visible, 50.0);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(view.landmarks[static_cast<std::size_t>(i)].multiplicity, 1.0 + i % 3);
  }
  std::vector<Landmark> none;
  calibrate_to_tracked(none, Eigen::VectorXd(), 50.0);
}

}  // namespace
}  // namespace prospect::tracked_calibration_test
