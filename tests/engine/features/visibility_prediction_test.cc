// SPDX-License-Identifier: Apache-2.0
#include "engine/features/visibility_prediction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <stdexcept>

#include "engine/features/occlusion_table.h"
#include "engine/maps/voxel_grid.h"
#include "models/make_model.h"
#include "tests/engine/visibility_scene.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::visibility_prediction_test {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector4d;
using visibility_scene::normal3;
using visibility_scene::uniform;

Vector3d in_camera(const Vector3d& point, const Vector4d& pose, const CameraMount& mount) {
  Eigen::Isometry3d T_WB = Eigen::Isometry3d::Identity();
  T_WB.translate(Vector3d(pose.head<3>()));
  T_WB.rotate(Eigen::AngleAxisd(pose[3], Vector3d::UnitZ()));
  return (T_WB * mount.T_BC).inverse() * point;
}

double phi_between(double a, double b) {
  return 0.5 * (std::erfc(-b / std::sqrt(2.0)) - std::erfc(-a / std::sqrt(2.0)));
}

double logistic(double x) { return 1.0 / (1.0 + std::exp(-x)); }

// pi of one landmark without occlusion, from the formula, with numerical Jacobians of the
// projection.
double reference_probability(const Landmark& l, const Pose& pose, const Matrix4d& sigma,
                             const StereoCamera& camera, const CameraMount& mount,
                             const VisibilityParameters& p, double near_depth) {
  Vector4d x;
  x << pose.position, pose.yaw;
  const Vector3d Y = in_camera(l.position, x, mount);
  if (Y.z() <= near_depth) return 0.0;
  const auto project = [&](const Vector4d& at, const Vector3d& point) {
    return camera.left.project(in_camera(point, at, mount));
  };
  const double h = 1e-5;
  Eigen::Matrix<double, 2, 4> Hx;
  for (int i = 0; i < 4; ++i) {
    Hx.col(i) = (project(x + h * Vector4d::Unit(i), l.position) -
                 project(x - h * Vector4d::Unit(i), l.position)) /
                (2.0 * h);
  }
  Eigen::Matrix<double, 2, 3> Hl;
  for (int i = 0; i < 3; ++i) {
    Hl.col(i) = (project(x, l.position + h * Vector3d::Unit(i)) -
                 project(x, l.position - h * Vector3d::Unit(i))) /
                (2.0 * h);
  }
  const Eigen::Matrix2d S = Hx * sigma * Hx.transpose() + Hl * l.covariance * Hl.transpose() +
                            (p.sigma_px * p.sigma_px + p.border_sigma_px * p.border_sigma_px) *
                                Eigen::Matrix2d::Identity();
  const Vector2d image = project(x, l.position);
  const double disparity = camera.left.fx * camera.baseline / Y.z();
  const double su = std::sqrt(S(0, 0)), sv = std::sqrt(S(1, 1));
  const double in_u = phi_between((p.border_px + disparity - image.x()) / su,
                                  (camera.left.width - p.border_px - image.x()) / su);
  const double in_v = phi_between((p.border_px - image.y()) / sv,
                                  (camera.left.height - p.border_px - image.y()) / sv);
  const double scale = Y.norm() / l.creation_range;
  Eigen::Isometry3d T_WB = Eigen::Isometry3d::Identity();
  T_WB.translate(pose.position);
  T_WB.rotate(Eigen::AngleAxisd(pose.yaw, Vector3d::UnitZ()));
  const Vector3d to_camera = (T_WB * mount.T_BC).translation() - l.position;
  const double cosine = to_camera.normalized().dot(l.creation_direction.normalized());
  const double range = logistic((Y.z() - p.r_min) / p.r_min_width) *
                       logistic((p.r_max - Y.z()) / p.r_max_width) *
                       logistic((scale - p.scale_min) / p.scale_width) *
                       logistic((p.scale_max - scale) / p.scale_width);
  const double view =
      logistic((cosine - std::cos(p.view_angle)) / (std::sin(p.view_angle) * p.view_angle_width));
  const double t = std::min(1.0, Y.z() / near_depth - 1.0);
  const double gate = t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
  const double m = l.per_cell * Y.z() * Y.z();
  const double cell = (6.0 + m) / (6.0 + 4.0 * m + m * m);
  EXPECT_NEAR(cell, m > 0.0 ? -std::expm1(-m) / m : 1.0, 0.02);
  return l.survival * in_u * in_v * range * view * gate * cell;
}

