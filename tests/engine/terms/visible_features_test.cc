// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/visible_features.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <random>
#include <stdexcept>

#include "engine/features/occlusion_table.h"
#include "engine/maps/voxel_grid.h"
#include "models/make_model.h"
#include "tests/engine/visibility_scene.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::visible_features_test {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;
using visibility_scene::normal3;
using visibility_scene::output;
using visibility_scene::uniform;
using visibility_scene::walks;

constexpr const char* kModels[] = {"unicycle", "unicycle_accel", "holonomic", "multirotor"};

// Surface that depends on the present and all earlier poses:
//   A_k = 3 sin(0.5 x_k + yaw_k)^2 exp(-0.1 sum_{j<=k} y_j^2).
class WavySurface final : public NewSurface {
 public:
  void evaluate(const TrajectoryBatch& t, int b, TermScratch*, double* area) const override {
    double sum = 0.0;
    for (int k = 0; k <= t.horizon.N; ++k) {
      sum += t.py(k, b) * t.py(k, b);
      area[k] = 3.0 * std::pow(std::sin(phase(t, k, b)), 2) * std::exp(-0.1 * sum);
    }
  }
  void add_gradient(const TrajectoryBatch& t, int b, TermScratch*, const double* adjoint,
                    TermOutput& out) const override {
    double sum = 0.0;
    for (int k = 0; k <= t.horizon.N; ++k) {
      sum += t.py(k, b) * t.py(k, b);
      const double s = std::sin(phase(t, k, b));
      const double decay = 3.0 * std::exp(-0.1 * sum);
      const double d = adjoint[k] * decay * std::sin(2.0 * phase(t, k, b));
      out.add_pose_gradient(t, k, b, 0.5 * d, 0.0, 0.0, d);
      for (int j = 0; j <= k; ++j) {
        out.add_pose_gradient(t, j, b, 0.0, -adjoint[k] * decay * s * s * 0.2 * t.py(j, b), 0.0,
                              0.0);
      }
    }
  }

 private:
  static double phase(const TrajectoryBatch& t, int k, int b) {
    return 0.5 * t.px(k, b) + t.yaw(k, b);
  }
};

// A room with two pillars, everything else free.
VoxelGrid room() {
  GridFrame frame;
  frame.i0 = frame.j0 = -70;
  frame.width = frame.height = 140;
  VoxelGrid voxels(frame, -1.0, 2.5);
  for (int j = -70; j < 70; ++j) {
    for (int i = -70; i < 70; ++i) {
      const bool solid = (std::abs(i - 15) < 5 && std::abs(j - 5) < 4) ||
                         (std::abs(i + 14) < 3 && std::abs(j + 9) < 6);
      for (int k = -10; k < 25; ++k) {
        voxels.set(i, j, k, solid ? CellState::kOccupied : CellState::kFree);
      }
    }
  }
  return voxels;
}

std::shared_ptr<const OcclusionTable> pillars(const std::vector<Landmark>& landmarks,
                                              bool vertical) {
  static const VoxelGrid voxels = room();
  std::vector<Vector3d> points;
  for (const Landmark& l : landmarks) points.push_back(l.position);
  return std::make_shared<const OcclusionTable>(
      SensorLattice::around({0, 0, 0.45}, 2.5, 0.25, vertical), points, voxels,
      OcclusionTable::Options{});
}

double value(const Term& term, const TrajectoryBatch& t, TermScratch* scratch) {
  TermOutput out = output(t);
  term.evaluate(t, {false}, scratch, out);
  return out.value(0, 0);
}

// Largest difference between the gradient and fourth-order central differences, over all states,
// and the largest component.
struct GradientCheck {
  double error = 0.0;
  double size = 0.0;
};

GradientCheck check_gradient(const Term& term, TrajectoryBatch t) {
  const auto scratch = term.make_scratch(t.horizon, 1);
  TermOutput out = output(t);
  term.evaluate(t, {true}, scratch.get(), out);
  // The occlusion table sums in another order with derivatives than without.
  EXPECT_NEAR(out.value(0, 0), value(term, t, scratch.get()), 1e-13);
  EXPECT_EQ(out.input_gradient.abs().maxCoeff(), 0.0);
  GradientCheck result;
  const double h = 2e-5;
  for (Eigen::Index i = 0; i < t.states.rows(); ++i) {
    const double x = t.states(i, 0);
    const auto at = [&](double step) {
      t.states(i, 0) = x + step;
      const double v = value(term, t, scratch.get());
      t.states(i, 0) = x;
      return v;
    };
    const double numeric = (8.0 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12.0 * h);
    result.error = std::max(result.error, std::abs(numeric - out.state_gradient(i, 0)));
    result.size = std::max(result.size, std::abs(numeric));
  }
  return result;
}

