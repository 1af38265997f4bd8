// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/kinematic_robot.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "tests/adapters/box_room.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::kinematic_robot_test {
namespace {

TEST(Advance, IsTheLimitOfSmallStepsAndSmoothThroughZeroTurn) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (int n = 0; n < 60; ++n) {
    const Pose start{{u(generator), u(generator), 0.2}, 3.2 * u(generator)};
    Twist twist;
    twist.linear = {u(generator), u(generator), 0.7};
    twist.yaw_rate = n % 4 == 0 ? 0.0 : (n % 4 == 1 ? 1e-5 * u(generator) : 2.0 * u(generator));
    Pose fine = start;
    constexpr int kSteps = 20000;
    for (int s = 0; s < kSteps; ++s) {
      const double yaw = fine.yaw + 0.5 * twist.yaw_rate / kSteps;
      fine.position.x() +=
          (std::cos(yaw) * twist.linear.x() - std::sin(yaw) * twist.linear.y()) / kSteps;
      fine.position.y() +=
          (std::sin(yaw) * twist.linear.x() + std::cos(yaw) * twist.linear.y()) / kSteps;
      fine.yaw += twist.yaw_rate / kSteps;
    }
    const Pose exact = advance(start, twist, 1.0);
    EXPECT_LT((exact.position - fine.position).norm(), 1e-8);
    EXPECT_NEAR(exact.yaw, fine.yaw, 1e-9);
    EXPECT_EQ(exact.position.z(), 0.2);
    // Composition: half and half is the whole.
    const Pose halves = advance(advance(start, twist, 0.5), twist, 0.5);
    EXPECT_LT((exact.position - halves.position).norm(), 1e-13);
  }
}

// Is a point of B inside the shape (open set)?
bool inside(const RobotShape& shape, const Eigen::Vector3d& p) {
  if (const auto* s = std::get_if<CylinderShape>(&shape)) {
    return (p - s->center).head<2>().norm() < s->radius &&
           std::abs(p.z() - s->center.z()) < 0.5 * s->height;
  }
  if (const auto* s = std::get_if<BoxShape>(&shape)) {
    return ((p - s->center).cwiseAbs().array() < 0.5 * s->size.array()).all();
  }
  if (const auto* s = std::get_if<SphereSetShape>(&shape)) {
    for (const Sphere& b : s->spheres) {
      if ((p - b.center).norm() < b.radius) return true;
    }
    return false;
  }
  // Hull: no plane through three vertices, with all vertices on one side, has the point beyond.
  const auto& v = std::get<ConvexShape>(shape).vertices;
  for (std::size_t a = 0; a < v.size(); ++a) {
    for (std::size_t b = a + 1; b < v.size(); ++b) {
      for (std::size_t c = b + 1; c < v.size(); ++c) {
        Eigen::Vector3d n = (v[b] - v[a]).cross(v[c] - v[a]);
        if (n.norm() < 1e-12) continue;
        n.normalize();
        double low = 1e9, high = -1e9;
        for (const auto& q : v) {
          low = std::min(low, n.dot(q - v[a]));
          high = std::max(high, n.dot(q - v[a]));
        }
        const double s = n.dot(p - v[a]);
        if (high < 1e-12 && s >= 0.0) return false;
        if (low > -1e-12 && s <= 0.0) return false;
      }
    }
  }
  return true;
}

// Samples solid voxels densely for a point inside the shape grown about its centre by `scale`.
bool brute_force_contact(const World& world, const RobotShape& shape, const Pose& pose,
                         double scale, const Eigen::Vector3d& pivot) {
  const double r = world.voxels.resolution();
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(-pose.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3i center = world.voxels.voxel(pose.position);
  constexpr int kSamples = 10;
  for (int j = center.y() - 6; j <= center.y() + 6; ++j) {
    for (int i = center.x() - 6; i <= center.x() + 6; ++i) {
      for (int k = -2; k <= 9; ++k) {
        if (!world.solid(i, j, k)) continue;
        // Too far for any of the shapes, which lie within 0.3 m of their pivots.
        const Eigen::Vector3d middle = Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5) * r;
        if ((R * (middle - pose.position) - pivot).norm() > 0.3 * scale + r) continue;
        for (int a = 0; a <= kSamples; ++a) {
          for (int b = 0; b <= kSamples; ++b) {
            for (int c = 0; c <= kSamples; ++c) {
              const Eigen::Vector3d p = Eigen::Vector3d(i + static_cast<double>(a) / kSamples,
                                                        j + static_cast<double>(b) / kSamples,
                                                        k + static_cast<double>(c) / kSamples) *
                                        r;
              const Eigen::Vector3d q = R * (p - pose.position);
              if (inside(shape, pivot + (q - pivot) / scale)) return true;
            }
          }
        }
      }
    }
  }
  return false;
}

