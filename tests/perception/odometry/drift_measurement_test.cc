// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/drift_measurement.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <vector>

#include "engine/support/cholesky.h"
#include "perception/odometry/se3.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::drift_measurement_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Matrix6d = PoseDrift::Matrix6d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Landmarks that the keyframe 1 made at the identity, as frames see them.
class DriftMeasurements : public testing::Test {
 protected:
  std::mt19937_64 rng_{5};
  StereoCamera camera_;
  PoseEstimatorOptions options_;
  Vector3d sigma_{1e-9, 1e-9, 0.3};
  std::shared_ptr<Anchor> anchor_ = std::make_shared<Anchor>();
  std::uint64_t next_id_ = 1;

  DriftMeasurements() { anchor_->id = 1; }
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(rng_); }
  double normal(double s) { return std::normal_distribution<double>(0.0, s)(rng_); }
  Isometry3d motion(double translation, double rotation) {
    Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = uniform(-1, 1) * (i < 3 ? translation : rotation);
    return exp_se3(xi);
  }

  struct Scene {
    std::vector<Track> tracks;
    std::vector<Vector3d> points;
  };
  /// n landmarks, the disparities measured too small by `offset`.
  Scene scene(int n, double offset) {
    Scene s;
    for (int i = 0; i < n; ++i) {
      Track t;
      t.id = next_id_++;
      t.anchor = anchor_;
      t.pixel << static_cast<float>(uniform(20, 620)), static_cast<float>(uniform(20, 460));
      const double d = camera_.left.fx * camera_.baseline / uniform(1.0, 8.0);
      s.points.push_back(camera_.triangulate(t.pixel.x(), t.pixel.y(), d));
      t.disparity = d - offset + normal(sigma_.z());
      s.tracks.push_back(t);
    }
    return s;
  }
  /// Where the frame T sees them, with these errors beside what is new in it.
  void see(Scene& s, const Isometry3d& T, double offset, const std::vector<Vector3d>& errors = {}) {
    for (std::size_t i = 0; i < s.tracks.size(); ++i) {
      Track& t = s.tracks[i];
      const Vector3d Y = T * s.points[i];
      const Vector3d error = errors.empty() ? Vector3d::Zero() : errors[i];
      t.tracked = Y.z() > 0.3;
      if (!t.tracked) continue;
      t.left = (camera_.left.project(Y) + error.head<2>() +
                Eigen::Vector2d(normal(options_.sigma_left), normal(options_.sigma_left)))
                   .cast<float>();
      t.right = static_cast<float>(camera_.left.project(Y - Vector3d(camera_.baseline, 0, 0)).x() +
                                   offset + error[2] + normal(options_.sigma_right));
      t.has_right = true;
    }
  }
};

TEST_F(DriftMeasurements, MotionShowsAnErrorOfTheDisparitiesZero) {
  // 30 views, each with its own points, all disparities measured 0.2 px too small.
  CalibrationMatrix calibration = CalibrationMatrix::Zero();
  calibration(kDisparityError, kDisparityError) = 0.09;
  PoseDrift drift(calibration);
  drift.begin(1, Matrix6d::Zero());
  double offset = 0.0;
  for (int k = 0; k < 30; ++k) {
    Isometry3d T = motion(0.05, 0.03);
    T.translation().z() -= 0.4;
    Scene s = scene(150, 0.2);
    see(s, T, 0.2);
    const TrackObservations seen = observe_tracks(s.tracks, sigma_, offset);
    const PoseEstimate e = refine_pose(camera_, seen.seen, {}, T, options_);
    ASSERT_TRUE(e.solved);
    const SharedErrorOptions shared;
    const DriftMeasurement measurement(camera_, s.tracks, seen, e, options_, shared, 1.0);
    drift.measure(measurement.of_pose());
    const auto evidence = measurement.of_disparity_zero(e.inlier);
    ASSERT_TRUE(evidence);
    EXPECT_NEAR(evidence->by_calibration[kDisparityError], 1.0, 1e-9);
    offset += drift.estimate(*evidence, 0.0, 0.09);
  }
  const double sigma = std::sqrt(drift.calibration_variance(kDisparityError));
  EXPECT_LT(sigma, 0.05);
  EXPECT_NEAR(offset, 0.2, 4.0 * sigma);
}

TEST_F(DriftMeasurements, AtRestTheZeroStaysUnknown) {
  CalibrationMatrix calibration = CalibrationMatrix::Zero();
  calibration(kDisparityError, kDisparityError) = 0.09;
  PoseDrift drift(calibration);
  drift.begin(1, Matrix6d::Zero());
  Scene s = scene(150, 0.2);
  see(s, Isometry3d::Identity(), 0.2);
  const TrackObservations seen = observe_tracks(s.tracks, sigma_, 0.0);
  const PoseEstimate e = refine_pose(camera_, seen.seen, {}, Isometry3d::Identity(), options_);
  const SharedErrorOptions shared;
  const auto evidence = DriftMeasurement(camera_, s.tracks, seen, e, options_, shared, 1.0)
                            .of_disparity_zero(e.inlier);
  if (evidence) drift.estimate(*evidence, 0.0, 0.09);
  EXPECT_GT(std::sqrt(drift.calibration_variance(kDisparityError)), 0.2);
}

/// Mean of NEES over trials: of a pose, and of the motion to another that sees the same landmarks.
using Means = std::array<double, 2>;