TEST(VisibleFeatures, GradientIsExactForEveryModelAndCriterion) {
  NOT_UNDER_SANITIZERS("over many points, where other tests go the same ways at few");
  std::mt19937_64 rng(41);
  double worst = 0.0;
  for (const char* name : kModels) {
    const auto model = make_model(name);
    for (int trial = 0; trial < 24; ++trial) {
      const auto landmarks = visibility_scene::landmarks(rng, 60, trial % 3 == 0 ? 0.2 : 0.03);
      CameraMount mount;
      mount.T_BC = CameraMount::forward_facing({0.2, 0.1, 0.45}, uniform(rng, -0.8, 0.8),
                                               uniform(rng, -0.3, 0.4));
      VisibilityParameters p;
      p.border_sigma_px = trial % 2 ? 8.0 : 2.0;
      // Large noise, so that the recursion and its dependence on the counts weigh in.
      p.odometry = {0.02, 0.02, 0.01, 0.02, 200.0, 2.0, trial % 2 ? 0.2 : 0.0};
      VisibleFeaturesParameters f;
      f.criterion = trial % 4 < 2 ? VisibilityCriterion::kCount : VisibilityCriterion::kInformation;
      f.chance_weight = trial % 5 == 0 ? 0.7 : 0.0;
      f.rho = trial % 3 == 1 ? 2.0 : 0.0;
      const auto prediction = std::make_shared<const VisibilityPrediction>(
          landmarks, StereoCamera{}, mount,
          trial % 4 == 1 || trial % 4 == 2 ? pillars(landmarks, model->pose_layout().pz >= 0)
                                           : nullptr,
          p);
      const TrajectoryBatch t = walks(rng, *model, 6, 0.3, 1);
      const auto surface = std::make_shared<const WavySurface>();
      const VisibleFeatures term(prediction, f, surface);
      const VisibleFeaturesChance chance(prediction, f, surface);
      for (const Term* each :
           {static_cast<const Term*>(&term), static_cast<const Term*>(&chance)}) {
        const GradientCheck g = check_gradient(*each, t);
        EXPECT_GT(g.size, 1e-6);
        EXPECT_LT(g.error, 2e-7 * std::max(1.0, g.size)) << name << " trial " << trial;
        worst = std::max(worst, g.error / std::max(1.0, g.size));
      }
    }
  }
  std::printf("largest gradient error relative to max(1, |g|): %.1e\n", worst);
}

TEST(VisibleFeatures, GradientReachesThroughTheRecursion) {
  // The cost at the last stage feels a change of an early pose that leaves all others as they are,
  // through Sigma_rel alone; and this vanishes without odometry noise.
  std::mt19937_64 rng(43);
  const auto model = make_model("unicycle");
  const auto landmarks = visibility_scene::landmarks(rng, 100);
  TrajectoryBatch t = walks(rng, *model, 5, 0.3, 1);
  for (const bool noisy : {true, false}) {
    VisibilityParameters p;
    if (noisy) {
      p.odometry = {0.05, 0.05, 0.05, 0.05, 200.0, 2.0};
    } else {
      p.odometry = {0.0, 0.0, 0.0, 0.0, 200.0, 2.0};
    }
    const VisibilityPrediction prediction(landmarks, {}, {}, nullptr, p);
    const auto scratch = prediction.make_scratch(t.horizon);
    VisibilityPrediction::Request request;
    request.gradient = true;
    ASSERT_TRUE(prediction.propagate(t, 0, request, nullptr, *scratch));
    auto& stages = VisibilityPrediction::stages(*scratch);
    stages.count_adjoint.assign(6, 0.0);
    stages.count_adjoint[5] = 1.0;
    TermOutput out = output(t);
    prediction.pull_back(t, 0, *scratch, out);
    const double early = out.state_gradient.topRows(5 * model->nx()).abs().maxCoeff();
    if (noisy) {
      EXPECT_GT(early, 1e-3);
    } else {
      EXPECT_EQ(early, 0.0);
    }
  }
}