TEST(ContactTest, AgreesWithSamplingForEveryShape) {
  NOT_UNDER_SANITIZERS("statistics repeat a step of other tests a thousand times");
  World world = test::box_room(2.0, 2.0, 1.0);
  test::fill(world, {0.6, 0.6, 0.2}, {0.7, 0.8, 0.5});
  test::fill(world, {1.3, 1.1, 0.0}, {1.4, 1.2, 0.3}, CellState::kUnknown);
  test::fill(world, {1.0, 0.3, 0.5}, {1.1, 0.4, 0.9});
  const std::vector<std::pair<RobotShape, Eigen::Vector3d>> shapes = {
      {CylinderShape{{0.02, 0.0, 0.3}, 0.18, 0.38}, {0.02, 0.0, 0.3}},
      {BoxShape{{0.05, 0.0, 0.3}, {0.4, 0.25, 0.36}}, {0.05, 0.0, 0.3}},
      {SphereSetShape{{{{0.0, 0.0, 0.3}, 0.17}}}, {0.0, 0.0, 0.3}},
      {ConvexShape{{{0.2, 0.15, 0.12}, {0.2, -0.15, 0.12}, {-0.2, 0.0, 0.12}, {0.0, 0.0, 0.55}}},
       {0.05, 0.0, 0.25}}};
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (const auto& [shape, pivot] : shapes) {
    const ContactTest test(world, shape, 0.0);
    int contact = 0, clear = 0, between = 0;
    for (int n = 0; n < 120; ++n) {
      const Pose pose{{0.1 + 1.8 * u(generator), 0.1 + 1.8 * u(generator), 0.0},
                      6.3 * u(generator)};
      const bool got = test.in_contact(pose);
      // Sampling can miss a thin overlap, so the shape is grown for one bound and shrunk for none.
      if (brute_force_contact(world, shape, pose, 1.0, pivot)) {
        EXPECT_TRUE(got);
        ++contact;
      } else if (!brute_force_contact(world, shape, pose, 1.12, pivot)) {
        EXPECT_FALSE(got);
        ++clear;
      } else {
        ++between;
      }
    }
    EXPECT_GT(contact, 20);
    EXPECT_GT(clear, 20);
    EXPECT_LT(between, 30);
  }
}

TEST(ContactTest, TouchingIsNotContactAndOverlapIs) {
  const World world = test::box_room(2.0, 2.0, 1.0);
  const ContactTest disc(world, CylinderShape{{0.0, 0.0, 0.3}, 0.2, 0.4}, 0.0);
  EXPECT_FALSE(disc.in_contact({{0.2, 1.0, 0.0}, 0.0}));
  EXPECT_TRUE(disc.in_contact({{0.2 - 1e-6, 1.0, 0.0}, 0.0}));
  const ContactTest box(world, BoxShape{{0.0, 0.0, 0.3}, {0.4, 0.4, 0.4}}, 0.0);
  EXPECT_FALSE(box.in_contact({{0.2, 1.0, 0.0}, 0.0}));
  EXPECT_TRUE(box.in_contact({{0.2, 1.0, 0.0}, 0.3}));  // a corner turns into the wall
  // A body that stands on the floor does not touch it; one that reaches below does.
  EXPECT_FALSE(ContactTest(world, BoxShape{{0.0, 0.0, 0.2}, {0.4, 0.4, 0.4}}, 0.0)
                   .in_contact({{1, 1, 0}, 0}));
  EXPECT_TRUE(ContactTest(world, BoxShape{{0.0, 0.0, 0.19}, {0.4, 0.4, 0.4}}, 0.0)
                  .in_contact({{1, 1, 0}, 0}));
}

TEST(KinematicRobot, StopsAtTheWallAndCountsContactsOnce) {
  const World world = test::box_room(4.0, 2.0, 1.0);
  KinematicRobot robot(world, CylinderShape{{0.0, 0.0, 0.3}, 0.2, 0.4}, {}, world.start, 1);
  Twist forward;
  forward.linear.x() = 0.5;
  EXPECT_TRUE(robot.move(forward, 3.0));  // to x = 3.5
  EXPECT_EQ(robot.collisions(), 0);
  EXPECT_NEAR(robot.path_length(), 1.5, 1e-12);
  EXPECT_FALSE(robot.move(forward, 2.0));  // the wall's face is at 4, the centre stops at 3.8
  EXPECT_LE(robot.pose().position.x(), 3.8);
  EXPECT_GT(robot.pose().position.x(), 3.8 - 0.011);
  EXPECT_EQ(robot.collisions(), 1);
  EXPECT_TRUE(robot.in_contact());
  for (int n = 0; n < 5; ++n) EXPECT_FALSE(robot.move(forward, 1.0));  // pushing on
  EXPECT_EQ(robot.collisions(), 1);
  EXPECT_TRUE(robot.move(Twist{}, 1.0));  // standing
  EXPECT_TRUE(robot.in_contact());
  forward.linear.x() = -0.5;
  EXPECT_TRUE(robot.move(forward, 1.0));
  EXPECT_FALSE(robot.in_contact());
  forward.linear.x() = 0.5;
  EXPECT_FALSE(robot.move(forward, 2.0));
  EXPECT_EQ(robot.collisions(), 2);
}

