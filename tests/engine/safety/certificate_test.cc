// SPDX-License-Identifier: Apache-2.0
#include "engine/safety/certificate.h"

#include <fcl/geometry/octree/octree.h>
#include <fcl/narrowphase/collision.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "engine/maps/clearance_field.h"
#include "engine/maps/shape_geometry.h"
#include "models/holonomic.h"
#include "models/make_model.h"
#include "models/multirotor.h"
#include "models/unicycle.h"
#include "models/unicycle_accel.h"
#include "tests/engine/obstacle_worlds.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::certificate_test {
namespace {

using Status = Certificate::Status;
using test::Boxes;
using test::ObstacleWorld;
using test::random_world;

constexpr double kDt = 0.25;

Certifier::Options free_policy() {
  Certifier::Options options;
  options.unknown = UnknownPolicy::kFree;
  options.slice = {0.1, 0.5};
  return options;
}

std::vector<RobotShape> shapes() {
  SphereSetShape spheres;
  spheres.spheres = {{{0.1, 0.05, 0.25}, 0.12}, {{-0.12, 0.0, 0.25}, 0.1}};
  ConvexShape hull;
  hull.vertices = {{0.2, 0.0, 0.1},  {-0.15, 0.12, 0.1}, {-0.15, -0.12, 0.1},
                   {0.1, 0.0, 0.45}, {-0.1, 0.05, 0.45}, {-0.1, -0.05, 0.45}};
  return {spheres, BoxShape{{0.02, 0.0, 0.3}, {0.5, 0.3, 0.3}},
          CylinderShape{{0.0, 0.0, 0.3}, 0.18, 0.4}, hull};
}

Eigen::MatrixXd constant(const MotionModel& model, int n, std::initializer_list<double> input) {
  Eigen::MatrixXd u(model.nu(), n);
  int row = 0;
  for (const double v : input) u.row(row++).setConstant(v);
  return u;
}

/// The octree that has the occupied voxels of a world (and only those within a slice, if asked).
std::shared_ptr<const octomap::OcTree> octree_of(const VoxelGrid& v, int k_low, int k_high) {
  auto tree = std::make_shared<octomap::OcTree>(v.resolution());
  for (int n = 0; n < v.frame().size(); ++n) {
    const Cell c = v.frame().at(n);
    for (int k = k_low; k <= k_high; ++k) {
      if (v.state(c.i, c.j, k) != CellState::kOccupied) continue;
      const Eigen::Vector3d p = v.resolution() * Eigen::Vector3d(c.i + 0.5, c.j + 0.5, k + 0.5);
      tree->updateNode(octomap::point3d(static_cast<float>(p.x()), static_cast<float>(p.y()),
                                        static_cast<float>(p.z())),
                       true);
    }
  }
  return tree;
}

TEST(Certificate, AgreesWithFclOnTheOctree) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-1.9, 1.9), angle(-7.0, 7.0);
  for (const bool planar : {true, false}) {
    const ObstacleWorld world = random_world(3, 0.1, 2.0);
    const Belief belief = world.belief();
    const fcl::OcTreed tree(planar ? octree_of(world.voxels, 1, 4) : octree_of(world.voxels, 0, 7));
    for (const RobotShape& shape : shapes()) {
      const Certifier certifier(shape, free_policy());
      const auto parts = shape_geometry(shape);
      int touching = 0;
      for (int sample = 0; sample < 400; ++sample) {
        const Pose pose{{place(random), place(random), planar ? 0.0 : 0.2 * place(random)},
                        angle(random)};
        Eigen::Isometry3d T_WB = Eigen::Isometry3d::Identity();
        T_WB.linear() = Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
        T_WB.translation() = pose.position;
        bool expected = false;
        for (const PlacedGeometry& part : parts) {
          const fcl::CollisionRequestd request;
          fcl::CollisionResultd result;
          fcl::collide(&tree, fcl::Transform3d::Identity(), part.geometry.get(), T_WB * part.T_BG,
                       request, result);
          expected = expected || result.isCollision();
        }
        EXPECT_EQ(certifier.in_collision(belief, pose, planar), expected);
        touching += expected;
      }
      EXPECT_GT(touching, 30);
      EXPECT_LT(touching, 370);
    }
  }
}

TEST(Certificate, AgreesWithBruteForceForCylinders) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> place(-1.9, 1.9);
  const ObstacleWorld world = random_world(4, 0.1, 2.0);
  const Belief belief = world.belief();
  ClearanceField::Options slice;  // 0.1 .. 0.5 m, the cylinder's height
  const Boxes boxes = test::boxes_of(world, slice);
  const Certifier certifier(CylinderShape{{0.0, 0.0, 0.3}, 0.18, 0.4}, free_policy());
  for (int sample = 0; sample < 2000; ++sample) {
    const Pose pose{{place(random), place(random), 0.0}, place(random)};
    const double gap = boxes.distance(pose.position, 2) - 0.18;
    if (std::abs(gap) < 1e-4) continue;
    EXPECT_EQ(certifier.in_collision(belief, pose, true), gap < 0.0) << gap;
  }
}

/// Whether a box-shaped planar robot touches a square cell: separating axes.
bool rectangles_touch(const Pose& pose, const BoxShape& box, const Eigen::Vector2d& low,
                      const Eigen::Vector2d& high, double tolerance) {
  const Eigen::Rotation2Dd R(pose.yaw);
  const Eigen::Vector2d between =
      pose.position.head<2>() + R * box.center.head<2>() - 0.5 * (low + high);
  const Eigen::Vector2d half_cell = 0.5 * (high - low);
  const Eigen::Vector2d half_box = 0.5 * box.size.head<2>();
  const Eigen::Vector2d x = R * Eigen::Vector2d::UnitX(), y = R * Eigen::Vector2d::UnitY();
  for (const Eigen::Vector2d& axis : {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1), x, y}) {
    const double reach = half_cell.x() * std::abs(axis.x()) + half_cell.y() * std::abs(axis.y()) +
                         half_box.x() * std::abs(axis.dot(x)) +
                         half_box.y() * std::abs(axis.dot(y));
    if (std::abs(axis.dot(between)) > reach + tolerance) return false;
  }
  return true;
}

TEST(Certificate, AgreesWithSeparatingAxesForBoxes) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(-1.9, 1.9);
  const ObstacleWorld world = random_world(5, 0.1, 2.0);
  const Belief belief = world.belief();
  ClearanceField::Options slice;
  slice.slice = {0.15, 0.45};
  const Boxes boxes = test::boxes_of(world, slice);
  const BoxShape box{{0.02, 0.0, 0.3}, {0.5, 0.3, 0.3}};
  Certifier::Options options = free_policy();
  options.slice = slice.slice;
  const Certifier certifier(box, options);
  int touching = 0;
  for (int sample = 0; sample < 2000; ++sample) {
    const Pose pose{{place(random), place(random), 0.0}, 3.0 * place(random)};
    bool surely = false, possibly = false;
    for (std::size_t n = 0; n < boxes.low.size(); ++n) {
      const Eigen::Vector2d low = boxes.low[n].head<2>(), high = boxes.high[n].head<2>();
      surely = surely || rectangles_touch(pose, box, low, high, -1e-4);
      possibly = possibly || rectangles_touch(pose, box, low, high, 1e-4);
    }
    if (surely != possibly) continue;
    EXPECT_EQ(certifier.in_collision(belief, pose, true), surely);
    touching += surely;
  }
  EXPECT_GT(touching, 100);
}