TEST(VisibleFeatures, CostVanishesOnceEnoughIsVisible) {
  double slope;
  EXPECT_NEAR(visible_features_cost(0.0, 60.0, 0.2), 1.0, 1e-5);
  for (const double N : {130.0, 200.0, 1000.0, 1e6}) {
    EXPECT_LT(visible_features_cost(N, 60.0, 0.2, &slope), 1e-12);
    EXPECT_LT(std::abs(slope), 1e-13);
  }
  for (double N = 0.0; N < 120.0; N += 3.7) {
    const double h = 1e-4;
    const double numeric =
        (visible_features_cost(N + h, 60.0, 0.2) - visible_features_cost(N - h, 60.0, 0.2)) /
        (2.0 * h);
    visible_features_cost(N, 60.0, 0.2, &slope);
    EXPECT_NEAR(slope, numeric, 1e-9);
    EXPECT_LE(slope, 0.0);
    double by_N, by_variance;
    visible_features_chance(N, 4.0, 20.0, 1.645, 1.0, &by_N, &by_variance);
    const auto chi = [](double n, double v) {
      return visible_features_chance(n, v, 20.0, 1.645, 1.0);
    };
    EXPECT_NEAR(by_N, (chi(N + h, 4.0) - chi(N - h, 4.0)) / (2.0 * h), 1e-8);
    EXPECT_NEAR(by_variance, (chi(N, 4.0 + h) - chi(N, 4.0 - h)) / (2.0 * h), 1e-8);
    // Within log(2)/beta of the exact penalty.
    const double exact = std::max(0.0, 20.0 + 1.645 * std::sqrt(4.01) - N) / 20.0;
    EXPECT_GE(chi(N, 4.0), exact);
    EXPECT_LT(chi(N, 4.0), exact + std::log(2.0) / 20.0 + 1e-12);
  }
}

TEST(VisibleFeatures, ValueIsTheMeanOverStagesOfTheFormula) {
  std::mt19937_64 rng(44);
  const auto model = make_model("holonomic");
  const auto landmarks = visibility_scene::landmarks(rng, 200);
  const auto prediction = std::make_shared<const VisibilityPrediction>(
      landmarks, StereoCamera{}, CameraMount{}, nullptr, VisibilityParameters{});
  const TrajectoryBatch t = walks(rng, *model, 8, 0.25, 1);
  VisibleFeaturesParameters f;
  f.chance_weight = 0.3;
  const VisibleFeatures term(prediction, f);
  f.chance_weight = 0.0;
  const VisibleFeatures plain(prediction, f);
  const VisibleFeaturesChance chance(prediction, f);
  const auto sigma = prediction->relative_covariances(t, 0);
  Eigen::ArrayXd mu(200);
  for (int i = 0; i < 200; ++i) mu[i] = landmarks[static_cast<std::size_t>(i)].multiplicity;
  double psi = 0.0, chi = 0.0;
  for (int k = 1; k <= 8; ++k) {
    const Eigen::ArrayXd pi =
        prediction->probabilities(t.pose(k, 0), sigma[static_cast<std::size_t>(k)]).array();
    const double N = (mu * pi).sum(), variance = (mu * pi * (1.0 - pi)).sum();
    psi += std::pow(std::log1p(std::exp(0.2 * (f.N_req - N))) / 0.2 / f.N_req, 2) / 8.0;
    chi += std::log1p(std::exp(20.0 + 1.645 * std::sqrt(variance + 0.01) - N)) / 20.0 / 8.0;
  }
  EXPECT_NEAR(value(plain, t, plain.make_scratch(t.horizon, 1).get()), psi, 1e-12);
  EXPECT_NEAR(value(chance, t, chance.make_scratch(t.horizon, 1).get()), chi, 1e-12);
  EXPECT_NEAR(value(term, t, term.make_scratch(t.horizon, 1).get()), psi + 0.3 * chi, 1e-12);
}

