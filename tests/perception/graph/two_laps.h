// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "perception/graph/pose_graph.h"
#include "perception/odometry/se3.h"

namespace prospect::test {

/// Two laps around a block of 30 m x 20 m, a keyframe a metre: true poses, and what odometry and
/// loops measure of them. In 3-D the way also climbs and banks.
struct TwoLaps {
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  struct Loop {
    int from, to;
    RelativePose measured;
    bool right;
  };

  explicit TwoLaps(std::uint64_t seed, bool planar = true) : planar(planar), generator(seed) {
    const auto deviations = [](double t, double z, double w) {
      Vector6d sigma;
      sigma << t, t, z, w, w, w;
      return sigma;
    };
    odometry_sigma = deviations(0.03, 0.03, 0.006);
    loop_sigma = deviations(0.1, 0.1, 0.02);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    for (int k = 0; k < 200; ++k) {
      truth.push_back(T);
      const int side = k % 100;
      Vector6d step = Vector6d::Zero();
      step[0] = 1.0;
      if (side == 29 || side == 49 || side == 79 || side == 99) step[5] = 0.5 * M_PI;
      if (!planar) step.segment<3>(2) << 0.1 * std::sin(0.3 * k), 0.02 * std::cos(k), 0.0;
      T = T * exp_se3(step);
    }
    for (std::size_t k = 1; k < truth.size(); ++k) {
      odometry.push_back(measure(truth[k - 1].inverse() * truth[k], odometry_sigma));
    }
    for (int k = 102; k < 200; k += 6) {
      loops.push_back({k, k - 100, measure(between(k, k - 100), loop_sigma), true});
    }
  }

  Eigen::Isometry3d between(int a, int b) const {
    return truth[static_cast<std::size_t>(a)].inverse() * truth[static_cast<std::size_t>(b)];
  }
  RelativePose measure(const Eigen::Isometry3d& T, const Vector6d& sigma) {
    Vector6d n;
    for (double& value : n) value = normal(generator);
    if (planar) n.segment<3>(2).setZero();
    RelativePose measured;
    measured.T = T * exp_se3(sigma.cwiseProduct(n));
    if (planar) measured.T = flat(measured.T);
    measured.information = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
    return measured;
  }
  static Eigen::Isometry3d flat(const Eigen::Isometry3d& T) {
    Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
    result.translation() << T.translation().head<2>(), 0.0;
    const double yaw = std::atan2(T.linear()(1, 0), T.linear()(0, 0));
    result.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return result;
  }
  /// Takes one keyframe for another that is farther than 10 m away.
  void add_wrong(int count) {
    std::uniform_int_distribution<int> any(0, 199);
    while (count > 0) {
      const int a = any(generator), b = any(generator);
      if (between(a, b).translation().norm() < 10.0) continue;
      loops.push_back({a, b, measure(Eigen::Isometry3d::Identity(), loop_sigma), false});
      --count;
    }
  }
  /// The same, of `length` in a row that agree with each other.
  void add_wrong_stretch(int a, int b, int length) {
    for (int k = 0; k < length; ++k) {
      const Eigen::Isometry3d T = between(a + k, a) * between(b, b + k);
      loops.push_back({a + k, b + k, measure(T, loop_sigma), false});
    }
  }

  PoseGraph graph(const PoseGraphOptions& options = {}) const {
    PoseGraph result(options);
    bool taken = result.begin(0, truth[0]) == GraphInput::kTaken;
    for (std::size_t k = 0; k < odometry.size(); ++k) {
      const int id = static_cast<int>(k) + 1;
      taken = result.add_keyframe(id, id - 1, odometry[k]) == GraphInput::kTaken && taken;
    }
    for (const Loop& loop : loops) {
      taken = result.add_loop(loop.from, loop.to, loop.measured) == GraphInput::kTaken && taken;
    }
    return taken ? std::move(result) : PoseGraph(options);
  }
  /// Mean distance of the poses from the true ones.
  double error(const PoseGraph& graph) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      sum += (graph.pose(static_cast<int>(k))->translation() - truth[k].translation()).norm();
    }
    return sum / static_cast<double>(truth.size());
  }
  /// How many of the right ones and how many of the wrong ones are used.
  std::pair<int, int> used(const PoseGraph& graph) const {
    std::pair<int, int> count = {0, 0};
    for (std::size_t k = 0; k < loops.size(); ++k) {
      if (graph.loops()[k] != LoopState::kUsed) continue;
      ++(loops[k].right ? count.first : count.second);
    }
    return count;
  }

  bool planar;
  std::mt19937_64 generator;
  std::normal_distribution<double> normal;
  Vector6d odometry_sigma, loop_sigma;
  std::vector<Eigen::Isometry3d> truth;
  std::vector<RelativePose> odometry;  ///< from k to k + 1
  std::vector<Loop> loops;
};

}  // namespace prospect::test