TEST(Certificate, AcceptedMotionsAreFreeAtAThousandPosesAStage) {
  NOT_UNDER_SANITIZERS("over many points, where other tests go the same ways at few");
  // The covering argument: the true body is clear also between the poses that were checked.
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> place(-1.7, 1.7), unit(-1.0, 1.0);
  const Unicycle model;
  const BoxShape box{{0.02, 0.0, 0.3}, {0.4, 0.2, 0.3}};
  const Certifier certifier(box, free_policy());
  int accepted = 0, refused = 0;
  for (int sample = 0; sample < 300; ++sample) {
    const ObstacleWorld world =
        random_world(100 + static_cast<std::uint64_t>(sample % 5), 0.1, 2.0);
    const Belief belief = world.belief();
    Eigen::VectorXd x = Eigen::Vector3d(place(random), place(random), 3.0 * unit(random));
    if (certifier.in_collision(belief, model.pose(x), true)) continue;
    Eigen::MatrixXd inputs(2, 4);
    for (int n = 0; n < 4; ++n) inputs.col(n) << 0.3 + 0.3 * unit(random), unit(random);
    const Certificate verdict = certifier.certify_inputs(belief, model, x, inputs, kDt);
    bool hit = false;
    Eigen::VectorXd next(3);
    for (int n = 0; n < 4; ++n) {
      for (int piece = 1; piece <= 1000; ++piece) {
        model.step(x, inputs.col(n), kDt * piece / 1000.0, next);
        hit = hit || certifier.in_collision(belief, model.pose(next), true);
      }
      x = next;
    }
    if (verdict.ok()) {
      EXPECT_FALSE(hit);
      ++accepted;
    } else {
      EXPECT_EQ(verdict.status, Status::kCollision) << verdict.detail;
      ++refused;
    }
    if (hit) {
      EXPECT_FALSE(verdict.ok());
    }
  }
  EXPECT_GT(accepted, 40);
  EXPECT_GT(refused, 20);
}

TEST(Certificate, SeesAThinWallBetweenNodes) {
  // 5 cm of wall, jumped over by nodes 0.5 m apart.
  ObstacleWorld world(0.05, 2.0);
  for (int j = -40; j < 40; ++j) world.occupy_column(10, j);
  const Belief belief = world.belief();
  Holonomic::Parameters parameters;
  parameters.vx_max = 4.0;
  const Holonomic model(parameters);
  SphereSetShape small;
  small.spheres = {{{0.0, 0.0, 0.3}, 0.05}};
  const Certifier certifier(small, free_policy());
  const Eigen::VectorXd x0 = Eigen::Vector3d(0.25, 0.0, 0.0);
  const Certificate verdict =
      certifier.certify_inputs(belief, model, x0, constant(model, 1, {2.0, 0.0, 0.0}), kDt);
  EXPECT_EQ(verdict.status, Status::kCollision);
  EXPECT_NEAR(verdict.pose.position.x(), 0.45, 0.03);
  EXPECT_NEAR(verdict.time, 0.1, 0.02);
  EXPECT_NE(verdict.detail.find("occupied"), std::string::npos);
  // A single voxel beside the path, hit by a corner that swings round.
  ObstacleWorld corner(0.05, 2.0);
  corner.occupy(8, 0, 6);
  const BoxShape rod{{0.0, 0.0, 0.325}, {0.9, 0.04, 0.1}};
  const Unicycle turning;
  const Certifier rods(rod, free_policy());
  const Eigen::VectorXd across = Eigen::Vector3d(0.0, 0.02, -0.5);
  EXPECT_EQ(
      rods.certify_inputs(corner.belief(), turning, across, constant(turning, 4, {0.0, 1.0}), kDt)
          .status,
      Status::kCollision);
}

TEST(Certificate, MarginKeepsItsDistance) {
  ObstacleWorld world(0.1, 2.0);
  for (int i = -20; i < 20; ++i) world.occupy_column(i, 3);  // a wall from y = 0.3 on
  const Belief belief = world.belief();
  const Unicycle model;
  Certifier::Options options = free_policy();
  options.margin = 0.02;
  const Certifier certifier(CylinderShape{{0.0, 0.0, 0.3}, 0.18, 0.4}, options);
  const auto along = [&](double y) {
    // Comes from clear ground (the margin holds from the start) and drives along the wall.
    const Eigen::VectorXd x0 = Eigen::Vector3d(-1.0, y, 0.0);
    return certifier.certify_inputs(belief, model, x0, constant(model, 8, {0.5, 0.0}), kDt);
  };
  EXPECT_TRUE(along(0.095).ok()) << along(0.095).detail;
  // Slanting into the margin is refused before the body itself would touch.
  const Eigen::VectorXd slant = Eigen::Vector3d(-1.0, 0.05, 0.045);
  const Certificate refused =
      certifier.certify_inputs(belief, model, slant, constant(model, 8, {0.6, 0.0}), kDt);
  EXPECT_EQ(refused.status, Status::kCollision);
  EXPECT_GT(refused.pose.position.y(), 0.09);
  EXPECT_LT(refused.pose.position.y(), 0.12);
  EXPECT_NEAR(refused.time, (refused.pose.position.x() + 1.0) / (0.6 * std::cos(0.045)), 1e-9);
}

TEST(Certificate, TailIsCheckedToo) {
  // 0.25 s at full speed is clear, stopping afterwards is not.
  ObstacleWorld world(0.1, 2.0);
  for (int j = -20; j < 20; ++j) world.occupy_column(5, j);
  const Unicycle model;
  const Certifier certifier(CylinderShape{{0.0, 0.0, 0.3}, 0.18, 0.4}, free_policy());
  const Eigen::MatrixXd committed = constant(model, 1, {0.6, 0.0});
  const Eigen::VectorXd u = Eigen::Vector2d(0.6, 0.0);
  const auto from = [&](double x) {
    return certifier.certify(world.belief(), model, Eigen::Vector3d(x, 0.0, 0.0), u, committed,
                             kDt);
  };
  const auto only_committed = [&](double x) {
    return certifier.certify_inputs(world.belief(), model, Eigen::Vector3d(x, 0.0, 0.0), committed,
                                    kDt);
  };
  EXPECT_TRUE(from(-0.2).ok()) << from(-0.2).detail;
  EXPECT_TRUE(only_committed(0.1).ok());
  EXPECT_EQ(from(0.1).status, Status::kCollision);
  EXPECT_GT(from(0.1).time, kDt);
}

TEST(StoppingTail, BringsEveryModelToRestWithinItsLimits) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Unicycle unicycle;
  const UnicycleAccel accel;
  const Holonomic holonomic;
  const Multirotor multirotor;
  for (const MotionModel* model :
       std::vector<const MotionModel*>{&unicycle, &accel, &holonomic, &multirotor}) {
    for (int sample = 0; sample < 30; ++sample) {
      Twist twist;
      twist.linear.x() = 0.3 + 0.3 * unit(random);
      twist.yaw_rate = unit(random);
      Eigen::VectorXd x = model->state({Eigen::Vector3d(0.0, 0.0, 0.5), unit(random)}, twist);
      Eigen::VectorXd u = model->input(twist);
      const Eigen::MatrixXd tail = stopping_tail(*model, x, u, kDt);
      ASSERT_GE(tail.cols(), 1);
      ASSERT_LT(tail.cols(), 20);
      Eigen::VectorXd next(model->nx());
      for (Eigen::Index n = 0; n < tail.cols(); ++n) {
        for (int a = 0; a < model->nu(); ++a) {
          EXPECT_GE(tail(a, n), model->limits().lower[a] - 1e-9);
          EXPECT_LE(tail(a, n), model->limits().upper[a] + 1e-9);
          EXPECT_LE(std::abs(tail(a, n) - u[a]), model->limits().rate[a] * kDt + 1e-9);
        }
        u = tail.col(n);
        model->step(x, u, kDt, next);
        x = next;
      }
      EXPECT_LE(model->twist(x, u).linear.norm(), 1e-3) << model->name();
      EXPECT_LE(std::abs(model->twist(x, u).yaw_rate), 1e-3) << model->name();
    }
  }
}

TEST(Certificate, ATailThatNeverStopsIsNamed) {
  const ObstacleWorld world(0.1, 2.0);
  const Unicycle model;
  Certifier::Options options = free_policy();
  options.max_tail_time = 0.25;
  const Certifier certifier(CylinderShape{}, options);
  const Certificate verdict =
      certifier.certify(world.belief(), model, Eigen::Vector3d(-1.0, 0.0, 0.0),
                        Eigen::Vector2d(0.6, 0.0), Eigen::MatrixXd(2, 0), kDt);
  EXPECT_EQ(verdict.status, Status::kNotStopping) << verdict.detail;
}