TEST_F(DriftMeasurements, TheCovarianceHoldsForErrorsThatLast) {
  NOT_UNDER_SANITIZERS("statistics repeat a step of other tests a thousand times");
  constexpr double kTexture = 0.5;  // [px]
  sigma_.z() = 0.01;
  const SharedErrorOptions shared{0.9, 0.2, 0.1, 1.0, 0.0};
  const auto means = [&](const SharedErrorOptions& assumed) {
    rng_.seed(8);
    constexpr int kTrials = 200;
    Means mean = {0.0, 0.0};
    for (int trial = 0; trial < kTrials; ++trial) {
      Scene s = scene(80, 0.0);
      for (Track& t : s.tracks) {
        t.left_covariance = kTexture * kTexture * Eigen::Matrix2d::Identity();
        t.right_variance = kTexture * kTexture;
      }
      std::map<std::uint64_t, Vector3d> drawn;
      const auto lasting = [&](std::uint64_t number, double share) -> Vector3d {
        const auto [at, is_new] = drawn.try_emplace(number, Vector3d::Zero());
        for (int k = 0; is_new && k < 3; ++k) at->second[k] = normal(1.0);
        return kTexture * std::sqrt(shared.lasting * share) * at->second;
      };
      PoseDrift drift;
      drift.begin(1, Matrix6d::Zero());
      Isometry3d truth[2], estimate[2];
      Matrix6d C;
      for (int f = 0; f < 2; ++f) {
        truth[f] = motion(0.2, 0.05);
        std::vector<Vector3d> errors;
        for (std::size_t i = 0; i < s.tracks.size(); ++i) {
          Track& t = s.tracks[i];
          t.left = camera_.left.project(truth[f] * s.points[i]).cast<float>();
          const ErrorNumbers n = error_numbers(t, camera_.left.width, camera_.left.height);
          errors.push_back(lasting(n.landmark, 1.0 - shared.area - shared.image) +
                           lasting(n.area, shared.area) + lasting(n.image, shared.image));
          for (double& x : errors.back()) x += normal(kTexture * std::sqrt(1.0 - shared.lasting));
        }
        see(s, truth[f], 0.0, errors);
        const TrackObservations seen = observe_tracks(s.tracks, sigma_, 0.0);
        const PoseEstimate e = refine_pose(camera_, seen.seen, {}, truth[f], options_);
        EXPECT_TRUE(e.solved);
        estimate[f] = e.T_CW;
        C = drift.measure(
            DriftMeasurement(camera_, s.tracks, seen, e, options_, assumed, 1.0).of_pose());
        if (f == 0) drift.add(2);
      }
      const auto nees = [](const Isometry3d& is, const Isometry3d& was,
                           const Matrix6d& covariance) {
        const Vector6d error = log_se3(was * is.inverse());
        return error.dot(covariance.ldlt().solve(error)) / 6.0;
      };
      const Isometry3d T = estimate[1] * estimate[0].inverse();
      mean[0] += nees(estimate[1], truth[1], C) / kTrials;
      mean[1] += nees(T, truth[1] * truth[0].inverse(), drift.since(2, T)) / kTrials;
    }
    return mean;
  };
  for (const double mean : means(shared)) {
    EXPECT_GT(mean, 0.8);
    EXPECT_LT(mean, 1.25);
  }
  // Taken for new in every frame they make poses too sure, and motions not sure enough.
  const Means independent = means({0.0, 0.0, 0.0, 1.0, 0.0});
  EXPECT_GT(independent[0], 1.5);
  EXPECT_LT(independent[1], 0.7);
}

// A few near points that are well seen, in a wrong place, draw the pose away from all others.
TEST_F(DriftMeasurements, APartOfTheImageThatAsksForAnotherPoseMakesItLessSure) {
  sigma_.z() = 0.01;
  Scene s = scene(60, 0.0);
  for (std::size_t i = 0; i < s.tracks.size(); ++i) {
    Track& t = s.tracks[i];
    const bool near = i < 4;
    if (near) t.pixel << 365.0f + 5.0f * static_cast<float>(i), 275.0f + 10.0f * (i % 2);
    t.disparity = camera_.left.fx * camera_.baseline / (near ? 1.0 : uniform(1.5, 8.0));
    s.points[i] = camera_.triangulate(t.pixel.x(), t.pixel.y(), t.disparity);
    t.left_covariance = (near ? 0.0 : 0.25) * Eigen::Matrix2d::Identity();
    t.right_variance = near ? 0.0 : 0.25;
  }
  const Isometry3d truth = motion(0.02, 0.02);
  const auto measured = [&](double shift, double& off) {
    std::vector<Vector3d> errors(s.tracks.size(), Vector3d::Zero());
    for (std::size_t i = 0; i < 4; ++i) errors[i] = shift * Vector3d(1, 0, 1);
    see(s, truth, 0.0, errors);
    const TrackObservations seen = observe_tracks(s.tracks, sigma_, 0.0);
    const PoseEstimate e = refine_pose(camera_, seen.seen, {}, truth, options_);
    EXPECT_TRUE(e.solved);
    PoseDrift drift;
    drift.begin(1, Matrix6d::Zero());
    const SharedErrorOptions shared;
    const Matrix6d C = drift.measure(
        DriftMeasurement(camera_, s.tracks, seen, e, options_, shared, 1.0).of_pose());
    off = log_se3(e.T_CW * truth.inverse()).head<3>().norm();
    return std::sqrt(C.topLeftCorner<3, 3>().trace());
  };
  double off = 0.0, off_by_them = 0.0;
  const double sure = measured(0.0, off), less_sure = measured(3.0, off_by_them);
  EXPECT_LT(off, 3.0 * sure);
  EXPECT_GT(off_by_them, 4.0 * sure);
  EXPECT_LT(off_by_them, 3.0 * less_sure);
}

}  // namespace
}  // namespace prospect::drift_measurement_test