TEST(VisibleFeatures, InformationEqualsDirectComputation) {
  std::mt19937_64 rng(45);
  const auto model = make_model("multirotor");
  const auto landmarks = visibility_scene::landmarks(rng, 80);
  CameraMount mount;
  mount.T_BC = CameraMount::forward_facing({0.1, -0.2, 0.3}, 0.4, 0.2);
  VisibilityParameters p;
  p.odometry = {0.02, 0.02, 0.01, 0.02, 200.0, 2.0, 0.1};
  const StereoCamera camera;
  const VisibilityPrediction prediction(landmarks, camera, mount, nullptr, p);
  const TrajectoryBatch t = walks(rng, *model, 6, 0.3, 1);
  const auto scratch = prediction.make_scratch(t.horizon);
  VisibilityPrediction::Request request;
  request.information = true;
  request.prior_translation = 11.0;
  request.prior_rotation = 100.0;
  ASSERT_TRUE(prediction.propagate(t, 0, request, nullptr, *scratch));
  const auto sigma = prediction.relative_covariances(t, 0);
  int informative = 0;
  for (int k = 0; k <= 6; ++k) {
    const auto n = static_cast<std::size_t>(k);
    const Pose pose = t.pose(k, 0);
    const Eigen::VectorXd pi = prediction.probabilities(pose, sigma[n]);
    Eigen::Matrix<double, 6, 6> I = Eigen::Matrix<double, 6, 6>::Zero();
    I.diagonal() << 11, 11, 11, 100, 100, 100;
    // The image of a point, for a base displaced in W by x.head(4) (x, y, z, yaw) and a camera
    // moved in its own frame by `moved` (translation, rotation vector); derivatives are numerical.
    const auto image = [&](const Vector3d& point, const Eigen::Vector4d& x,
                           const Eigen::Matrix<double, 6, 1>& moved) {
      Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
      T.translate(Vector3d(pose.position + x.head<3>()));
      T.rotate(Eigen::AngleAxisd(pose.yaw + x[3], Vector3d::UnitZ()));
      T = T * mount.T_BC;
      T.translate(Vector3d(moved.head<3>()));
      const Vector3d w = moved.tail<3>();
      if (w.norm() > 0) T.rotate(Eigen::AngleAxisd(w.norm(), w.normalized()));
      return camera.left.project(T.inverse() * point);
    };
    const Eigen::Vector4d x0 = Eigen::Vector4d::Zero();
    const Eigen::Matrix<double, 6, 1> m0 = Eigen::Matrix<double, 6, 1>::Zero();
    const double h = 1e-5;
    for (int i = 0; i < pi.size(); ++i) {
      if (pi[i] == 0.0) continue;
      const Landmark& l = landmarks[static_cast<std::size_t>(i)];
      Eigen::Matrix<double, 2, 4> Hx;
      Eigen::Matrix<double, 2, 3> Hl;
      Eigen::Matrix<double, 2, 6> H;
      for (int j = 0; j < 4; ++j) {
        const Eigen::Vector4d e = h * Eigen::Vector4d::Unit(j);
        Hx.col(j) = (image(l.position, e, m0) - image(l.position, -e, m0)) / (2.0 * h);
      }
      for (int j = 0; j < 3; ++j) {
        const Vector3d e = h * Vector3d::Unit(j);
        Hl.col(j) = (image(l.position + e, x0, m0) - image(l.position - e, x0, m0)) / (2.0 * h);
      }
      for (int j = 0; j < 6; ++j) {
        const Eigen::Matrix<double, 6, 1> e = h * Eigen::Matrix<double, 6, 1>::Unit(j);
        H.col(j) = (image(l.position, x0, e) - image(l.position, x0, -e)) / (2.0 * h);
      }
      const Eigen::Matrix2d S = Hx * sigma[n] * Hx.transpose() +
                                Hl * l.covariance * Hl.transpose() +
                                p.sigma_px * p.sigma_px * Eigen::Matrix2d::Identity();
      I += l.multiplicity * pi[i] * H.transpose() * S.inverse() * H;
    }
    const double expected = std::log(I.determinant());
    EXPECT_NEAR(VisibilityPrediction::stages(*scratch).log_det[n], expected, 1e-7);
    informative += expected > 3.0 * std::log(11.0) + 3.0 * std::log(100.0) + 1.0;
  }
  EXPECT_GT(informative, 3);
}