TEST(Certificate, UnknownSpaceFollowsThePolicy) {
  ObstacleWorld world(0.1, 2.0);
  for (int i = 5; i < 20; ++i) {
    for (int j = -20; j < 20; ++j) world.forget_column(i, j);
  }
  const Unicycle model;
  const CylinderShape shape{{0.0, 0.0, 0.3}, 0.18, 0.4};
  for (const UnknownPolicy policy :
       {UnknownPolicy::kFree, UnknownPolicy::kBlocked, UnknownPolicy::kBraking}) {
    Certifier::Options options = free_policy();
    options.unknown = policy;
    const Certifier certifier(shape, options);
    const Certificate verdict =
        certifier.certify(world.belief(), model, Eigen::Vector3d(-0.2, 0.0, 0.0),
                          Eigen::Vector2d(0.6, 0.0), constant(model, 4, {0.6, 0.0}), kDt);
    if (policy == UnknownPolicy::kFree) {
      EXPECT_TRUE(verdict.ok()) << verdict.detail;
    } else {
      EXPECT_EQ(verdict.status, Status::kUnknownSpace);
      EXPECT_NEAR(verdict.pose.position.x(), 0.32, 0.03);
      EXPECT_NE(verdict.detail.find("unknown"), std::string::npos);
    }
  }
}

TEST(Certificate, UnknownSpaceUnderTheRobotAtTheStartIsTolerated) {
  ObstacleWorld world(0.1, 2.0);
  for (int i = -3; i < 3; ++i) {
    for (int j = -3; j < 3; ++j) world.forget_column(i, j);
  }
  const Unicycle model;
  Certifier::Options options = free_policy();
  options.unknown = UnknownPolicy::kBraking;
  const Certifier certifier(CylinderShape{{0.0, 0.0, 0.3}, 0.35, 0.4}, options);
  const Eigen::VectorXd x0 = Eigen::Vector3d::Zero();
  const Eigen::VectorXd still = Eigen::Vector2d::Zero();
  EXPECT_TRUE(
      certifier.certify(world.belief(), model, x0, still, constant(model, 4, {0.3, 0.5}), kDt)
          .ok());
  const Certifier slim(CylinderShape{{0.0, 0.0, 0.3}, 0.15, 0.4}, options);
  EXPECT_TRUE(
      slim.certify(world.belief(), model, x0, still, constant(model, 4, {0.0, 0.8}), kDt).ok());
  EXPECT_EQ(
      slim.certify(world.belief(), model, x0, still, constant(model, 4, {0.3, 0.0}), kDt).status,
      Status::kUnknownSpace);
  // Farther on, where all about it is looked at anew, nothing else is.
  for (int j = -20; j < 20; ++j) world.forget_column(14, j);
  const Certificate far =
      certifier.certify_inputs(world.belief(), model, x0, constant(model, 12, {0.5, 0.0}), kDt);
  EXPECT_EQ(far.status, Status::kUnknownSpace);
  EXPECT_NEAR(far.pose.position.x(), 1.05, 0.05);
}

TEST(Certificate, WhereThereIsNoFloorTheBodyMayNotBe) {
  ObstacleWorld world(0.1, 2.0);
  for (int j = -20; j < 20; ++j) world.ground.set({10, j}, CellState::kOccupied, true);
  const Unicycle model;
  const CylinderShape shape{{0.0, 0.0, 0.3}, 0.18, 0.4};
  const auto verdict = [&](const Certifier::Options& options) {
    return Certifier(shape, options)
        .certify(world.belief(), model, Eigen::Vector3d(0.3, 0.0, 0.0), Eigen::Vector2d(0.6, 0.0),
                 constant(model, 5, {0.6, 0.0}), kDt);
  };
  const Certificate edge = verdict(free_policy());
  EXPECT_EQ(edge.status, Status::kCollision) << edge.detail;
  EXPECT_NEAR(edge.pose.position.x(), 1.0 - 0.18, 0.03);
  // One that begins over it may leave it, and get no deeper.
  const Certifier certifier(shape, free_policy());
  const Eigen::Vector2d still = Eigen::Vector2d::Zero();
  for (const double yaw : {0.0, M_PI}) {
    EXPECT_EQ(certifier
                  .certify(world.belief(), model, Eigen::Vector3d(0.9, 0.0, yaw), still,
                           constant(model, 3, {0.2, 0.0}), kDt)
                  .ok(),
              yaw > 0.0);
  }
}

TEST(Certificate, GroundWhoseFloorWasNotSeenIsNotEnteredIfThatIsAskedFor) {
  ObstacleWorld world(0.1, 2.0);
  VoxelGrid voxels(world.voxels.frame(), -0.2, 0.8);
  for (int i = -20; i < 20; ++i) {
    for (int j = -20; j < 20; ++j) {
      for (int k = 0; k < 8; ++k) voxels.set(i, j, k, CellState::kFree);
      if (i < 8) voxels.set(i, j, -1, CellState::kOccupied);
    }
  }
  world.voxels = voxels;
  const Unicycle model;
  const CylinderShape shape{{0.0, 0.0, 0.3}, 0.18, 0.4};
  Certifier::Options options = free_policy();
  const auto verdict = [&](double x) {
    return Certifier(shape, options)
        .certify(world.belief(), model, Eigen::Vector3d(x, 0.0, 0.0), Eigen::Vector2d(0.6, 0.0),
                 constant(model, 5, {0.6, 0.0}), kDt);
  };
  EXPECT_TRUE(verdict(0.2).ok());
  options.seen_floor = true;
  const Certificate unseen = verdict(0.2);
  EXPECT_EQ(unseen.status, Status::kUnseenFloor);
  EXPECT_NEAR(unseen.pose.position.x(), 0.8 - 0.18, 0.03);
  EXPECT_NE(unseen.detail.find("floor"), std::string::npos) << unseen.detail;
  EXPECT_TRUE(verdict(-1.5).ok());
}

/// What becomes of a drive of `n` stages at `speed` from the origin along x, and the stop after it,
/// among people in a hall.
Certificate among(const std::vector<Mover>& people, double speed, int n, double belief_stamp = 0.0,
                  const RobotShape& shape = CylinderShape{{0.0, 0.0, 0.3}, 0.2, 0.4}) {
  const Unicycle model;
  Belief belief = ObstacleWorld(0.1, 6.0).belief();
  auto known = std::make_shared<Movers>();
  known->all = people;
  belief.movers = known;
  belief.stamp = belief_stamp;
  return Certifier(shape, free_policy())
      .certify(belief, model, Eigen::Vector3d::Zero(), Eigen::Vector2d(speed, 0.0),
               constant(model, n, {speed, 0.0}), kDt);
}

TEST(Certificate, DrivesNowhereWhereSomebodyMayBeByThen) {
  EXPECT_TRUE(among({}, 0.6, 8).ok());
  // Somebody who stands 1 m ahead: as far as to them, with what they may have moved by then.
  const Mover stands{{1.0, 0.0}, {0.0, 0.0}, 0.2, 0.1};
  const Certificate into = among({stands}, 0.6, 8);
  EXPECT_EQ(into.status, Status::kCollision);
  EXPECT_NEAR(into.pose.position.x(), 1.0 - 0.2 - 0.2 - 0.1 * into.time - 0.01, 0.03);
  EXPECT_NE(into.detail.find("somebody"), std::string::npos) << into.detail;
  // Who comes across is there when the robot is, though nobody is now; who goes is not any more.
  const Mover comes{{0.9, -1.2}, {0.0, 1.0}, 0.2, 0.1};
  EXPECT_EQ(among({comes}, 0.6, 8).status, Status::kCollision);
  const Mover goes{{0.9, 0.3}, {0.0, 1.0}, 0.2, 0.1};
  EXPECT_TRUE(among({goes}, 0.6, 8).ok());
  const Mover beside{{0.9, 0.8}, {0.0, 0.0}, 0.2, 0.0};
  EXPECT_TRUE(among({beside}, 0.6, 8).ok());
}

