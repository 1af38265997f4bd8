// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/exploration_gain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "engine/features/occlusion_table.h"
#include "models/multirotor.h"
#include "models/unicycle.h"
#include "tests/engine/term_derivatives.h"
#include "tests/engine/view_worlds.h"

namespace prospect::exploration_gain_test {
namespace {

using test::uniform;

struct Scene {
  ExplorationTargets targets;
  std::shared_ptr<const OcclusionTable> table;
  double total_mass = 0.0;
};

Scene scene(std::mt19937_64& random, int count, bool vertical = false) {
  Scene s;
  const VoxelGrid grid = test::hall(random, true, 15);
  for (int i = 0; i < count; ++i) {
    s.targets.targets.push_back(
        {{uniform(random, -5, 5), uniform(random, -5, 5), 0.45}, uniform(random, 0.01, 0.16)});
    s.total_mass += s.targets.targets.back().mass;
  }
  s.targets.reference_area = 2.5;
  s.table = std::make_shared<const OcclusionTable>(
      SensorLattice::around({0, 0, 0.45}, 3.0, 0.2, vertical), s.targets.positions(), grid,
      OcclusionTable::Options());
  return s;
}

/// p_ck one by one: the probability that the view of stage k resolves target c.
Eigen::MatrixXd look_probabilities(const Scene& s, const TrajectoryBatch& t, int b,
                                   const ExplorationGain::Options& o, bool discounted) {
  const FootprintVisibility view(RgbdFootprint(), CameraMount(), s.table);
  FootprintVisibility::Scratch scratch(view.size());
  Eigen::MatrixXd p(view.size(), t.horizon.N + 1);
  p.col(0).setZero();
  for (int k = 1; k <= t.horizon.N; ++k) {
    view.evaluate(t.pose(k, b), scratch, p.col(k).data());
    p.col(k) *= o.eta * (discounted ? std::exp(-k * t.horizon.dt / o.tau) : 1.0);
  }
  return p;
}

TEST(ExplorationGain, EqualsTheDoubleLoopAndTheMonteCarloOfViews) {
  std::mt19937_64 random(1);
  const Scene s = scene(random, 80);
  const Unicycle model;
  const ExplorationGain gain(s.targets, RgbdFootprint(), CameraMount(), s.table);
  const ExplorationGain::Options options;
  double largest = 0.0;
  for (int n = 0; n < 10; ++n) {
    const TrajectoryBatch t = test::random_trajectories(model, 12, 0.25, 1, random);
    const double value = test::evaluate(gain, t, false).value(0, 0);
    const Eigen::MatrixXd p = look_probabilities(s, t, 0, options, true);
    double loop = 0.0, sum_of_looks = 0.0;
    for (int c = 0; c < p.rows(); ++c) {
      double unseen = 1.0;
      for (int k = 1; k <= 12; ++k) unseen *= 1.0 - p(c, k);
      const double m = s.targets.targets[static_cast<std::size_t>(c)].mass;
      loop += m * (1.0 - unseen) / 2.5;
      sum_of_looks += m * p.row(c).sum() / 2.5;
    }
    EXPECT_NEAR(value, loop, 1e-12);
    EXPECT_LE(value, sum_of_looks + 1e-12);  // a union, not a sum
    EXPECT_LE(value, s.total_mass / 2.5);
    if (n < 2 || value > largest) {
      // Independent looks drawn at random; area of the targets seen at least once.
      constexpr int kTrials = 4000;
      double mean = 0.0, square = 0.0;
      for (int trial = 0; trial < kTrials; ++trial) {
        double area = 0.0;
        for (int c = 0; c < p.rows(); ++c) {
          bool seen = false;
          for (int k = 1; k <= 12; ++k) seen = (uniform(random, 0, 1) < p(c, k)) || seen;
          if (seen) area += s.targets.targets[static_cast<std::size_t>(c)].mass / 2.5;
        }
        mean += area / kTrials;
        square += area * area / kTrials;
      }
      const double error = std::sqrt(std::max(square - mean * mean, 0.0) / kTrials);
      EXPECT_NEAR(value, mean, 4.5 * error + 1e-9);
    }
    largest = std::max(largest, value);
  }
  EXPECT_GT(largest, 0.05);
}

TEST(ExplorationGain, StandingStillNeverEarnsMoreThanThereIs) {
  // One target in full view for 30 stages: many looks at one cell still explore one cell.
  const VoxelGrid grid = [] {
    VoxelGrid g(GridFrame{0.1, -80, -80, 160, 160}, 0.0, 1.0);
    for (int i = -80; i < 80; ++i) {
      for (int j = -80; j < 80; ++j) {
        for (int k = 0; k < 10; ++k) g.set(i, j, k, CellState::kFree);
      }
    }
    return g;
  }();
  ExplorationTargets targets;
  targets.targets.push_back({{2.0, 0.0, 0.45}, 0.16});
  targets.reference_area = 0.3;
  const auto table =
      std::make_shared<const OcclusionTable>(SensorLattice::around({0, 0, 0.45}, 1.0, 0.2),
                                             targets.positions(), grid, OcclusionTable::Options());
  const ExplorationGain gain(targets, RgbdFootprint(), CameraMount(), table);
  const Unicycle model;
  std::mt19937_64 random(1);
  TrajectoryBatch t = test::random_trajectories(model, 30, 0.25, 1, random);
  t.states.setZero();
  const double value = test::evaluate(gain, t, false).value(0, 0);
  EXPECT_GT(value, 0.99 * 0.16 / 0.3);
  EXPECT_LE(value, 0.16 / 0.3);
  // Looking later is worth less: turn to it at the end only.
  TrajectoryBatch late = t;
  for (int k = 0; k < 30; ++k) late.states(3 * k + 2, 0) = M_PI;
  EXPECT_LT(test::evaluate(gain, late, false).value(0, 0), 0.2 * value);
}

TEST(ExplorationGain, GradientMatchesDifferences) {
  std::mt19937_64 random(2);
  for (const bool vertical : {false, true}) {
    const Scene s = scene(random, 70, vertical);
    const ExplorationGain gain(s.targets, RgbdFootprint(), CameraMount(), s.table);
    const Unicycle unicycle;
    const Multirotor multirotor;
    const MotionModel& model = vertical ? static_cast<const MotionModel&>(multirotor) : unicycle;
    for (int n = 0; n < 6; ++n) {
      const TrajectoryBatch t = test::random_trajectories(model, 6, 0.25, 1, random);
      test::expect_derivative_matches_differences(gain, t, 0, 1e-5, 2e-6);
    }
  }
}

// Sensors leave some of what is in view unresolved: without this, plans stood before it, and every
// replan again.
TEST(ExplorationGain, LookingAgainFromThePresentPoseEarnsNothing) {
  std::mt19937_64 random(6);
  const Scene s = scene(random, 200);
  const Unicycle model;
  double without = 0.0;
  for (int n = 0; n < 20; ++n) {
    TrajectoryBatch t = test::random_trajectories(model, 12, 0.25, 1, random, 2.0);
    for (int k = 1; k <= 12; ++k) t.states.col(0).segment<3>(3 * k) = t.states.col(0).head<3>();
    const ExplorationGain gain(s.targets, RgbdFootprint(), CameraMount(), s.table, {},
                               t.pose(0, 0));
    EXPECT_EQ(test::evaluate(gain, t, true).value(0, 0), 0.0);
    const ExplorationGain any(s.targets, RgbdFootprint(), CameraMount(), s.table);
    without += test::evaluate(any, t, false).value(0, 0);
  }
  EXPECT_GT(without, 1.0) << "there was something half in view";
}

TEST(ExplorationGain, CountsTheShareOfABetterView) {
  std::mt19937_64 random(7);
  const Scene s = scene(random, 80);
  const Unicycle model;
  const ExplorationGain::Options options;
  const FootprintVisibility view(RgbdFootprint(), CameraMount(), s.table);
  FootprintVisibility::Scratch scratch(view.size());
  Eigen::VectorXd seen(view.size()), v(view.size());
  int better = 0;
  for (int n = 0; n < 20; ++n) {
    const TrajectoryBatch t = test::random_trajectories(model, 12, 0.25, 1, random);
    const ExplorationGain gain(s.targets, RgbdFootprint(), CameraMount(), s.table, options,
                               t.pose(0, 0));
    view.evaluate(t.pose(0, 0), scratch, seen.data());
    Eigen::VectorXd unseen = Eigen::VectorXd::Ones(view.size());
    for (int k = 1; k <= 12; ++k) {
      view.evaluate(t.pose(k, 0), scratch, v.data());
      for (int c = 0; c < view.size(); ++c) {
        const double q =
            v[c] > seen[c] ? std::pow(v[c] - seen[c], 2) / (v[c] * (1.0 - seen[c])) : 0.0;
        better += seen[c] > 0.01 && q > 0.01;
        unseen[c] *= 1.0 - options.eta * std::exp(-k * 0.25 / options.tau) * q;
      }
    }
    double expected = 0.0;
    for (int c = 0; c < view.size(); ++c) {
      expected += s.targets.targets[static_cast<std::size_t>(c)].mass * (1.0 - unseen[c]) / 2.5;
    }
    EXPECT_NEAR(test::evaluate(gain, t, false).value(0, 0), expected, 1e-12);
  }
  EXPECT_GT(better, 20);
  const Pose nowhere{{std::nan(""), 0.0, 0.0}, 0.0};
  EXPECT_THROW(ExplorationGain(s.targets, RgbdFootprint(), CameraMount(), s.table, {}, nowhere),
               std::invalid_argument);
}

TEST(ExplorationGain, GradientMatchesDifferencesWithAPresentPose) {
  std::mt19937_64 random(8);
  const Scene s = scene(random, 150);
  const Unicycle model;
  for (int n = 0; n < 12; ++n) {
    const TrajectoryBatch t = test::random_trajectories(model, 6, 0.25, 1, random);
    const ExplorationGain gain(s.targets, RgbdFootprint(), CameraMount(), s.table, {},
                               t.pose(0, 0));
    test::expect_derivative_matches_differences(gain, t, 0, 1e-5, 2e-6);
  }
}

// Front and rear cameras, and a lidar lower down: what one of them sees is seen.
TEST(ExplorationGain, OfSeveralSensorsIsThatOfTheUnionOfTheirViews) {
  std::mt19937_64 random(11);
  const Scene s = scene(random, 80);
  const std::vector<DepthSensor> sensors = {
      {RgbdFootprint(), CameraMount()},
      {RgbdFootprint(), {CameraMount::forward_facing({-0.1, 0.0, 0.45}, M_PI)}},
      {RgbdFootprint{2.0 * M_PI, 0.0, 0.1, 2.5}, {CameraMount::forward_facing({0.0, 0.0, 0.3})}}};
  const VoxelGrid grid = test::hall(random, true, 15);
  std::vector<ExplorationGain::Sight> sights;
  std::vector<FootprintVisibility> views;
  for (const DepthSensor& sensor : sensors) {
    const double z = sensor.mount.T_BC.translation().z();
    const auto table = std::make_shared<const OcclusionTable>(
        SensorLattice::around({0, 0, z}, 3.0, 0.2), s.targets.positions(z - 0.45), grid,
        OcclusionTable::Options());
    sights.push_back({sensor, table});
    views.emplace_back(sensor.footprint, sensor.mount, table);
  }
  const Unicycle model;
  const ExplorationGain::Options options;
  const int n = views.front().size();
  FootprintVisibility::Scratch scratch(n);
  const auto seen_by = [&](const Pose& pose, std::size_t sensor) {
    Eigen::VectorXd v(n);
    views[sensor].evaluate(pose, scratch, v.data());
    return v;
  };
  double by_first = 0.0, by_all = 0.0;
  for (int trial = 0; trial < 6; ++trial) {
    const TrajectoryBatch t = test::random_trajectories(model, 6, 0.25, 1, random);
    const auto united = [&](const Pose& pose) {
      Eigen::VectorXd unseen = Eigen::VectorXd::Ones(n);
      for (std::size_t k = 0; k < sensors.size(); ++k) {
        unseen.array() *= 1.0 - seen_by(pose, k).array();
      }
      return Eigen::VectorXd(1.0 - unseen.array());
    };
    const Eigen::VectorXd now = united(t.pose(0, 0));
    Eigen::VectorXd unseen = Eigen::VectorXd::Ones(n);
    for (int k = 1; k <= 6; ++k) {
      const Eigen::VectorXd v = united(t.pose(k, 0));
      for (int c = 0; c < n; ++c) {
        const double q = v[c] > now[c] ? std::pow(v[c] - now[c], 2) / (v[c] * (1.0 - now[c])) : 0.0;
        unseen[c] *= 1.0 - options.eta * std::exp(-k * 0.25 / options.tau) * q;
      }
    }
    double expected = 0.0;
    for (int c = 0; c < n; ++c) {
      expected += s.targets.targets[static_cast<std::size_t>(c)].mass * (1.0 - unseen[c]) / 2.5;
    }
    const ExplorationGain gain(s.targets, sights, options, t.pose(0, 0));
    EXPECT_NEAR(test::evaluate(gain, t, false).value(0, 0), expected, 1e-12);
    test::expect_derivative_matches_differences(gain, t, 0, 1e-5, 2e-6);
    const ExplorationGain anew(s.targets, sights, options),
        one(s.targets, std::vector{sights[0]}, options);
    by_all += test::evaluate(anew, t, false).value(0, 0);
    by_first += test::evaluate(one, t, false).value(0, 0);
  }
  EXPECT_GT(by_all, 1.2 * by_first);
  EXPECT_THROW(ExplorationGain(s.targets, std::vector<ExplorationGain::Sight>(), options),
               std::invalid_argument);
  std::swap(sights[0].table, sights[2].table);
  EXPECT_THROW(ExplorationGain(s.targets, sights, options), std::invalid_argument)
      << "a table of targets at another height";
}

TEST(ExplorationGain, BatchEqualsSingleAndPermutationDoesNotMatter) {
  std::mt19937_64 random(3);
  const Scene s = scene(random, 90);
  const Unicycle model;
  const ExplorationGain gain(s.targets, RgbdFootprint(), CameraMount(), s.table);
  const TrajectoryBatch batch = test::random_trajectories(model, 10, 0.25, 7, random);
  const TermOutput all = test::evaluate(gain, batch, false);
  for (int b = 0; b < 7; ++b) {
    TrajectoryBatch one = batch;
    one.states = batch.states.col(b);
    one.inputs = batch.inputs.col(b);
    EXPECT_EQ(test::evaluate(gain, one, false).value(0, 0), all.value(0, b));
    EXPECT_EQ(test::evaluate(gain, one, true).value(0, 0), all.value(0, b));
  }
}

TEST(ExplorationGain, NewSurfaceTelescopesAndItsAdjointMatchesDifferences) {
  std::mt19937_64 random(4);
  const Scene s = scene(random, 60);
  const Unicycle model;
  ExplorationGain::Options options;
  options.surface_per_area = 1.7;
  const ExplorationGain gain(s.targets, RgbdFootprint(), CameraMount(), s.table, options);
  const NewSurface& surface = gain;
  constexpr int N = 8;
  const TrajectoryBatch t = test::random_trajectories(model, N, 0.25, 2, random);
  const auto scratch = surface.make_scratch(t.horizon, 2);
  std::vector<double> area(N + 1);
  for (int b = 0; b < 2; ++b) {
    surface.evaluate(t, b, scratch.get(), area.data());
    const Eigen::MatrixXd p = look_probabilities(s, t, b, options, false);
    EXPECT_EQ(area[0], 0.0);
    for (int k = 1; k <= N; ++k) {
      double expected = 0.0;
      for (int c = 0; c < p.rows(); ++c) {
        double unseen = 1.0;
        for (int j = 1; j < k; ++j) unseen *= 1.0 - p(c, j);
        expected += 1.7 * s.targets.targets[static_cast<std::size_t>(c)].mass * unseen * p(c, k);
      }
      EXPECT_NEAR(area[static_cast<std::size_t>(k)], expected, 1e-12);
    }
    Eigen::VectorXd adjoint = Eigen::VectorXd::Random(N + 1);
    TermOutput out = test::outputs(gain, t.horizon, 2);
    surface.add_gradient(t, b, scratch.get(), adjoint.data(), out);
    for (int row = 0; row < t.states.rows(); ++row) {
      double difference = 0.0;
      for (const double sign : {-1.0, 1.0}) {
        TrajectoryBatch moved = t;
        moved.states(row, b) += sign * 1e-5;
        surface.evaluate(moved, b, scratch.get(), area.data());
        for (int k = 0; k <= N; ++k)
          difference += sign * adjoint[k] * area[static_cast<std::size_t>(k)];
      }
      EXPECT_NEAR(out.state_gradient(row, b), difference / 2e-5, 2e-6) << row;
      EXPECT_EQ(out.state_gradient(row, 1 - b), 0.0);
    }
  }
}

TEST(ExplorationGain, DegenerateInput) {
  std::mt19937_64 random(5);
  const Unicycle model;
  // No targets.
  const Scene none = scene(random, 0);
  const ExplorationGain empty(none.targets, RgbdFootprint(), CameraMount(), none.table);
  TrajectoryBatch t = test::random_trajectories(model, 5, 0.25, 1, random);
  TermOutput out = test::evaluate(empty, t, true);
  EXPECT_EQ(out.value(0, 0), 0.0);
  EXPECT_TRUE((out.state_gradient == 0.0).all());
  // Random places, inside walls and far outside the lattice.
  const Scene s = scene(random, 50);
  const ExplorationGain gain(s.targets, RgbdFootprint(), CameraMount(), s.table);
  for (int n = 0; n < 200; ++n) {
    t = test::random_trajectories(model, 5, 0.25, 1, random, n % 2 ? 8.0 : 100.0);
    out = test::evaluate(gain, t, true);
    ASSERT_TRUE(std::isfinite(out.value(0, 0)) && out.value(0, 0) >= 0.0);
    ASSERT_TRUE(out.state_gradient.isFinite().all());
  }
  t.states(4, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(std::isfinite(test::evaluate(gain, t, false).value(0, 0)));
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {-1.0, infinite, std::nan("")}) {
    ExplorationTargets targets = s.targets;
    targets.targets[3].mass = bad;
    EXPECT_THROW(ExplorationGain(targets, RgbdFootprint(), CameraMount(), s.table),
                 std::invalid_argument);
    targets = s.targets;
    targets.reference_area = bad;
    EXPECT_THROW(ExplorationGain(targets, RgbdFootprint(), CameraMount(), s.table),
                 std::invalid_argument);
  }
  // A table of other points, and options out of range.
  EXPECT_THROW(ExplorationGain(s.targets, RgbdFootprint(), CameraMount(), none.table),
               std::invalid_argument);
  ExplorationGain::Options certain;
  certain.eta = 1.0;
  EXPECT_THROW(ExplorationGain(s.targets, RgbdFootprint(), CameraMount(), s.table, certain),
               std::invalid_argument);
}

}  // namespace
}  // namespace prospect::exploration_gain_test