Matrix4d random_sigma(std::mt19937_64& rng, double position, double yaw) {
  std::normal_distribution<double> n;
  Matrix4d L;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) L(i, j) = (i == 3 ? yaw : position) * 0.5 * n(rng);
  }
  return L * L.transpose();
}

TEST(VisibilityPrediction, ProbabilityEqualsTheFormula) {
  std::mt19937_64 rng(5);
  double largest = 0.0, seen = 0.0;
  for (int trial = 0; trial < 60; ++trial) {
    const auto landmarks = visibility_scene::landmarks(rng, 101);
    CameraMount mount;
    mount.T_BC = CameraMount::forward_facing(0.3 * normal3(rng), uniform(rng, -1.0, 1.0),
                                             uniform(rng, -0.5, 0.5));
    VisibilityParameters p;
    p.border_sigma_px = uniform(rng, 0.0, 10.0);
    StereoCamera camera;
    camera.left.fy = 430.0;
    const VisibilityPrediction prediction(landmarks, camera, mount, nullptr, p);
    const Pose pose{0.4 * normal3(rng), uniform(rng, -7.0, 7.0)};
    const Matrix4d sigma = random_sigma(rng, 0.05, 0.03);
    const Eigen::VectorXd pi = prediction.probabilities(pose, sigma);
    ASSERT_EQ(pi.size(), 101);
    for (int i = 0; i < 101; ++i) {
      const double expected =
          reference_probability(landmarks[static_cast<std::size_t>(i)], pose, sigma, camera, mount,
                                p, prediction.near_depth());
      largest = std::max(largest, std::abs(pi[i] - expected));
      seen += pi[i];
      EXPECT_GE(pi[i], -1e-15);
      EXPECT_LE(pi[i], 1.0);
    }
  }
  EXPECT_LT(largest, 2e-8);
  EXPECT_GT(seen, 100.0);  // the comparison is about visible points, too
}

// P_fov alone: all other factors switched to one.
VisibilityParameters only_field_of_view() {
  VisibilityParameters p;
  p.border_px = 0.0;
  p.border_sigma_px = 0.0;
  p.r_min = 0.05;
  p.r_min_width = 1e-3;
  p.r_max = 100.0;
  p.scale_min = 0.0;
  p.scale_width = 1e-3;
  p.scale_max = 1e3;
  p.view_angle = 3.1;
  return p;
}