TEST(Certificate, MayGoOutOfSomebodysWayAndMayStand) {
  // Somebody walks into it from behind: it goes on, it may stand, it may turn; it backs into
  // nobody.
  const Mover behind{{-0.5, 0.0}, {0.8, 0.0}, 0.2, 0.1};
  EXPECT_TRUE(among({behind}, 0.9, 4).ok());
  EXPECT_TRUE(among({behind}, 0.0, 8).ok());
  EXPECT_EQ(among({behind}, -0.3, 4).status, Status::kCollision);
  // One that touches it now.
  const Mover touches{{0.3, 0.0}, {0.0, 0.0}, 0.2, 0.0};
  EXPECT_TRUE(among({touches}, -0.3, 4).ok());
  EXPECT_TRUE(among({touches}, 0.0, 4).ok());
  EXPECT_EQ(among({touches}, 0.1, 4).status, Status::kCollision);
}

TEST(Certificate, PredictsMoversFromTheirOwnStamp) {
  const Mover comes{{0.9, -2.4}, {0.0, 1.0}, 0.2, 0.0};
  EXPECT_TRUE(among({comes}, 0.6, 6).ok());
  EXPECT_EQ(among({comes}, 0.6, 6, 1.2).status, Status::kCollision);
}

TEST(Certificate, ALongBodyReachesSomebodyBySweepingRound) {
  const Unicycle model;
  Belief belief = ObstacleWorld(0.1, 6.0).belief();
  auto known = std::make_shared<Movers>();
  known->all = {{{0.0, 0.55}, {0.0, 0.0}, 0.2, 0.0}};
  belief.movers = known;
  const auto turns = [&](double rate) {
    return Certifier(BoxShape{{0.2, 0.0, 0.3}, {0.9, 0.3, 0.3}}, free_policy())
        .certify(belief, model, Eigen::Vector3d::Zero(), Eigen::Vector2d(0.0, rate),
                 constant(model, 6, {0.0, rate}), kDt);
  };
  EXPECT_EQ(turns(1.0).status, Status::kCollision);
  EXPECT_TRUE(turns(-0.5).ok());
}

TEST(Certificate, AMoverThatIsNotFiniteAllowsNothing) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Mover sound{{3.0, 0.0}, {0.0, 0.0}, 0.2, 0.0};
  ASSERT_TRUE(among({sound}, 0.2, 2).ok());
  for (int n = 0; n < 5; ++n) {
    Mover wrong = sound;
    (n == 0   ? wrong.position.x()
     : n == 1 ? wrong.velocity.y()
     : n == 2 ? wrong.radius
     : n == 3 ? wrong.spread
              : wrong.position.y()) = n == 4 ? std::numeric_limits<double>::infinity() : kNan;
    EXPECT_EQ(among({wrong}, 0.2, 2).status, Status::kNonFinite) << n;
  }
}

// Below and above the height 0, and where the map does not begin at its origin.
TEST(Certificate, AMapMayBeginAnywhere) {
  const Unicycle model;
  for (const int k0 : {-7, 0, 3}) {
    const GridFrame frame{0.1, 5, -25, 40, 40};
    std::vector<CellState> all(40 * 40 * 16, CellState::kFree);
    auto voxels = std::make_shared<VoxelGrid>(frame, k0, 16, all);
    auto ground = std::make_shared<GroundMap>(frame);
    for (int n = 0; n < frame.size(); ++n) ground->set(frame.at(n), CellState::kFree);
    Belief belief;
    for (const int layer : {2, 4, 6}) {
      VoxelGrid with_one = *voxels;
      with_one.set(30, -5, layer, CellState::kOccupied);
      belief.voxels = std::make_shared<const VoxelGrid>(with_one);
      belief.ground = ground;
      const Certifier certifier(CylinderShape{{0.0, 0.0, 0.3}, 0.18, 0.4}, free_policy());
      const Certificate verdict = certifier.certify_inputs(
          belief, model, Eigen::Vector3d(2.0, -0.45, 0.0), constant(model, 8, {0.5, 0.0}), kDt);
      const bool in_the_way = layer >= std::max(1, k0) && layer < 5;  // of heights 0.1 to 0.5 m
      EXPECT_EQ(verdict.status, in_the_way ? Status::kCollision : Status::kOk)
          << k0 << ' ' << layer;
      if (!in_the_way) continue;
      EXPECT_NEAR(verdict.pose.position.x(), 3.0 - 0.18, 0.06);
    }
  }
}

TEST(Certificate, OptionsOutOfRangeAreRefused) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  using Options = Certifier::Options;
  const struct {
    double Options::*option;
    std::vector<double> bad;
  } rows[] = {{&Options::margin, {0.0, -0.1, nan, infinite}},
              {&Options::max_tail_time, {0.0, -1.0, nan}},
              {&Options::reduced_margin_share, {-0.1, 1.1, nan}},
              {&Options::drift_margin, {-0.1, nan, infinite}},
              {&Options::drift_limit, {-0.1, nan, infinite}},
              {&Options::max_doubt, {0.0, 0.6, -0.1, nan}},
              {&Options::max_lost_error, {-0.1, nan}}};
  for (const auto& row : rows) {
    for (const double bad : row.bad) {
      Options options = free_policy();
      options.*row.option = bad;
      EXPECT_THROW(Certifier(CylinderShape{}, options), std::invalid_argument) << bad;
    }
  }
  for (const VerticalExtent& slice : {VerticalExtent{0.5, 0.5}, VerticalExtent{0.5, 0.1},
                                      VerticalExtent{nan, 0.5}, VerticalExtent{0.1, infinite}}) {
    Options options = free_policy();
    options.slice = {slice.z_min, slice.z_max};
    EXPECT_THROW(Certifier(CylinderShape{}, options), std::invalid_argument);
  }
  Options options = free_policy();
  options.max_checks = 0;
  EXPECT_THROW(Certifier(CylinderShape{}, options), std::invalid_argument);
}

TEST(Certificate, ARobotInContactMayLeaveButNotGoDeeper) {
  ObstacleWorld world(0.1, 2.0);
  for (int j = -20; j < 20; ++j) {
    for (int i = 3; i < 8; ++i) world.occupy_column(i, j);
  }
  Unicycle::Parameters parameters;
  parameters.v_min = -0.6;
  const Unicycle model(parameters);
  const Certifier certifier(CylinderShape{{0.0, 0.0, 0.3}, 0.18, 0.4}, free_policy());
  const Belief belief = world.belief();
  const auto drive = [&](double x, double v) {
    return certifier.certify_inputs(belief, model, Eigen::Vector3d(x, 0.0, 0.0),
                                    constant(model, 4, {v, 0.0}), kDt);
  };
  ASSERT_TRUE(certifier.in_collision(belief, {{0.15, 0.0, 0.0}, 0.0}, true));
  EXPECT_TRUE(drive(0.15, -0.3).ok()) << drive(0.15, -0.3).detail;
  EXPECT_TRUE(drive(0.15, 0.0).ok());
  EXPECT_EQ(drive(0.15, 0.3).status, Status::kCollision);
  // Within the margin but not in contact: leaves, may not touch.
  ASSERT_FALSE(certifier.in_collision(belief, {{0.115, 0.0, 0.0}, 0.0}, true));
  EXPECT_TRUE(drive(0.115, -0.3).ok());
  EXPECT_EQ(drive(0.115, 0.3).status, Status::kCollision);
}

