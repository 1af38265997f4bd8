// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/odometry_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace prospect::odometry_run_test {
namespace {

/// A run of `ok` frames along x, 0.1 m each, then of `lost` ones; the first `with_truth` poses have
/// a truth, which is 2 % shorter.
OdometryRun run_of(int ok, int lost, int with_truth) {
  OdometryRun run;
  for (int k = 0; k < ok + lost; ++k) {
    OdometryFrame frame;
    frame.stamp = 0.1 * k;
    frame.disparity_offset_sigma = 0.1;
    if (k < ok) {
      frame.state = Localization::kOk;
      frame.T_WC.translation().x() = 0.1 * k;
      run.trajectory.push_back({frame.stamp, frame.T_WC});
      if (k < with_truth) {
        Eigen::Isometry3d truth = frame.T_WC;
        truth.translation() *= 0.98;
        run.pairs.push_back({frame.stamp, frame.T_WC, truth});
      }
    } else {
      frame.reason = k % 3 == 0 ? "too few points" : "the image is dark";
    }
    run.frames.push_back(frame);
  }
  return run;
}

struct Case {
  int ok, lost, with_truth;
  double covered, covered_truth;
  bool length, errors, mostly_lost;
};

// What two poses are needed for is none without them; what is covered stands beside it.
TEST(OdometrySummary, WhatDoesNotExistIsNone) {
  for (const Case& c : {Case{1, 1, 0, 0.5, 0.0, false, false, true},    // the second lost
                        Case{1, 1, 1, 0.5, 0.5, false, false, true},    // and with a truth
                        Case{20, 0, 1, 1.0, 0.05, true, false, false},  // a truth of one frame
                        Case{20, 0, 2, 1.0, 0.1, true, true, false},    // of a tenth
                        Case{0, 20, 0, 0.0, 0.0, false, false, true},   // all lost
                        Case{1, 0, 0, 1.0, 0.0, false, false, false},   // one frame
                        Case{20, 0, 0, 1.0, 0.0, true, false, false},   // no truth
                        Case{9, 11, 9, 0.45, 0.45, true, true, true}}) {
    SCOPED_TRACE(std::to_string(c.ok) + " ok, " + std::to_string(c.lost) + " lost, " +
                 std::to_string(c.with_truth) + " with a truth");
    const OdometrySummary s = summarize(run_of(c.ok, c.lost, c.with_truth));
    EXPECT_DOUBLE_EQ(s.covered, c.covered);
    EXPECT_DOUBLE_EQ(s.covered_truth, c.covered_truth);
    EXPECT_EQ(std::isfinite(s.estimated_length), c.length);
    EXPECT_EQ(s.mostly_lost, c.mostly_lost);
    EXPECT_EQ(s.lost_reason.empty(), c.lost == 0);
    for (const double error :
         {s.true_length, s.end.translation, s.end.share, s.end.rotation, s.ate_first.rmse,
          s.ate_first.max, s.ate_fit.rmse, s.ate_fit.median}) {
      EXPECT_EQ(std::isfinite(error), c.errors) << error;
    }
    EXPECT_FALSE(std::isfinite(s.rpe_10m.translation));  // no path is that long
    EXPECT_EQ(std::isfinite(s.disparity_offset), c.ok > 0);
    EXPECT_EQ(std::isfinite(s.disparity_offset_sigma), c.ok > 0);
    if (c.errors) {
      EXPECT_NEAR(s.end.share, 0.02 / 0.98, 1e-9);
    }
  }
}

TEST(OdometrySummary, OfNothing) {
  const OdometrySummary s = summarize(OdometryRun());
  EXPECT_EQ(s.frames, 0);
  EXPECT_TRUE(std::isnan(s.covered));
  EXPECT_TRUE(std::isnan(s.covered_truth));
  EXPECT_TRUE(std::isnan(s.end.translation));
  EXPECT_FALSE(s.mostly_lost);
}

TEST(OdometryFrames, AReasonWithACommaIsOneFieldAndTheLast) {
  OdometryRun run = run_of(0, 1, 0);
  run.frames[0].reason = "dark, or covered";
  EXPECT_TRUE(frames_csv(run).ends_with(",\"dark, or covered\"\n")) << frames_csv(run);
}

}  // namespace
}  // namespace prospect::odometry_run_test