TEST(VisibilityPrediction, FieldOfViewAgreesWithMonteCarloOfTheFullProjection) {
  NOT_UNDER_SANITIZERS("over many points, where other tests go the same ways at few");
  // Pose, landmark and pixels drawn from their Gaussians, projected without linearisation into both
  // images. The prediction takes u and v as independent: since d Phi_2(h, k; r)/dr is the bivariate
  // density, at most 1 / (2 pi sqrt(1 - r^2)), the joint probability differs from the product of
  // marginals by at most asin|r| / (2 pi) at a corner. Beyond that only sampling and curvature
  // remain.
  std::mt19937_64 rng(17);
  std::normal_distribution<double> n;
  const VisibilityParameters p = only_field_of_view();
  const StereoCamera camera;
  const CameraMount mount;
  double sum = 0.0, largest = 0.0;
  int compared = 0, partial = 0;
  while (partial < 60) {
    Landmark l;
    // Directions over and around the border of the image.
    const double depth = uniform(rng, 1.5, 5.0);
    l.position = {depth, depth * uniform(rng, -0.85, 0.85), 0.45 + depth * uniform(rng, -0.6, 0.6)};
    l.covariance = visibility_scene::covariance(rng, 0.03);
    l.creation_direction = (Vector3d(0, 0, 0.45) - l.position).normalized();
    l.creation_range = 1.0;
    l.survival = 1.0;
    const Matrix4d sigma = random_sigma(rng, 0.04, 0.02);
    const VisibilityPrediction prediction({l}, camera, mount, nullptr, p);
    const double pi = prediction.probabilities(Pose{}, sigma)[0];
    const Eigen::LLT<Matrix4d> pose_root(sigma + 1e-12 * Matrix4d::Identity());
    const Eigen::LLT<Matrix3d> point_root(l.covariance);
    const int samples = 20000;
    int hits = 0, hits_u = 0, hits_v = 0, hits_right = 0;
    const Vector3d center = in_camera(l.position, Vector4d::Zero(), mount);
    const Vector2d image = camera.left.project(center);
    const double disparity = camera.left.fx * camera.baseline / center.z();
    Vector2d mean = Vector2d::Zero();
    Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
    for (int s = 0; s < samples; ++s) {
      Vector4d e;
      for (int i = 0; i < 4; ++i) e[i] = n(rng);
      const Vector4d pose = pose_root.matrixL() * e;
      const Vector3d Y = in_camera(l.position + point_root.matrixL() * normal3(rng), pose, mount);
      const Vector2d left = camera.left.project(Y) + p.sigma_px * Vector2d(n(rng), n(rng));
      const double right = left.x() - camera.left.fx * camera.baseline / Y.z();
      const bool in_left = left.x() <= camera.left.width;  // u_right >= 0 implies u_left >= 0
      const bool in_v = left.y() >= 0.0 && left.y() <= camera.left.height;
      hits += in_left && right >= 0.0 && in_v;
      hits_right += in_left && right >= 0.0;
      hits_u += in_left && left.x() >= disparity;
      hits_v += in_v;
      mean += left / samples;
      square += left * left.transpose() / samples;
    }
    const Eigen::Matrix2d S = square - mean * mean.transpose();
    const double correlation = std::abs(S(0, 1)) / std::sqrt(S(0, 0) * S(1, 1));
    const double joint = static_cast<double>(hits) / samples;
    const double product = static_cast<double>(hits_u) / samples * hits_v / samples;
    const double sampling = 4.0 * std::sqrt(0.25 / samples);
    const Vector2d bias = (mean - image).cwiseAbs().cwiseQuotient(S.diagonal().cwiseSqrt());
    const double curvature = 0.005 + 0.4 * bias.sum();
    const double disparity_effect = std::abs(hits_right - hits_u) / static_cast<double>(samples);
    EXPECT_NEAR(pi, product, sampling + curvature) << l.position.transpose();
    EXPECT_NEAR(
        pi, joint,
        std::asin(correlation) / (2.0 * 3.14159265) + disparity_effect + sampling + curvature)
        << l.position.transpose();
    sum += std::abs(pi - joint);
    largest = std::max(largest, std::abs(pi - joint));
    partial += joint > 0.05 && joint < 0.95;
    ++compared;
  }
  std::printf(
      "P_fov against Monte Carlo: mean error %.4f, largest %.4f, of %d (%d partly visible)\n",
      sum / compared, largest, compared, partial);
  EXPECT_LT(sum / compared, 0.005);
}

TEST(VisibilityPrediction, RelativeCovarianceAgreesWithNoisyOdometry) {
  std::mt19937_64 rng(23);
  std::normal_distribution<double> n;
  for (const char* name : {"unicycle", "multirotor"}) {
    const auto model = make_model(name);
    const int N = 12;
    const TrajectoryBatch t = visibility_scene::walks(rng, *model, N, 0.5, 1, 0.8, 0.6);
    VisibilityParameters p;
    p.odometry.yaw_per_metre = 0.003;
    p.odometry.scale = 0.05;
    const VisibilityPrediction prediction({}, {}, {}, nullptr, p);
    const auto sigma = prediction.relative_covariances(t, 0);
    ASSERT_EQ(sigma.size(), static_cast<std::size_t>(N + 1));
    EXPECT_EQ(sigma[0], Matrix4d::Zero());

    // A robot that drives what it believes to be the plan: every step's displacement is measured in
    // its own frame, with noise, and compounded on where it really is.
    const double inflation = (200.0 + 2.0) / 2.0;  // nothing visible
    const int samples = 30000;
    std::vector<Matrix4d> scatter(static_cast<std::size_t>(N + 1), Matrix4d::Zero());
    for (int s = 0; s < samples; ++s) {
      Pose real = t.pose(0, 0);
      const double stretch = p.odometry.scale * n(rng);  // the same at all stages
      for (int k = 0; k < N; ++k) {
        const Pose a = t.pose(k, 0), b = t.pose(k + 1, 0);
        const double metres = std::sqrt((b.position - a.position).squaredNorm() + 1e-6) - 1e-3;
        const double radians = std::sqrt(std::pow(b.yaw - a.yaw, 2) + 1e-6) - 1e-3;
        const double wp = inflation * (std::pow(p.odometry.position_per_metre, 2) * metres +
                                       std::pow(p.odometry.position_per_radian, 2) * radians);
        const double wy = inflation * (std::pow(p.odometry.yaw_per_metre, 2) * metres +
                                       std::pow(p.odometry.yaw_per_radian, 2) * radians);
        const Vector3d body =
            Eigen::AngleAxisd(-a.yaw, Vector3d::UnitZ()) * (b.position - a.position);
        Vector3d noise = std::sqrt(wp) * normal3(rng);
        if (t.layout.pz < 0) noise.z() = 0.0;
        real.position += Eigen::AngleAxisd(real.yaw, Vector3d::UnitZ()) * body + noise;
        real.yaw += b.yaw - a.yaw + std::sqrt(wy) * n(rng);
        Vector4d e;
        e << real.position - b.position + stretch * (b.position - t.pose(0, 0).position),
            real.yaw - b.yaw;
        scatter[static_cast<std::size_t>(k + 1)] += e * e.transpose() / samples;
      }
    }
    for (int k = 1; k <= N; ++k) {
      const Matrix4d& expected = scatter[static_cast<std::size_t>(k)];
      const Matrix4d& predicted = sigma[static_cast<std::size_t>(k)];
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
          // Four standard errors of a sample covariance, and 1 % for the curvature of the
          // compounding.
          const double scale = std::sqrt(predicted(i, i) * predicted(j, j));
          EXPECT_NEAR(expected(i, j), predicted(i, j),
                      (4.0 * std::sqrt(2.0 / samples) + 0.01) * scale + 1e-15)
              << name << " stage " << k << " entry " << i << "," << j;
        }
      }
      EXPECT_EQ(predicted(2, 2) > 0.0, t.layout.pz >= 0);
    }
  }
}