TEST(Certificate, ARobotWithinItsMarginMayNotComeNearer) {
  ObstacleWorld world(0.1, 2.0);
  for (int j = -20; j < 20; ++j) world.occupy_column(3, j);
  const Belief belief = world.belief();
  const Holonomic model;
  Certifier::Options options = free_policy();
  options.margin = 0.02;
  const auto status = [&](double clearance, double towards, double along, double turn) {
    const Certifier certifier(CylinderShape{{0.0, 0.0, 0.3}, 0.18, 0.4}, options);
    const Eigen::VectorXd x0 = Eigen::Vector3d(0.3 - 0.18 - clearance, 0.0, 0.0);
    return certifier
        .certify_inputs(belief, model, x0,
                        constant(model, 1, {towards / kDt, along / kDt, turn / kDt}), kDt)
        .status;
  };
  for (const double share : {0.0, 0.5, 1.0}) {
    options.reduced_margin_share = share;
    SCOPED_TRACE(share);
    EXPECT_EQ(status(0.025, 0.004, 0.0, 0.0), Status::kOk) << "down to the margin";
    EXPECT_EQ(status(0.025, 0.006, 0.0, 0.0), Status::kCollision);
    for (const double clearance : {0.003, 0.012, 0.019}) {
      SCOPED_TRACE(clearance);
      EXPECT_EQ(status(clearance, -0.05, 0.0, 0.0), Status::kOk) << "leaves";
      EXPECT_EQ(status(clearance, 0.0, 0.05, 0.0), Status::kOk) << "follows the wall";
      EXPECT_EQ(status(clearance, 0.0, 0.0, 0.3), Status::kOk) << "turns";
      EXPECT_EQ(status(clearance, 0.9 * (1.0 - share) * clearance, 0.0, 0.0), Status::kOk);
      EXPECT_EQ(status(clearance, 1.1 * (1.0 - share) * clearance + 2e-4, 0.0, 0.0),
                Status::kCollision);
    }
  }
  options.reduced_margin_share = 1.1;
  EXPECT_THROW(Certifier(CylinderShape(), options), std::invalid_argument);
  // Poses are no farther apart than twice what it keeps.
  options.reduced_margin_share = 0.5;
  const Certifier certifier(CylinderShape{{0.0, 0.0, 0.3}, 0.18, 0.4}, options);
  for (const double clearance : {0.012, 0.019}) {
    const Certificate away =
        certifier.certify_inputs(belief, model, Eigen::Vector3d(0.12 - clearance, 0.0, 0.0),
                                 constant(model, 4, {-0.3, 0.0, 0.0}), kDt);
    EXPECT_GE(away.poses, 0.3 / (2.0 * (0.5 * clearance + 1e-4))) << away.detail;
  }
}

TEST(Certificate, SurfacesThatMayHaveDriftedAreKeptFartherAway) {
  ObstacleWorld world(0.1, 2.0);
  for (int j = -20; j < 20; ++j) world.occupy_column(3, j);
  Unicycle::Parameters parameters;
  parameters.v_min = -0.6;
  const Unicycle model(parameters);
  const RobotDescription robot;
  Certifier::Options options = free_policy();
  options.margin = 0.02;
  options.reduced_margin_share = 1.0;
  options.drift_margin = 0.12;
  const CylinderShape shape{{0.0, 0.0, 0.3}, 0.18, 0.4};
  const Certifier certifier(shape, options);
  const auto seen = [&](double yaw, double variance, SurfaceDrift& drift) {
    Belief belief = world.belief();
    belief.pose = {{-0.5, 0.0, 0.0}, yaw};
    belief.covariance(0, 0) = belief.covariance(1, 1) = variance;
    drift.update(belief, robot);
  };
  SurfaceDrift drift;
  seen(0.0, 0.0, drift);
  seen(M_PI, 0.01, drift);
  ASSERT_NEAR(drift.sigma({3, 0}), 0.1, 1e-6);
  // The wall may be 0.1 m off, half of drift_margin at least: 0.08 m are kept.
  const auto approach = [&](double clearance, double rest, const SurfaceDrift* minded,
                            const Certifier& by) {
    const Eigen::VectorXd x0 = Eigen::Vector3d(0.3 - 0.18 - clearance, 0.0, 0.0);
    const double speed = (clearance - rest) / kDt;
    return by
        .certify_inputs(world.belief(), model, x0, constant(model, 1, {speed, 0.0}), kDt, minded)
        .status;
  };
  EXPECT_EQ(approach(0.15, 0.085, &drift, certifier), Status::kOk);
  EXPECT_EQ(approach(0.15, 0.075, &drift, certifier), Status::kCollision);
  EXPECT_EQ(approach(0.15, 0.025, nullptr, certifier), Status::kOk);
  // Closer at the start than it should be, it may not come nearer.
  EXPECT_EQ(approach(0.07, 0.069, &drift, certifier), Status::kCollision);
  EXPECT_EQ(approach(0.07, 0.06999, &drift, certifier), Status::kOk);
  EXPECT_EQ(approach(0.07, 0.12, &drift, certifier), Status::kOk) << "leaves";
  EXPECT_EQ(approach(0.01, 0.009, &drift, certifier), Status::kCollision);
  EXPECT_EQ(approach(0.01, 0.05, &drift, certifier), Status::kOk);
  // Not so where drift is not minded, nor once the wall was in view again.
  options.drift_margin = 0.0;
  EXPECT_EQ(approach(0.15, 0.025, &drift, Certifier(shape, options)), Status::kOk);
  seen(0.0, 0.01, drift);
  EXPECT_EQ(approach(0.15, 0.025, &drift, certifier), Status::kOk);
  options.drift_margin = -0.1;
  EXPECT_THROW(Certifier(shape, options), std::invalid_argument);
}

// Holonomic bases that had lost their localization touched walls beside and behind them, which were
// half a metre from where they had been drawn: the space driven into was free on the map.
TEST(Certificate, SpaceThatMayHaveDriftedIsUnknown) {
  const ObstacleWorld world(0.1, 3.0);
  const RobotDescription robot;
  const CylinderShape shape{{0.0, 0.0, 0.3}, 0.18, 0.4};
  const Holonomic planar_model;
  const Multirotor flying_model;
  const auto update = [&](SurfaceDrift& drift, double yaw, double variance) {
    Belief belief = world.belief();
    belief.pose.yaw = yaw;
    belief.covariance(0, 0) = belief.covariance(1, 1) = variance;
    drift.update(belief, robot);
  };
  SurfaceDrift drift;
  for (const double yaw : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0}) update(drift, yaw, 0.0);
  update(drift, 0.0, 0.0225);
  ASSERT_NEAR(drift.sigma({-5, 0}), 0.15, 1e-6);
  ASSERT_EQ(drift.sigma({5, 0}), 0.0);
  const auto move = [&](const MotionModel& model, double vx, double vy, double drift_limit,
                        UnknownPolicy policy, const SurfaceDrift* minded) {
    Certifier::Options options;
    options.unknown = policy;
    options.drift_limit = drift_limit;
    const bool flies = model.pose_layout().pz >= 0;
    Twist twist;
    twist.linear = {vx, vy, 0.0};
    Pose start;
    if (flies) start.position.z() = 0.1;
    return Certifier(shape, options)
        .certify_inputs(
            world.belief(), model, model.state(start, twist),
            flies ? constant(model, 2, {0.0, 0.0, 0.0, 0.0}) : constant(model, 2, {vx, vy, 0.0}),
            kDt, minded)
        .status;
  };
  using enum UnknownPolicy;
  for (const MotionModel* model : {static_cast<const MotionModel*>(&planar_model),
                                   static_cast<const MotionModel*>(&flying_model)}) {
    for (const UnknownPolicy policy : {kBraking, kBlocked}) {
      EXPECT_EQ(move(*model, 0.5, 0.0, 0.12, policy, &drift), Status::kOk) << "where it looks";
      EXPECT_EQ(move(*model, -0.5, 0.0, 0.12, policy, &drift), Status::kUnknownSpace);
      EXPECT_EQ(move(*model, 0.0, 0.5, 0.12, policy, &drift), Status::kUnknownSpace);
      EXPECT_EQ(move(*model, 0.0, 0.0, 0.12, policy, &drift), Status::kOk) << "may stand there";
      // What may have moved less is still where it was.
      EXPECT_EQ(move(*model, -0.5, 0.0, 0.16, policy, &drift), Status::kOk);
      EXPECT_EQ(move(*model, -0.5, 0.0, 0.0, policy, &drift), Status::kOk) << "switched off";
      EXPECT_EQ(move(*model, -0.5, 0.0, 0.12, policy, nullptr), Status::kOk);
    }
    EXPECT_EQ(move(*model, -0.5, 0.0, 0.12, kFree, &drift), Status::kOk);
  }
  Certifier::Options bad;
  bad.drift_limit = -0.1;
  EXPECT_THROW(Certifier(shape, bad), std::invalid_argument);
}

