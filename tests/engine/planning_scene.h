// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <octomap/OcTree.h>

#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "engine/maps/belief.h"
#include "engine/maps/map_projection.h"
#include "engine/planner/planner.h"
#include "engine/problem/solver.h"
#include "models/make_model.h"
#include "tests/engine/view_worlds.h"
#include "tests/engine/visibility_scene.h"

namespace prospect::test {

/// Hands back the point it is given.
class IdleSolver final : public Solver {
 public:
  std::string name() const override { return "idle"; }
  std::vector<OptionInfo> options() const override { return {}; }
  std::string explain_unsupported(const Problem&) const override { return ""; }
  Result solve(const Problem&, const WarmStart&, const Options&,
               const StopCondition&) const override {
    return {};
  }
};

/// A half-explored hall with boxes and landmarks, a robot in its middle, and the problem that the
/// planner makes of it.
struct PlanningScene {
  std::shared_ptr<Planner> planner;
  Belief belief;
  std::shared_ptr<const Problem> problem;

  explicit PlanningScene(std::string_view model = "unicycle_accel",
                         PlannerParameters parameters = {}, int landmarks = 400) {
    std::mt19937_64 random(1);
    const HeightSlice slice{0.1, 0.5};
    auto voxels = std::make_shared<VoxelGrid>(hall(random, true, 25));
    // Unknown on two sides of the robot, as in a mission that goes on.
    for (int i = -80; i < 80; ++i) {
      for (int j = 25; j < 80; ++j) {
        for (int k = 0; k < 25; ++k) voxels->set(i, j, k, CellState::kUnknown);
      }
    }
    auto map = std::make_shared<LandmarkMap>();
    map->landmarks = visibility_scene::landmarks(random, landmarks);
    belief.pose.yaw = 0.4;
    belief.twist.linear.x() = 0.2;
    belief.tracked_features = 100;
    belief.ground = std::make_shared<const GroundMap>(project(*voxels, slice));
    belief.voxels = std::move(voxels);
    belief.octree = std::make_shared<const octomap::OcTree>(0.1);  // the planner reads the mirror
    belief.landmarks = std::move(map);
    RobotDescription robot;
    robot.model = make_model(model);
    planner =
        std::make_shared<Planner>(std::move(robot), parameters, std::make_shared<IdleSolver>());
    const Plan plan = planner->plan(belief);
    problem = planner->problem();
    if (!problem) throw std::logic_error("planning scene: " + plan.detail);
  }

  /// B random admissible points.
  Eigen::MatrixXd points(int B, std::mt19937_64& random) const {
    Eigen::MatrixXd X(problem->num_variables(), B);
    for (Eigen::Index b = 0; b < B; ++b) {
      for (Eigen::Index i = 0; i < X.rows(); ++i) {
        X(i, b) = uniform(random, problem->lower()[i], problem->upper()[i]);
      }
    }
    return X;
  }
};

}  // namespace prospect::test