TEST(VisibilityPrediction, NoiseShrinksWithWhatIsVisible) {
  std::mt19937_64 rng(3);
  const auto model = make_model("unicycle");
  const TrajectoryBatch t = visibility_scene::walks(rng, *model, 1, 0.5, 1);
  const auto landmarks = visibility_scene::landmarks(rng, 400);
  const VisibilityPrediction none({}, {}, {}, nullptr, {});
  const VisibilityPrediction some(landmarks, {}, {}, nullptr, {});
  const double count = some.visible(t, 0)[0];
  ASSERT_GT(count, 5.0);
  EXPECT_NEAR(some.relative_covariances(t, 0)[1](0, 0),
              none.relative_covariances(t, 0)[1](0, 0) * 2.0 / (count + 2.0), 1e-18);
}

TEST(VisibilityPrediction, CountsAreSumsOverAllLandmarksAtEachStage) {
  std::mt19937_64 rng(4);
  const auto model = make_model("holonomic");
  const auto landmarks = visibility_scene::landmarks(rng, 150);
  Eigen::ArrayXd mu(150);
  for (int i = 0; i < 150; ++i) mu[i] = landmarks[static_cast<std::size_t>(i)].multiplicity;
  const VisibilityPrediction prediction(landmarks, {}, {}, nullptr, {});
  const TrajectoryBatch t = visibility_scene::walks(rng, *model, 10, 0.25, 3);
  const auto scratch = prediction.make_scratch(t.horizon);
  VisibilityPrediction::Request request;
  request.variance = true;
  for (int b = 0; b < 3; ++b) {
    ASSERT_TRUE(prediction.propagate(t, b, request, nullptr, *scratch));
    const auto& stages = VisibilityPrediction::stages(*scratch);
    const auto count = prediction.visible(t, b);
    const auto sigma = prediction.relative_covariances(t, b);
    for (int k = 0; k <= 10; ++k) {
      const auto n = static_cast<std::size_t>(k);
      const Eigen::ArrayXd pi = prediction.probabilities(t.pose(k, b), sigma[n]).array();
      EXPECT_NEAR(count[n], (mu * pi).sum(), 1e-12);
      EXPECT_EQ(count[n], stages.count[n]);
      EXPECT_NEAR(stages.variance[n], (mu * pi * (1.0 - pi)).sum(), 1e-12);
    }
  }
}