TEST(VisibleFeatures, EveryKernelGivesTheSameBits) {
  std::mt19937_64 rng(46);
  const auto model = make_model("multirotor");
  const auto landmarks = visibility_scene::landmarks(rng, 173);
  const TrajectoryBatch t = walks(rng, *model, 10, 0.3, 1);
  for (const auto criterion : {VisibilityCriterion::kCount, VisibilityCriterion::kInformation}) {
    VisibleFeaturesParameters f;
    f.criterion = criterion;
    f.chance_weight = 1.0;
    TermOutput first;
    for (const VisibilityKernel& kernel : available_visibility_kernels()) {
      const VisibleFeatures term(
          std::make_shared<const VisibilityPrediction>(landmarks, StereoCamera{}, CameraMount{},
                                                       nullptr, VisibilityParameters{}, kernel),
          f);
      TermOutput out = output(t);
      term.evaluate(t, {true}, term.make_scratch(t.horizon, 1).get(), out);
      if (first.value.size() == 0) first = out;
      EXPECT_EQ(out.value(0, 0), first.value(0, 0)) << kernel.name;
      EXPECT_EQ(out.value(0, 0), value(term, t, term.make_scratch(t.horizon, 1).get()));
      EXPECT_EQ(std::memcmp(out.state_gradient.data(), first.state_gradient.data(),
                            sizeof(double) * static_cast<std::size_t>(out.state_gradient.size())),
                0)
          << kernel.name;
    }
  }
}

/// The values of a batch, and its scores.
struct Scored {
  TermOutput exact, score;

  Scored(const VisibleFeatures& term, const TrajectoryBatch& t)
      : exact(output(t)), score(output(t)) {
    const auto scratch = term.make_scratch(t.horizon, static_cast<int>(t.states.cols()));
    term.evaluate(t, {}, scratch.get(), exact);
    term.evaluate(t, {.score = true}, scratch.get(), score);
  }
  double error() const {
    return ((score.value - exact.value).abs() / exact.value.abs().max(1.0)).maxCoeff();
  }
};

TEST(VisibleFeatures, ScoresAreTheValueInSinglePrecision) {
  // Also far from the origin, where single precision could not hold a position.
  std::mt19937_64 rng(48);
  std::map<VisibilityCriterion, double> worst;
  for (const char* name : kModels) {
    const auto model = make_model(name);
    for (const double far : {0.0, 1e6}) {
      std::vector<Landmark> landmarks = visibility_scene::landmarks(rng, 173);
      TrajectoryBatch t = walks(rng, *model, 10, 0.3, 20);
      for (Landmark& l : landmarks) l.position.x() += far;
      for (int k = 0; k <= 10; ++k) t.states.row(k * model->nx() + t.layout.px) += far;
      for (const auto criterion :
           {VisibilityCriterion::kCount, VisibilityCriterion::kInformation}) {
        VisibleFeaturesParameters f;
        f.criterion = criterion;
        f.chance_weight = 0.1;
        TermOutput first;
        for (const VisibilityKernel& kernel : available_visibility_kernels()) {
          const VisibleFeatures term(
              std::make_shared<const VisibilityPrediction>(landmarks, StereoCamera{}, CameraMount{},
                                                           nullptr, VisibilityParameters{}, kernel),
              f);
          EXPECT_TRUE(term.traits().scores);
          const Scored scored(term, t);
          if (first.value.size() == 0) first = scored.score;
          EXPECT_TRUE((scored.score.value == first.value).all()) << kernel.name;
          worst[criterion] = std::max(worst[criterion], scored.error());
        }
      }
    }
  }
  for (const auto& [criterion, error] : worst) {
    EXPECT_LT(error, kScoreError / 3.0);
    EXPECT_GT(error, 0.0);
  }
}

