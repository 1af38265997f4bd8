// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/dynamic_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/maps/ground_map.h"
#include "engine/maps/voxel_grid.h"
#include "models/unicycle.h"

namespace prospect::dynamic_window_test {
namespace {

constexpr double kResolution = 0.1;

/// A floor of 8 m x 8 m about the origin; a pillar 0.4 m wide at (1, 0) if asked for. The
/// cost-to-go is the straight distance to (3, 0), or to (-3, 0).
class DynamicWindow : public ::testing::Test {
 protected:
  void build(bool pillar, double goal_x) {
    VoxelGrid voxels({kResolution, -40, -40, 80, 80}, 0.0, 1.0);
    GroundMap ground(GridFrame{kResolution, -40, -40, 80, 80});
    Grid<double> seconds(GridFrame{kResolution, -40, -40, 80, 80}, 0.0);
    for (int j = -40; j < 40; ++j) {
      for (int i = -40; i < 40; ++i) {
        const bool solid = pillar && i >= 8 && i < 12 && j >= -2 && j < 2;
        const CellState state = solid ? CellState::kOccupied : CellState::kFree;
        ground.set({i, j}, state);
        for (int k = 0; k < 10; ++k) voxels.set(i, j, k, state);
        const Eigen::Vector2d p = ground.frame().center({i, j});
        seconds[{i, j}] = (p - Eigen::Vector2d(goal_x, 0.0)).norm() / model_.max_speed();
      }
    }
    Grid<std::uint8_t> reached(seconds.frame, 1);
    cost_to_go_ = std::make_unique<CostToGo>(seconds, reached, model_.max_speed());
    ClearanceField::Options options;
    options.reach = 3.0;
    field_ =
        std::make_shared<const ClearanceField>(Eigen::Vector3d::Zero(), voxels, ground, options);
    body_ = std::make_unique<BodyClearance>(field_, CylinderShape{});
    task_.x0 = Eigen::Vector3d::Zero();
    task_.u_previous = Eigen::Vector2d::Zero();
    task_.cost_to_go = cost_to_go_.get();
    task_.target = FrontierTarget{0, {goal_x, 0.0}, {goal_x, 2.0}, M_PI / 2.0};
  }
  /// Poses after each stage.
  std::vector<Pose> drive(const DriveCandidate& c) const {
    std::vector<Pose> poses;
    Eigen::VectorXd x = task_.x0, next(3);
    for (Eigen::Index k = 0; k < c.inputs.cols(); ++k) {
      model_.step(x, c.inputs.col(k), options_.dt, next);
      x.swap(next);
      poses.push_back(model_.pose(x));
    }
    return poses;
  }
  DriveCandidate best() const { return dynamic_window(model_, *body_, task_, options_).front(); }

  Unicycle model_;
  DynamicWindowOptions options_;
  std::unique_ptr<CostToGo> cost_to_go_;
  std::shared_ptr<const ClearanceField> field_;
  std::unique_ptr<BodyClearance> body_;
  DriveTask task_;
};

TEST_F(DynamicWindow, DrivesAtFullSpeedWhereTheWayIsFree) {
  build(false, 3.0);
  const DriveCandidate c = best();
  EXPECT_NEAR(c.inputs(0, c.inputs.cols() - 1), model_.max_speed(), 1e-9);
  // No more than the ramp of the acceleration limit is lost.
  const Unicycle::Parameters p;
  const double ramp = p.v_max / p.a_max;
  const double horizon = options_.stages * options_.dt;
  EXPECT_GT(drive(c).back().position.x(), p.v_max * (horizon - ramp));
  EXPECT_NEAR(drive(c).back().position.y(), 0.0, 0.02);
}

TEST_F(DynamicWindow, TurnsFirstWhenTheWayLeadsBack) {
  build(false, -3.0);
  const DriveCandidate c = best();
  EXPECT_LT(drive(c).back().position.head<2>().norm(), 0.25);
  EXPECT_GT(std::abs(drive(c).back().yaw), 1.2);
}

TEST_F(DynamicWindow, KeepsOffAPillarInItsWay) {
  build(true, 3.0);
  task_.x0 = Eigen::Vector3d(0.3, 0.02, 0.0);
  task_.u_previous = Eigen::Vector2d(0.6, 0.0);
  double least = 1.0;
  for (const Pose& pose : drive(best())) least = std::min(least, body_->clearance(pose));
  EXPECT_GT(least, options_.d_safe - options_.lattice_slack - 0.005);
}

TEST_F(DynamicWindow, FacesTheFrontierOnceArrived) {
  build(false, 3.0);
  task_.x0 = Eigen::Vector3d(3.0, 0.0, 0.0);
  task_.arrived = true;
  const std::vector<DriveCandidate> candidates = dynamic_window(model_, *body_, task_, options_);
  for (const DriveCandidate& c : candidates) EXPECT_EQ(c.inputs.row(0).norm(), 0.0);
  EXPECT_GT(drive(candidates.front()).back().yaw, 1.0);
}

TEST_F(DynamicWindow, EscapesAlongTheClearance) {
  build(true, 3.0);
  task_.x0 = Eigen::Vector3d(0.6, 0.0, M_PI);  // beside the pillar, facing away from it
  task_.escape = true;
  EXPECT_LT(drive(best()).back().position.x(), 0.45);
}

TEST_F(DynamicWindow, EveryCandidateKeepsTheLimitsAndStopIsAmongThem) {
  build(true, 3.0);
  task_.u_previous = Eigen::Vector2d(0.4, -0.3);
  const Unicycle::Parameters p;
  for (const bool arrived : {false, true}) {
    for (const bool escape : {false, true}) {
      task_.arrived = arrived;
      task_.escape = escape;
      bool stop = false;
      const std::vector<DriveCandidate> candidates =
          dynamic_window(model_, *body_, task_, options_);
      EXPECT_GE(candidates.size(), arrived || escape ? 2U : 60U);
      for (const DriveCandidate& c : candidates) {
        stop = stop || c.stops;
        Eigen::Vector2d previous = task_.u_previous;
        for (Eigen::Index k = 0; k < c.inputs.cols(); ++k) {
          const Eigen::Vector2d u = c.inputs.col(k);
          EXPECT_GE(u[0], p.v_min - 1e-12);
          EXPECT_LE(u[0], p.v_max + 1e-12);
          EXPECT_LE(std::abs(u[1]), p.omega_max + 1e-12);
          EXPECT_LE(std::abs(u[0] - previous[0]), p.a_max * options_.dt + 1e-12);
          EXPECT_LE(std::abs(u[1] - previous[1]), p.alpha_max * options_.dt + 1e-12);
          previous = u;
        }
      }
      EXPECT_TRUE(stop);
    }
  }
}

}  // namespace
}  // namespace prospect::dynamic_window_test