TEST(VisibilityPrediction, ALandmarkThatStandsForThreeIsAsThreeOfThem) {
  std::mt19937_64 rng(14);
  const auto model = make_model("holonomic");
  auto landmarks = visibility_scene::landmarks(rng, 120);
  std::vector<Landmark> repeated;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    Landmark l = landmarks[i];
    l.multiplicity = 1.0;
    const int times = static_cast<int>(i % 3) + 1;
    landmarks[i].multiplicity = times;
    for (int n = 0; n < times; ++n) repeated.push_back(l);
  }
  const VisibilityPrediction few(landmarks, {}, {}, nullptr, {});
  const VisibilityPrediction many(repeated, {}, {}, nullptr, {});
  const TrajectoryBatch t = visibility_scene::walks(rng, *model, 8, 0.25, 3);
  VisibilityPrediction::Request request;
  request.variance = true;
  request.information = true;
  const auto a = few.make_scratch(t.horizon), b = many.make_scratch(t.horizon);
  for (int walk = 0; walk < 3; ++walk) {
    ASSERT_TRUE(few.propagate(t, walk, request, nullptr, *a));
    ASSERT_TRUE(many.propagate(t, walk, request, nullptr, *b));
    const auto& x = VisibilityPrediction::stages(*a);
    const auto& y = VisibilityPrediction::stages(*b);
    for (std::size_t k = 0; k <= 8; ++k) {
      EXPECT_NEAR(x.count[k], y.count[k], 1e-10);
      EXPECT_NEAR(x.variance[k], y.variance[k], 1e-10);
      EXPECT_NEAR(x.log_det[k], y.log_det[k], 1e-9);
    }
  }
}

TEST(VisibilityPrediction, MeanAndVarianceAreThoseOfTheNumberSeen) {
  // The number of visible points is a sum of independent yes/no events; all 2^n outcomes counted.
  std::mt19937_64 rng(6);
  std::vector<Landmark> few;
  const CameraMount mount;
  while (few.size() < 10) {
    auto l = visibility_scene::landmarks(rng, 1)[0];
    const VisibilityPrediction one({l}, {}, mount, nullptr, {});
    const double pi = one.probabilities(Pose{})[0];
    l.multiplicity = 1.0;
    if (pi > 0.02) few.push_back(l);
  }
  const auto model = make_model("unicycle");
  TrajectoryBatch t = visibility_scene::walks(rng, *model, 1, 0.25, 1);
  t.states.setZero();
  const VisibilityPrediction prediction(few, {}, mount, nullptr, {});
  const Eigen::VectorXd pi = prediction.probabilities(Pose{});
  double mean = 0.0, square = 0.0;
  for (int outcome = 0; outcome < 1024; ++outcome) {
    double probability = 1.0;
    int seen = 0;
    for (int i = 0; i < 10; ++i) {
      const bool visible = outcome >> i & 1;
      probability *= visible ? pi[i] : 1.0 - pi[i];
      seen += visible;
    }
    mean += probability * seen;
    square += probability * seen * seen;
  }
  const auto scratch = prediction.make_scratch(t.horizon);
  VisibilityPrediction::Request request;
  request.variance = true;
  ASSERT_TRUE(prediction.propagate(t, 0, request, nullptr, *scratch));
  EXPECT_NEAR(VisibilityPrediction::stages(*scratch).count[0], mean, 1e-12);
  EXPECT_NEAR(VisibilityPrediction::stages(*scratch).variance[0], square - mean * mean, 1e-11);
}

TEST(VisibilityPrediction, OcclusionMultipliesEveryProbability) {
  std::mt19937_64 rng(8);
  const auto landmarks = visibility_scene::landmarks(rng, 90);
  GridFrame frame;
  frame.i0 = frame.j0 = -80;
  frame.width = frame.height = 160;
  VoxelGrid voxels(frame, -0.5, 2.5);
  for (int j = -80; j < 80; ++j) {
    for (int i = -80; i < 80; ++i) {
      for (int k = -5; k < 25; ++k)
        voxels.set(i, j, k, i == 12 ? CellState::kOccupied : CellState::kFree);
    }
  }
  std::vector<Vector3d> points;
  for (const Landmark& l : landmarks) points.push_back(l.position);
  const CameraMount mount;
  const auto table = std::make_shared<const OcclusionTable>(
      SensorLattice::around({0, 0, 0.45}, 1.0, 0.2), points, voxels, OcclusionTable::Options{});
  const VisibilityPrediction open(landmarks, {}, mount, nullptr, {});
  const VisibilityPrediction walled(landmarks, {}, mount, table, {});
  std::vector<double> P(landmarks.size());
  int hidden = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const Pose pose{{uniform(rng, -0.5, 0.5), uniform(rng, -0.5, 0.5), 0.0}, uniform(rng, -1, 1)};
    table->evaluate(walled.sensor_position(pose), P.data());
    const Eigen::VectorXd a = open.probabilities(pose), b = walled.probabilities(pose);
    for (int i = 0; i < a.size(); ++i) {
      EXPECT_NEAR(b[i], a[i] * P[static_cast<std::size_t>(i)], 1e-15);
      hidden += a[i] > 0.3 && b[i] < 0.01;
    }
  }
  EXPECT_GT(hidden, 10);
  points.pop_back();
  const auto shorter = std::make_shared<const OcclusionTable>(
      SensorLattice::around({0, 0, 0.45}, 1.0, 0.2), points, voxels, OcclusionTable::Options{});
  EXPECT_THROW(VisibilityPrediction(landmarks, {}, mount, shorter, {}), std::invalid_argument);
  points.push_back({9, 9, 9});
  const auto other = std::make_shared<const OcclusionTable>(
      SensorLattice::around({0, 0, 0.45}, 1.0, 0.2), points, voxels, OcclusionTable::Options{});
  EXPECT_THROW(VisibilityPrediction(landmarks, {}, mount, other, {}), std::invalid_argument);
}