// In missions the landmarks in view may fill a patch of wall, with covariances that are long in one
// direction, and more stand just outside the image: with all of a score in single precision the
// cost was off by up to 1.2e-4.
TEST(VisibleFeatures, ScoresHoldWhereTheInformationIsWeak) {
  std::mt19937_64 rng(53);
  const auto model = make_model("unicycle");
  VisibleFeaturesParameters f;
  f.criterion = VisibilityCriterion::kInformation;
  double worst = 0.0;
  int weak = 0;
  for (int scene = 0; scene < 60; ++scene) {
    std::vector<Landmark> landmarks = visibility_scene::landmarks(rng, 60, 0.01);
    const double azimuth = visibility_scene::uniform(rng, -3.0, 3.0);
    const double width = std::pow(10.0, visibility_scene::uniform(rng, -2.0, 0.0));
    for (Landmark& l : landmarks) {
      const Eigen::Vector2d ahead(std::cos(azimuth), std::sin(azimuth));
      const Eigen::Vector2d beside(-ahead.y(), ahead.x());
      l.position.head<2>() = 3.5 * ahead + visibility_scene::uniform(rng, -width, width) * beside;
      l.position.z() = 0.8 + visibility_scene::uniform(rng, -width, width);
      l.creation_direction = -l.position.normalized();
      l.creation_range = l.position.norm();
      const Eigen::Vector3d along = visibility_scene::normal3(rng);
      l.covariance += 0.1 * along * along.transpose();
      l.multiplicity = 20.0;
    }
    const TrajectoryBatch t = walks(rng, *model, 10, 0.3, 20);
    const VisibleFeatures term(
        std::make_shared<const VisibilityPrediction>(landmarks, StereoCamera{}, CameraMount{},
                                                     nullptr, VisibilityParameters{}),
        f);
    const Scored scored(term, t);
    worst = std::max(worst, scored.error());
    weak += static_cast<int>((scored.exact.value > 0.01 && scored.exact.value < 0.9).count());
  }
  EXPECT_GT(weak, 100);
  EXPECT_LT(worst, kScoreError / 3.0);
}

TEST(VisibleFeatures, BatchEqualsSingle) {
  std::mt19937_64 rng(47);
  for (const char* name : kModels) {
    const auto model = make_model(name);
    const auto landmarks = visibility_scene::landmarks(rng, 120);
    const auto prediction = std::make_shared<const VisibilityPrediction>(
        landmarks, StereoCamera{}, CameraMount{}, pillars(landmarks, model->pose_layout().pz >= 0),
        VisibilityParameters{});
    VisibleFeaturesParameters f;
    f.rho = 1.0;
    f.chance_weight = 1.0;
    const VisibleFeatures term(prediction, f, std::make_shared<const WavySurface>());
    const TrajectoryBatch t = walks(rng, *model, 7, 0.3, 40);
    TermOutput all = output(t);
    const auto scratch = term.make_scratch(t.horizon, 40);
    term.evaluate(t, {false}, scratch.get(), all);
    for (int b = 0; b < 40; ++b) {
      TrajectoryBatch one = t;
      one.states = t.states.col(b);
      one.inputs = t.inputs.col(b);
      EXPECT_EQ(value(term, one, scratch.get()), all.value(0, b));
      const auto counts = term.visible(t, b), single = term.visible(one, 0);
      EXPECT_EQ(counts, single);
    }
  }
}

TEST(VisibleFeatures, NothingVisibleCostsOne) {
  std::mt19937_64 rng(48);
  const auto model = make_model("unicycle");
  const TrajectoryBatch t = walks(rng, *model, 5, 0.3, 1);
  const auto prediction = std::make_shared<const VisibilityPrediction>(
      std::vector<Landmark>{}, StereoCamera{}, CameraMount{}, nullptr, VisibilityParameters{});
  for (const auto criterion : {VisibilityCriterion::kCount, VisibilityCriterion::kInformation}) {
    VisibleFeaturesParameters f;
    f.criterion = criterion;
    const VisibleFeatures term(prediction, f);
    const auto scratch = term.make_scratch(t.horizon, 1);
    TermOutput out = output(t);
    term.evaluate(t, {true}, scratch.get(), out);
    // The count is above 1 by what the softplus is above the ramp at N = 0: e^-6 / 6 for N_req
    // = 30.
    const double ramp = f.beta * f.N_req;
    const double softplus = std::pow(std::log1p(std::exp(ramp)) / ramp, 2);
    const bool counts = criterion == VisibilityCriterion::kCount;
    EXPECT_NEAR(out.value(0, 0), counts ? softplus : 1.0, 1e-12);
    EXPECT_NEAR(out.value(0, 0), 1.0, 1e-3);
    EXPECT_EQ(out.state_gradient.abs().maxCoeff(), 0.0);
  }
}