TEST(KinematicRobot, FallsWhereAWheelStandsOverAHoleAndStaysThere) {
  World world = test::box_room(4.0, 2.0, 1.0);
  test::fill(world, {3.0, 0.8, -0.1}, {3.4, 1.2, 0.0}, CellState::kFree);  // 0.1 m deep
  const CylinderShape shape{{0.0, 0.0, 0.3}, 0.2, 0.4};
  KinematicRobot robot(world, shape, {}, world.start, 1);
  Twist forward;
  forward.linear.x() = 0.5;
  EXPECT_TRUE(robot.move(forward, 1.6));  // to x = 2.8: the body reaches to the edge
  EXPECT_FALSE(robot.fallen());
  EXPECT_FALSE(robot.move(forward, 0.4));
  EXPECT_TRUE(robot.fallen());
  EXPECT_NEAR(robot.pose().position.x(), 3.0 - Stance::kStance * 0.2, 0.011);
  EXPECT_EQ(robot.collisions(), 0);
  const Pose there = robot.pose();
  forward.linear.x() = -0.5;
  EXPECT_FALSE(robot.move(forward, 1.0));
  EXPECT_EQ(robot.pose().position, there.position);
  EXPECT_TRUE(robot.fallen());

  KinematicRobot climber(world, shape, {}, world.start, 1, 0.2);  // takes the step
  forward.linear.x() = 0.5;
  EXPECT_TRUE(climber.move(forward, 3.0));
  EXPECT_FALSE(climber.fallen());
  Pose over = world.start;
  over.position.x() = 3.2;
  EXPECT_THROW(KinematicRobot(world, shape, {}, over, 1), std::invalid_argument);
}

TEST(KinematicRobot, StandsOnARampClimbsAStepAndFallsOverTheEdgeOfADock) {
  World world = test::box_room(8.0, 2.0, 2.0);
  world.start.position.x() = 1.0;
  world.slopes = {{{2.0, 0.0}, {5.0, 2.0}, 0.0, {0.1, 0.0}},
                  {{5.0, 0.0}, {6.0, 2.0}, 0.3, {0.0, 0.0}}};
  const CylinderShape shape{{0.0, 0.0, 0.3}, 0.2, 0.4};
  KinematicRobot robot(world, shape, {}, world.start, 1);
  Twist forward;
  forward.linear.x() = 0.5;
  EXPECT_TRUE(robot.move(forward, (4.0 - world.start.position.x()) / 0.5));
  EXPECT_NEAR(robot.pose().position.z(), 0.2, 1e-9);
  EXPECT_TRUE(robot.move(forward, 3.0));
  EXPECT_NEAR(robot.pose().position.z(), 0.3, 1e-9);
  EXPECT_FALSE(robot.move(forward, 2.0));
  EXPECT_TRUE(robot.fallen());
  EXPECT_NEAR(robot.pose().position.x(), 6.0 - Stance::kStance * 0.2, 0.011);

  world.slopes = {{{3.0, 0.0}, {3.2, 2.0}, 0.05, {0.0, 0.0}},
                  {{4.0, 0.0}, {4.2, 2.0}, 0.06, {0.0, 0.0}}};
  KinematicRobot over(world, shape, {}, world.start, 1);
  EXPECT_FALSE(over.move(forward, 10.0));
  EXPECT_FALSE(over.fallen());
  EXPECT_EQ(over.collisions(), 1);
  EXPECT_NEAR(over.pose().position.x(), 4.0 - Stance::kStance * 0.2, 0.011);
}

TEST(Stance, CornersOfALongBodyStandOnWheels) {
  World world = test::box_room(4.0, 2.0, 1.0);
  test::fill(world, {2.5, 1.2, -0.1}, {2.7, 1.4, 0.0}, CellState::kFree);
  const Stance stance(world, BoxShape{{0.0, 0.0, 0.3}, {1.2, 0.2, 0.4}}, 0.05);
  EXPECT_FALSE(stance.falls({{2.0, 1.0, 0.0}, 0.0}));
  EXPECT_TRUE(stance.falls({{2.2, 1.0, 0.0}, 0.6}));
  EXPECT_FALSE(stance.falls({{2.2, 1.0, 0.0}, -0.6}));
}