TEST(VisibilityPrediction, NothingBehindTheCameraAndNoJumpAtItsPlane) {
  Landmark l;
  l.creation_direction = Vector3d(-1, 0, 0);
  l.creation_range = 0.2;
  l.survival = 1.0;
  VisibilityParameters p = only_field_of_view();
  p.r_min = 0.01;
  l.position = {0.0, 0.0, 0.45};
  const VisibilityPrediction prediction({l}, {}, {}, nullptr, p);
  double previous = 0.0;
  for (double back = -0.5; back < 0.5; back += 1e-4) {
    const double pi = prediction.probabilities(Pose{{-back, 0.0, 0.0}, 0.0})[0];
    if (back <= prediction.near_depth()) {
      EXPECT_EQ(pi, 0.0);
    }
    EXPECT_LT(std::abs(pi - previous), 0.01) << back;
    previous = pi;
  }
  EXPECT_GT(previous, 0.99);
}

TEST(VisibilityPrediction, RefusesBadInputInOneLine) {
  Landmark good;
  const auto message = [](const Landmark& l, const VisibilityParameters& p) -> std::string {
    try {
      VisibilityPrediction prediction({l}, {}, {}, nullptr, p);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message(good, {}), "");
  Landmark l = good;
  l.id = 42;
  l.position.x() = nan;
  EXPECT_THAT(message(l, {}), testing::HasSubstr("landmark 42"));
  l = good;
  l.covariance(1, 1) = -1.0;
  EXPECT_THAT(message(l, {}), testing::HasSubstr("eigenvalue"));
  l = good;
  l.survival = 1.5;
  EXPECT_THAT(message(l, {}), testing::HasSubstr("survival"));
  l.survival = 1.0;
  l.multiplicity = 0.0;
  EXPECT_THAT(message(l, {}), testing::HasSubstr("multiplicity is 0"));
  l.multiplicity = 1.0;
  l.per_cell = -0.5;
  EXPECT_THAT(message(l, {}), testing::HasSubstr("per_cell is -0.5"));
  l = good;
  l.creation_range = 0.0;
  EXPECT_THAT(message(l, {}), testing::HasSubstr("creation_range"));
  l = good;
  l.creation_direction.setZero();
  EXPECT_THAT(message(l, {}), testing::HasSubstr("creation_direction"));
  VisibilityParameters p;
  p.sigma_px = 0.0;
  EXPECT_THAT(message(good, p), testing::HasSubstr("sigma_px"));
  p = {};
  p.r_max = 0.1;
  EXPECT_THAT(message(good, p), testing::HasSubstr("r_max"));
  p = {};
  p.border_px = 400.0;
  EXPECT_THAT(message(good, p), testing::HasSubstr("border_px"));
}

TEST(VisibilityPrediction, PoseThatIsNotANumberIsNotEvaluable) {
  std::mt19937_64 rng(9);
  const auto model = make_model("unicycle");
  const auto landmarks = visibility_scene::landmarks(rng, 20);
  const VisibilityPrediction prediction(landmarks, {}, {}, nullptr, {});
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200}) {
    TrajectoryBatch t = visibility_scene::walks(rng, *model, 4, 0.25, 1);
    t.states(7, 0) = bad;
    const auto scratch = prediction.make_scratch(t.horizon);
    EXPECT_FALSE(prediction.propagate(t, 0, {}, nullptr, *scratch));
    EXPECT_TRUE(std::isnan(prediction.probabilities(Pose{{bad, 0, 0}, 0})[0]));
  }
}

}  // namespace
}  // namespace prospect::visibility_prediction_test