TEST(VisibleFeatures, DegenerateInputsStayFinite) {
  std::mt19937_64 rng(49);
  const auto run = [&](const Term& term, const TrajectoryBatch& t, const std::string& what) {
    TermOutput out = output(t);
    term.evaluate(t, {true}, term.make_scratch(t.horizon, 1).get(), out);
    EXPECT_TRUE(std::isfinite(out.value(0, 0))) << what;
    EXPECT_GE(out.value(0, 0), 0.0) << what;
    EXPECT_TRUE(out.state_gradient.isFinite().all()) << what;
  };
  for (const char* name : {"unicycle", "multirotor"}) {
    const auto model = make_model(name);
    for (int trial = 0; trial < 400; ++trial) {
      auto landmarks = visibility_scene::landmarks(rng, trial % 40);
      TrajectoryBatch t = walks(rng, *model, 5, 0.3, 1);
      if (trial % 3 == 0) t = walks(rng, *model, 5, 0.3, 1, 0.0, 0.0);  // standing still
      if (trial % 7 == 0) t.states *= 1e5;                              // absurd displacements
      const CameraMount mount;
      VisibilityParameters p;
      if (trial % 11 == 0) p.odometry = {1e3, 1e3, 1e2, 1e2, 200.0, 1e-3};
      const VisibilityPrediction where({}, {}, mount, nullptr, p);
      for (std::size_t i = 0; i < landmarks.size(); ++i) {
        Landmark& l = landmarks[i];
        const int k = static_cast<int>(rng() % 6);
        const Vector3d camera = where.sensor_position(t.pose(k, 0));
        switch ((trial + static_cast<int>(i)) % 8) {
          case 0:
            l.position = camera;
            break;  // at the camera's centre
          case 1:
            l.position = camera + 1e-9 * normal3(rng);
            break;
          case 2:
            l.position = camera + Vector3d(0, 0, 1.0);
            break;  // in the camera's plane
          case 3:
            l.covariance.setZero();
            break;
          case 4:
            l.covariance = 1e12 * Eigen::Matrix3d::Ones();
            break;  // huge and singular
          case 5:
            l.creation_range = 1e-300;
            break;
          case 6:
            l.position *= 1e6;
            break;
          default:
            l.creation_range = 1e300;
            break;
        }
      }
      VisibleFeaturesParameters f;
      f.criterion = trial % 2 ? VisibilityCriterion::kCount : VisibilityCriterion::kInformation;
      f.chance_weight = 1.0;
      const auto prediction = std::make_shared<const VisibilityPrediction>(
          landmarks, StereoCamera{}, mount, nullptr, p);
      run(VisibleFeatures(prediction, f), t, std::string(name) + std::to_string(trial));
      const Eigen::VectorXd pi = prediction->probabilities(t.pose(2, 0));
      EXPECT_TRUE(pi.allFinite() && (pi.array() > -1e-12).all() && (pi.array() <= 1.0).all());
    }
  }
}

TEST(VisibleFeatures, NotANumberIsReportedAsNotEvaluable) {
  std::mt19937_64 rng(50);
  const auto model = make_model("unicycle");
  const auto landmarks = visibility_scene::landmarks(rng, 20);
  const VisibleFeatures term(
      std::make_shared<const VisibilityPrediction>(landmarks, StereoCamera{}, CameraMount{},
                                                   nullptr, VisibilityParameters{}),
      {});
  TrajectoryBatch t = walks(rng, *model, 4, 0.3, 2);
  t.states(6, 0) = std::numeric_limits<double>::quiet_NaN();
  TermOutput out = output(t);
  term.evaluate(t, {false}, term.make_scratch(t.horizon, 2).get(), out);
  EXPECT_FALSE(std::isfinite(out.value(0, 0)));
  EXPECT_TRUE(std::isfinite(out.value(0, 1)));
}

TEST(VisibleFeatures, RefusesBadParameters) {
  const auto prediction = std::make_shared<const VisibilityPrediction>(
      std::vector<Landmark>{}, StereoCamera{}, CameraMount{}, nullptr, VisibilityParameters{});
  EXPECT_THROW(VisibleFeatures(nullptr, {}), std::invalid_argument);
  const auto refused = [&](auto change) {
    VisibleFeaturesParameters p;
    change(p);
    EXPECT_THROW(VisibleFeatures(prediction, p), std::invalid_argument);
  };
  refused([](auto& p) { p.N_req = 0.0; });
  refused([](auto& p) { p.beta = std::numeric_limits<double>::quiet_NaN(); });
  refused([](auto& p) { p.rho = 3.0; });  // without a source of newly seen surface
  refused([](auto& p) { p.required_translation = 1.0; });
  refused([](auto& p) { p.chance_weight = -1.0; });
}

}  // namespace
}  // namespace prospect::visible_features_test