TEST(KinematicRobot, ThinWallsCannotBeJumped) {
  World world = test::box_room(4.0, 2.0, 1.0, 0.05);
  test::fill(world, {3.0, 0.0, 0.0}, {3.05, 2.0, 1.0});
  KinematicRobot robot(world, CylinderShape{}, {}, world.start, 1);
  Twist fast;
  fast.linear.x() = 40.0;
  EXPECT_FALSE(robot.move(fast, 0.04));
  EXPECT_LT(robot.pose().position.x(), 3.0);
}

TEST(KinematicRobot, ActuationNoiseHasTheStatedDeviationWhateverTheSteps) {
  NOT_UNDER_SANITIZERS("statistics repeat a step of other tests a thousand times");
  const World world = test::box_room(6.0, 6.0, 1.0);
  ActuationNoise noise;
  noise.linear = 0.1;
  noise.angular = 0.08;
  for (const int pieces : {1, 10}) {
    double distance = 0.0, angle = 0.0;
    constexpr int kSeeds = 3000;
    for (int seed = 0; seed < kSeeds; ++seed) {
      KinematicRobot straight(world, CylinderShape{}, noise, world.start,
                              static_cast<std::uint64_t>(seed));
      KinematicRobot turning(world, CylinderShape{}, noise, world.start,
                             static_cast<std::uint64_t>(seed));
      Twist forward, turn;
      forward.linear.x() = 0.3;
      turn.yaw_rate = 0.7;
      for (int n = 0; n < pieces; ++n) {
        straight.move(forward, 2.0 / pieces);
        turning.move(turn, 2.0 / pieces);
      }
      distance += std::pow((straight.pose().position - world.start.position).x() - 0.6, 2);
      angle += std::pow(turning.pose().yaw - 1.4, 2);
    }
    // Relative deviation linear / sqrt(T), three deviations of the estimate allowed.
    EXPECT_NEAR(std::sqrt(distance / kSeeds), 0.6 * 0.1 / std::sqrt(2.0), 0.0018);
    EXPECT_NEAR(std::sqrt(angle / kSeeds), 1.4 * 0.08 / std::sqrt(2.0), 0.0034);
  }
}

TEST(KinematicRobot, ExactWithoutNoiseAndSameSeedSameBits) {
  const World world = test::box_room(6.0, 6.0, 1.0);
  Twist twist;
  twist.linear = {0.3, 0.1, 0.0};
  twist.yaw_rate = 0.4;
  KinematicRobot exact(world, CylinderShape{}, {}, world.start, 1);
  exact.move(twist, 1.5);
  const Pose expected = advance(world.start, twist, 1.5);
  EXPECT_LT((exact.pose().position - expected.position).norm(), 1e-12);
  ActuationNoise noise;
  noise.linear = noise.angular = noise.coupling = 0.05;
  KinematicRobot a(world, CylinderShape{}, noise, world.start, 5);
  KinematicRobot b(world, CylinderShape{}, noise, world.start, 5);
  KinematicRobot c(world, CylinderShape{}, noise, world.start, 6);
  for (auto* robot : {&a, &b, &c}) {
    for (int n = 0; n < 10; ++n) robot->move(twist, 0.1);
  }
  EXPECT_EQ(a.pose().position, b.pose().position);
  EXPECT_EQ(a.pose().yaw, b.pose().yaw);
  EXPECT_NE(a.pose().yaw, c.pose().yaw);
}

TEST(KinematicRobot, BadStartsAreOneClearError) {
  World world = test::box_room(2.0, 2.0, 1.0);
  const auto start = [&](double x, double y) {
    return KinematicRobot(world, CylinderShape{}, {}, Pose{{x, y, 0.0}, 0.0}, 1);
  };
  EXPECT_NO_THROW(start(1.0, 1.0));
  EXPECT_THROW(start(0.05, 1.0), std::invalid_argument);
  EXPECT_THROW(start(30.0, 1.0), std::invalid_argument);
  EXPECT_THROW(start(std::nan(""), 1.0), std::invalid_argument);
  try {
    start(0.05, 1.0);
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("wall"), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("box"), std::string::npos);
  }
  KinematicRobot robot = start(1.0, 1.0);
  Twist bad;
  bad.linear.x() = std::nan("");
  EXPECT_TRUE(robot.move(bad, 1.0));
  bad.linear.x() = 0.1;
  EXPECT_TRUE(robot.move(bad, std::nan("")));
  EXPECT_TRUE(robot.move(bad, -1.0));
  EXPECT_EQ(robot.path_length(), 0.0);
}

}  // namespace
}  // namespace prospect::kinematic_robot_test
