// SPDX-License-Identifier: Apache-2.0
// What a certificate costs bodies of all sizes, that fit and that do not:
// docs/results/performance.md.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <random>
#include <string>

#include "engine/maps/surface_drift.h"
#include "engine/safety/certificate.h"
#include "models/make_model.h"
#include "tests/engine/obstacle_worlds.h"

namespace prospect {
namespace {

/// A square hall, walls one voxel thick, half its width `half` [m].
test::ObstacleWorld hall(double half) {
  test::ObstacleWorld world(0.1, half + 0.5, 1.2);
  const int n = static_cast<int>(std::lround(10.0 * half));
  for (int a = -n; a < n; ++a) {
    for (const int b : {-n, n - 1}) {
      world.occupy_column(a, b);
      world.occupy_column(b, a);
    }
  }
  return world;
}

/// 4 x 4 m, half of whose voxels are occupied.
test::ObstacleWorld rubble() {
  test::ObstacleWorld world(0.1, 2.0, 1.2);
  std::mt19937 random(1);
  for (int n = 0; n < world.ground.frame().size(); ++n) {
    const Cell c = world.ground.frame().at(n);
    for (int k = 0; k < 12; ++k) {
      if (random() % 2) world.occupy(c.i, c.j, k);
    }
  }
  return world;
}

/// Processor time of the longest of seven checks [ms], and what they said.
void measure(const std::string& name, double radius, const test::ObstacleWorld& world,
             bool as_planner) {
  const auto model = make_model(name);
  Belief belief = world.belief();
  if (name == "multirotor") belief.pose.position.z() = 0.2;
  Twist twist;
  twist.linear.x() = 0.4;
  twist.yaw_rate = 0.5;
  SurfaceDrift drift;
  drift.update(belief, {});
  Certifier::Options options;
  options.margin = as_planner ? 0.02 : 0.005;
  options.reduced_margin_share = as_planner ? 1.0 : 0.0;
  options.unknown = as_planner ? UnknownPolicy::kBraking : UnknownPolicy::kFree;
  const Certifier certifier(CylinderShape{{0.0, 0.0, 0.3}, radius, 0.4}, options);
  const Eigen::VectorXd x0 = model->state(belief.pose, twist), u = model->input(twist);
  double longest = 0.0;
  Certificate verdict;
  for (int n = 0; n < 7; ++n) {
    const std::clock_t begin = std::clock();
    verdict = certifier.certify(belief, *model, x0, u, u.replicate(1, 2), 0.25,
                                as_planner ? &drift : nullptr);
    longest = std::max(longest, 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  std::printf("  %5.2f ms %-11s", longest,
              verdict.ok()                                         ? "clear"
              : verdict.status == Certificate::Status::kOverBudget ? "over budget"
                                                                   : "contact");
}

}  // namespace
}  // namespace prospect

int main() {
  std::printf("%-20s  %-20s  %-20s  %-20s  %s\n", "", "fits, guard", "fits, planner",
              "rubble, guard", "rubble, planner");
  for (const char* name : {"unicycle", "multirotor"}) {
    for (const double radius : {0.18, 0.4, 1.0, 3.0, 10.0}) {
      std::printf("%-10s %5.2f m   ", name, radius);
      for (const bool fits : {true, false}) {
        const auto world = fits ? prospect::hall(radius + 0.7) : prospect::rubble();
        for (const bool as_planner : {false, true}) {
          prospect::measure(name, radius, world, as_planner);
        }
      }
      std::printf("\n");
    }
  }
}