TEST(Certificate, MovesInSpaceMindFloorAndCeiling) {
  ObstacleWorld world(0.1, 2.0, 2.0);
  for (int i = -20; i < 20; ++i) {
    for (int j = -20; j < 20; ++j) {
      world.occupy(i, j, 0);
      world.occupy(i, j, 15);
    }
  }
  const Multirotor model;
  SphereSetShape body;
  body.spheres = {{Eigen::Vector3d::Zero(), 0.2}};
  Certifier::Options options = free_policy();
  const Certifier certifier(body, options);
  const auto fly = [&](double vz) {
    Twist twist;
    twist.linear.z() = vz;
    const Eigen::VectorXd x0 = model.state({{0.0, 0.0, 0.8}, 0.0}, twist);
    return certifier.certify(world.belief(), model, x0, Eigen::VectorXd::Zero(4),
                             Eigen::MatrixXd::Zero(4, 4), kDt);
  };
  EXPECT_TRUE(fly(0.0).ok()) << fly(0.0).detail;
  EXPECT_EQ(fly(0.7).status, Status::kCollision);
  EXPECT_GT(fly(0.7).pose.position.z(), 1.25);
  EXPECT_EQ(fly(-0.7).status, Status::kCollision);
  // Above the mapped heights is unknown.
  options.unknown = UnknownPolicy::kBlocked;
  const Certifier cautious(body, options);
  Twist up;
  up.linear.z() = 0.7;
  const Eigen::VectorXd high = model.state({{0.0, 0.0, 1.75}, 0.0}, up);
  EXPECT_EQ(cautious
                .certify(world.belief(), model, high, Eigen::VectorXd::Zero(4),
                         Eigen::MatrixXd::Zero(4, 4), kDt)
                .status,
            Status::kUnknownSpace);
}

// In 3-D: nearer to or farther from a voxel that it touches is told along the height, too, and from
// the body's middle, wherever that is in B; and each voxel beside the body counts.
TEST(Certificate, InTheAirTheWholeBodyCounts) {
  const Multirotor model;
  const auto status = [&](double middle, int layer, int column, const Eigen::Vector3d& velocity) {
    ObstacleWorld world(0.1, 2.0, 3.0);
    world.occupy(column, 0, layer);
    const Certifier certifier(CylinderShape{{0.0, 0.0, middle}, 0.1, 0.8}, free_policy());
    const Eigen::VectorXd x0 = model.state({{0.0, 0.0, 1.5 - middle}, 0.0}, {velocity, 0.0});
    return certifier.certify_inputs(world.belief(), model, x0, Eigen::MatrixXd::Zero(4, 2), kDt)
        .status;
  };
  const Eigen::Vector3d up(0.0, 0.0, 0.3), ahead(0.6, 0.0, 0.0);
  for (const double middle : {-0.6, -0.4, 0.0, 0.4, 0.6}) {  // the body is from 1.1 to 1.9 m
    SCOPED_TRACE(middle);
    for (const int layer : {11, 12, 13}) {
      EXPECT_EQ(status(middle, layer, 0, up), Status::kOk) << layer;
      EXPECT_EQ(status(middle, layer, 0, -up), Status::kCollision) << layer;
    }
    for (const int layer : {16, 17, 18}) {
      EXPECT_EQ(status(middle, layer, 0, up), Status::kCollision) << layer;
      EXPECT_EQ(status(middle, layer, 0, -up), Status::kOk) << layer;
    }
    for (const int layer : {9, 11, 15, 18, 20}) {
      const bool beside = layer > 10 && layer < 19;
      EXPECT_EQ(status(middle, layer, 2, ahead), beside ? Status::kCollision : Status::kOk)
          << layer;
    }
  }
}

TEST(Certificate, EmptyMapIsClear) {
  Belief belief;
  belief.voxels = std::make_shared<const VoxelGrid>(GridFrame{0.1, 0, 0, 1, 1}, 0.0, 0.5);
  belief.ground = std::make_shared<const GroundMap>(GridFrame{0.1, 0, 0, 1, 1});
  const Unicycle model;
  const Certifier certifier(CylinderShape{}, free_policy());
  EXPECT_TRUE(certifier
                  .certify(belief, model, Eigen::Vector3d::Zero(), Eigen::Vector2d::Zero(),
                           constant(model, 4, {0.5, 0.3}), kDt)
                  .ok());
  // One cell of 2 m that is larger than all that the body reaches.
  auto cell = std::make_shared<VoxelGrid>(GridFrame{2.0, 0, 0, 1, 1}, 0.0, 2.0);
  cell->set(0, 0, 0, CellState::kOccupied);
  belief.voxels = cell;
  EXPECT_TRUE(certifier.in_collision(belief, {{1.0, 1.0, 0.0}, 0.0}, true));
}

TEST(Certificate, BadNumbersAreReportedNotThrown) {
  const ObstacleWorld world(0.1, 1.0);
  const Belief belief = world.belief();
  const Unicycle model;
  const Certifier certifier(CylinderShape{}, free_policy());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::MatrixXd fine = constant(model, 2, {0.1, 0.0});
  const Eigen::VectorXd still = Eigen::Vector2d::Zero();
  const Eigen::VectorXd x0 = Eigen::Vector3d::Zero();
  const auto status = [&](const Eigen::VectorXd& x, const Eigen::VectorXd& u,
                          const Eigen::MatrixXd& inputs, double dt) {
    const Certificate verdict = certifier.certify(belief, model, x, u, inputs, dt);
    EXPECT_FALSE(verdict.detail.empty());
    return verdict.status;
  };
  EXPECT_EQ(status(x0, still, fine, kDt), Status::kOk);
  EXPECT_EQ(status(Eigen::Vector3d(nan, 0, 0), still, fine, kDt), Status::kNonFinite);
  EXPECT_EQ(status(Eigen::Vector3d(1e300, 0, 0), still, fine, kDt), Status::kNonFinite);
  EXPECT_EQ(status(x0, Eigen::Vector2d(nan, 0), fine, kDt), Status::kNonFinite);
  EXPECT_EQ(status(x0, still, constant(model, 2, {nan, 0.0}), kDt), Status::kNonFinite);
  EXPECT_EQ(status(x0, still, constant(model, 2, {1e12, 0.0}), kDt), Status::kNonFinite);
  EXPECT_EQ(status(x0, still, fine, nan), Status::kNonFinite);
  EXPECT_EQ(status(x0, still, fine, 0.0), Status::kNonFinite);
  EXPECT_EQ(status(Eigen::Vector2d(0, 0), still, fine, kDt), Status::kNonFinite);
  EXPECT_EQ(status(x0, still, Eigen::MatrixXd::Zero(3, 2), kDt), Status::kNonFinite);
  EXPECT_EQ(certifier.certify(Belief(), model, x0, still, fine, kDt).status, Status::kNonFinite);
  EXPECT_TRUE(certifier.in_collision(belief, {{nan, 0.0, 0.0}, 0.0}, true));

  Certifier::Options options = free_policy();
  options.sensors = {DepthSensor{}};
  options.sensors.front().footprint.max_range = nan;
  EXPECT_THROW(Certifier(CylinderShape{}, options), std::invalid_argument);
}

Certifier::Options lost_options() {
  Certifier::Options options = free_policy();
  options.sensors = {DepthSensor{}};
  return options;
}

Belief lost_belief(const ObstacleWorld& world, double variance = 25.0) {
  Belief belief = world.belief();
  belief.localization = Localization::kLost;
  belief.covariance = variance * Eigen::Matrix4d::Identity();
  return belief;
}

// Lost with 25 m^2, all of 200 commands passed; a covariance that is none counted as exact.
TEST(Certificate, WithoutABoundOnThePoseOnlyWhatIsInViewIsEntered) {
  const ObstacleWorld world;
  const Holonomic model;
  const Certifier certifier(CylinderShape{}, lost_options());
  Certifier::Options blind_options = lost_options();
  blind_options.sensors.clear();
  const Certifier blind(CylinderShape{}, blind_options);
  const auto status = [&](const Certifier& c, const Belief& belief,
                          std::initializer_list<double> u) {
    const Eigen::VectorXd x0 = model.state(belief.pose, Twist());
    return c.certify(belief, model, x0, Eigen::Vector3d::Zero(), constant(model, 2, u), kDt).status;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Belief> unbounded(4, lost_belief(world));
  unbounded[1].covariance.setZero();
  unbounded[2].localization = Localization::kOk;
  unbounded[2].covariance(0, 0) = nan;
  unbounded[3].localization = Localization::kDegraded;
  unbounded[3].covariance *= -1.0;
  for (Belief& belief : unbounded) {
    for (const double yaw : {0.0, 0.7, 3.0, -1.9}) {
      belief.pose.yaw = yaw;
      EXPECT_EQ(status(certifier, belief, {0.5, 0.0, 0.0}), Status::kOk) << "where it looks";
      EXPECT_EQ(status(certifier, belief, {0.0, 0.0, 1.0}), Status::kOk) << "turning";
      EXPECT_EQ(status(certifier, belief, {0.0, 0.0, 0.0}), Status::kOk);
      EXPECT_EQ(status(certifier, belief, {-0.4, 0.0, 0.0}), Status::kOutOfView);
      EXPECT_EQ(status(certifier, belief, {0.0, 0.4, 0.0}), Status::kOutOfView);
      EXPECT_EQ(status(certifier, belief, {0.0, -0.4, 0.0}), Status::kOutOfView);
      EXPECT_EQ(status(blind, belief, {0.5, 0.0, 0.0}), Status::kOutOfView);
      EXPECT_EQ(status(blind, belief, {0.0, 0.0, 1.0}), Status::kOk);
    }
  }
  // A second camera looks back: each strip of its own.
  Certifier::Options two_options = lost_options();
  two_options.sensors.push_back(
      {RgbdFootprint(), {CameraMount::forward_facing({0.0, 0.0, 0.45}, M_PI)}});
  const Certifier two(CylinderShape{}, two_options);
  for (const double yaw : {0.0, 0.7, 3.0, -1.9}) {
    Belief belief = unbounded[0];
    belief.pose.yaw = yaw;
    EXPECT_EQ(status(two, belief, {0.5, 0.0, 0.0}), Status::kOk);
    EXPECT_EQ(status(two, belief, {-0.5, 0.0, 0.0}), Status::kOk);
    EXPECT_EQ(status(two, belief, {0.0, 0.4, 0.0}), Status::kOutOfView);
    EXPECT_EQ(status(two, belief, {0.0, -0.4, 0.0}), Status::kOutOfView);
  }
  two_options.sensors.resize(kMostDepthSensors + 1);
  EXPECT_THROW(Certifier(CylinderShape{}, two_options), std::invalid_argument);
  const Certificate refused =
      certifier.certify(lost_belief(world), model, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                        constant(model, 2, {-0.4, 0.0, 0.0}), kDt);
  EXPECT_NE(refused.detail.find("would leave what is in view after"), std::string::npos)
      << refused.detail;
  // A bound that is small enough, or a pose that is known, changes nothing.
  Belief bounded = lost_belief(world, 0.25);
  EXPECT_EQ(status(certifier, bounded, {-0.4, 0.0, 0.0}), Status::kOk);
  Certifier::Options strict = lost_options();
  strict.max_lost_error = 0.4;
  EXPECT_EQ(status(Certifier(CylinderShape{}, strict), bounded, {-0.4, 0.0, 0.0}),
            Status::kOutOfView);
  bounded = lost_belief(world);
  bounded.localization = Localization::kOk;
  EXPECT_EQ(status(certifier, bounded, {-0.4, 0.0, 0.0}), Status::kOk);
  // Obstacles count as ever.
  ObstacleWorld walled;
  for (int j = -10; j < 10; ++j) walled.occupy_column(3, j);
  EXPECT_EQ(status(certifier, lost_belief(walled), {0.5, 0.0, 0.0}), Status::kCollision);
}

TEST(Certificate, ALostRobotOfAnyShapeMayTurnAndLook) {
  const ObstacleWorld world;
  const Unicycle model;
  for (const RobotShape& shape : shapes()) {
    const Certifier certifier(shape, lost_options());
    Belief belief = lost_belief(world);
    belief.pose.position = {0.03, -0.04, 0.0};
    for (double yaw = 0.0; yaw < 6.3; yaw += 0.37) {
      belief.pose.yaw = yaw;
      const Eigen::VectorXd x0 = model.state(belief.pose, Twist());
      for (const auto& u : {constant(model, 2, {0.0, 1.0}), constant(model, 2, {0.5, 0.0})}) {
        const Certificate verdict =
            certifier.certify(belief, model, x0, Eigen::Vector2d::Zero(), u, kDt);
        EXPECT_TRUE(verdict.ok()) << verdict.detail;
      }
    }
  }
}

// Each motion starts from where the last one ended, so what is tolerated at a start must not add
// up.
TEST(Certificate, ALostRobotDoesNotCreepOutOfView) {
  NOT_UNDER_SANITIZERS("steps that other tests of the planner take, from many beliefs");
  const Holonomic model;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> velocity(-0.08, 0.08);
  for (const double yaw : {0.0, 0.4, 0.785, 2.0}) {
    const Eigen::Rotation2Dd R(yaw);
    ObstacleWorld world;  // 0.5 m ahead begins a fog
    for (int n = 0; n < world.ground.frame().size(); ++n) {
      const Cell c = world.ground.frame().at(n);
      const Eigen::Vector2d p = R.inverse() * world.ground.frame().center(c);
      if (p.x() > 0.5) world.forget_column(c.i, c.j);
    }
    for (const RobotShape& shape : shapes()) {
      const Certifier certifier(shape, lost_options());
      for (const int path : {0, 1, 2, 3}) {  // sideways, diagonally, backwards, anyhow
        Belief belief = lost_belief(world);
        belief.pose.yaw = yaw;
        double side = 0.0, back = 0.0, front = 0.0;
        for (int n = 0; n < 300; ++n) {
          const double v = 0.08 * std::abs(velocity(random)) / 0.08;
          Eigen::Vector3d u(velocity(random), velocity(random), 0.0);
          if (path == 0) u = {0.0, v, 0.0};
          if (path == 1) u = {n % 4 ? 0.0 : v, v, 0.0};
          if (path == 2) u = {-v, 0.0, 0.0};
          const Eigen::VectorXd x0 = model.state(belief.pose, Twist());
          const Certificate verdict =
              certifier.certify(belief, model, x0, Eigen::Vector3d::Zero(), u, kDt);
          if (!verdict.ok()) continue;
          belief.pose = verdict.pose;
          const Eigen::Vector2d p = R.inverse() * belief.pose.position.head<2>();
          side = std::max(side, std::abs(p.y()));
          front = std::max(front, p.x());
          back = std::min(back, p.x());
        }
        // By less than a cell's diagonal: what the cells hold that the body overlapped at first.
        // One that also drives ahead gets to what is in view there: 0.7 m aside in a metre.
        const double opened = path == 3 ? 0.7 * front : 0.0;
        EXPECT_LT(side, 0.15 + opened) << yaw << " " << path << " " << shape.index();
        EXPECT_GT(back, -0.15) << yaw << " " << path << " " << shape.index();
        EXPECT_LT(front, 0.6) << yaw << " " << path << " " << shape.index();
      }
    }
  }
}

TEST(Certificate, InTheAirALostRobotDoesNotRiseIntoWhatItDoesNotSee) {
  const ObstacleWorld world(0.1, 4.0, 3.0);
  const Multirotor model;
  const Certifier certifier(CylinderShape{}, lost_options());
  Belief belief = lost_belief(world);
  belief.pose.position.z() = 1.0;
  const auto fly = [&](const Eigen::Vector3d& v) {
    Twist twist;
    twist.linear = v;
    const Eigen::VectorXd x0 = model.state(belief.pose, twist);
    return certifier
        .certify(belief, model, x0, Eigen::Vector4d::Zero(), Eigen::MatrixXd::Zero(4, 1), kDt)
        .status;
  };
  EXPECT_EQ(fly({0.0, 0.0, 0.0}), Status::kOk);
  EXPECT_EQ(fly({0.5, 0.0, 0.0}), Status::kOk);
  EXPECT_EQ(fly({0.0, 0.0, 0.5}), Status::kOutOfView);
  EXPECT_EQ(fly({0.0, 0.0, -0.5}), Status::kOutOfView);
  EXPECT_EQ(fly({-0.5, 0.0, 0.0}), Status::kOutOfView);
  EXPECT_EQ(fly({0.0, 0.5, 0.0}), Status::kOutOfView);
}

// A body that overlapped many voxels took 2 to 20 s a check.
TEST(Certificate, IsGivenUpWhereABodyOverlapsMuch) {
  ObstacleWorld rubble(0.1, 6.0, 1.5);
  std::mt19937_64 random(3);
  for (int i = -60; i < 60; ++i) {
    for (int j = -60; j < 60; ++j) {
      if (random() % 3 == 0) rubble.occupy(i, j, static_cast<int>(random() % 12));
      if (random() % 3 == 0) rubble.forget_column(i, j);
    }
  }
  const Belief belief = rubble.belief();
  SurfaceDrift drift;
  drift.update(belief, {});
  for (const std::string name : {"unicycle", "holonomic", "multirotor"}) {
    const auto model = make_model(name);
    for (const double radius : {0.4, 1.0, 3.0, 10.0, 20.0}) {
      for (const UnknownPolicy policy : {UnknownPolicy::kFree, UnknownPolicy::kBraking}) {
        Certifier::Options options;
        options.unknown = policy;
        options.reduced_margin_share = 1.0;
        const Certifier certifier(CylinderShape{{0.0, 0.0, 0.3}, radius, 0.4}, options);
        Twist twist;
        twist.linear.x() = 0.4;
        twist.yaw_rate = 0.5;
        const Eigen::VectorXd x0 = model->state(belief.pose, twist);
        const std::clock_t begin = std::clock();
        const Certificate verdict = certifier.certify(
            belief, *model, x0, model->input(twist), model->input(twist).replicate(1, 2), kDt,
            policy == UnknownPolicy::kFree ? nullptr : &drift);
        const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
        EXPECT_FALSE(verdict.ok()) << name << " " << radius;
        EXPECT_FALSE(verdict.detail.empty());
        EXPECT_LT(seconds, 0.1) << name << " " << radius << " " << verdict.detail;
        EXPECT_LT(verdict.poses, 3000);
        const Certificate again = certifier.certify(
            belief, *model, x0, model->input(twist), model->input(twist).replicate(1, 2), kDt,
            policy == UnknownPolicy::kFree ? nullptr : &drift);
        EXPECT_EQ(again.status, verdict.status) << "a count, no clock";
        EXPECT_EQ(again.poses, verdict.poses);
        if (radius >= 10.0) {
          EXPECT_TRUE(certifier.in_collision(belief, belief.pose, true));
        }
      }
    }
  }
}

TEST(Certificate, ALargeBodyThatFitsIsCertified) {
  for (const double radius : {1.0, 3.0, 8.0}) {
    const double half = radius + 1.5;
    ObstacleWorld hall(0.1, half + 0.5);
    const int wall = static_cast<int>(10.0 * half);
    for (int a = -wall; a <= wall; ++a) {
      for (const int b : {-wall, wall}) {
        hall.occupy_column(a, b);
        hall.occupy_column(b, a);
      }
    }
    const Belief belief = hall.belief();
    const Unicycle model;
    for (const RobotShape& shape :
         {RobotShape(CylinderShape{{0.0, 0.0, 0.3}, radius, 0.4}),
          RobotShape(BoxShape{{0.0, 0.0, 0.3}, {1.4 * radius, 1.4 * radius, 0.4}})}) {
      Certifier::Options options;
      options.margin = 0.005;
      const Certifier certifier(shape, options);
      for (const auto& u : {constant(model, 2, {0.5, 0.0}), constant(model, 2, {0.3, 0.4})}) {
        const Certificate verdict = certifier.certify(belief, model, Eigen::Vector3d::Zero(),
                                                      Eigen::Vector2d::Zero(), u, kDt);
        EXPECT_TRUE(verdict.ok()) << radius << ": " << verdict.detail;
      }
      EXPECT_FALSE(certifier
                       .certify(belief, model, Eigen::Vector3d::Zero(), Eigen::Vector2d::Zero(),
                                constant(model, 16, {0.6, 0.0}), kDt)
                       .ok())
          << "through the wall";
    }
  }
}

TEST(Certificate, TooManyStagesAreNotWalked) {
  const Belief belief = ObstacleWorld().belief();
  const Unicycle model;
  const Certifier certifier(CylinderShape{}, free_policy());
  const Eigen::VectorXd x0 = Eigen::Vector3d::Zero(), still = Eigen::Vector2d::Zero();
  const Certificate verdict =
      certifier.certify(belief, model, x0, still, Eigen::MatrixXd::Zero(2, 1'000'000), kDt);
  EXPECT_EQ(verdict.status, Status::kOverBudget);
  EXPECT_EQ(verdict.poses, 0);
  // Nor is a tail of steps so short that it takes for ever.
  EXPECT_EQ(
      certifier.certify(belief, model, x0, Eigen::Vector2d(0.5, 0.0), Eigen::MatrixXd(2, 0), 1e-7)
          .status,
      Status::kOverBudget);
  Certifier::Options options = free_policy();
  options.max_checks = 100;
  EXPECT_EQ(Certifier(CylinderShape{}, options)
                .certify(belief, model, x0, still, constant(model, 2, {0.1, 0.0}), kDt)
                .status,
            Status::kOverBudget);
}

// Columns that one ray had passed once, far off, were driven into at full speed, and were not free.
TEST(Certificate, WhatWasHardlySeenIsNotKnownToBeFree) {
  struct Row {
    const char* what;
    int layers;  // of the column that are known free
    float log_odds;
    bool known;
  };
  const float miss = octomap::logodds(0.4);
  const Row rows[] = {{"one ray, once", 1, miss, false},
                      {"twice", 1, 2.0F * miss, true},
                      {"once, in two layers", 2, miss, true},
                      {"for long", 4, octomap::logodds(0.1192), true}};
  const Unicycle model;
  Certifier::Options options;
  options.slice = {0.1, 0.5};
  for (const Row& row : rows) {
    ObstacleWorld world;
    auto tree = std::make_shared<octomap::OcTree>(0.1);
    const VoxelGrid& v = world.voxels;
    for (int n = 0; n < v.frame().size(); ++n) {
      const Cell c = v.frame().at(n);
      for (int k = 1; k <= 4; ++k) {
        const bool weak = c == Cell{7, 0};
        if (weak && k > row.layers) {
          world.voxels.set(c.i, c.j, k, CellState::kUnknown);
          continue;
        }
        const octomap::OcTreeKey key(static_cast<octomap::key_type>(c.i + 32768),
                                     static_cast<octomap::key_type>(c.j + 32768),
                                     static_cast<octomap::key_type>(k + 32768));
        tree->setNodeValue(key, weak ? row.log_odds : octomap::logodds(0.1192), true);
      }
    }
    Belief belief = world.belief();
    belief.octree = tree;
    const auto verdict = [&](double speed) {
      const Eigen::MatrixXd u = constant(model, 4, {speed, 0.0});
      return Certifier(CylinderShape{}, options)
          .certify(belief, model, Eigen::Vector3d(0, 0.05, 0), u.col(0), u, kDt)
          .status;
    };
    EXPECT_EQ(verdict(0.6), row.known ? Status::kOk : Status::kUnknownSpace) << row.what;
    EXPECT_EQ(verdict(0.3), Status::kOk) << row.what << ": slow enough to stop before it";
    options.unknown = UnknownPolicy::kFree;
    EXPECT_EQ(verdict(0.6), Status::kOk) << row.what;
    options.unknown = UnknownPolicy::kBraking;
  }
}

}  // namespace
}  // namespace prospect::certificate_test
