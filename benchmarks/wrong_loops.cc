// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/wrong_loops.h"

#include <cmath>
#include <cstddef>
#include <random>

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kWrong = 10.0;  // [m] between the ends
constexpr int kTries = 1000;     // for each loop

class WrongLoopMaker {
 public:
  WrongLoopMaker(const std::map<int, Isometry3d>& truth, bool planar, std::uint64_t seed)
      : planar_(planar), generator_(seed) {
    for (const auto& [id, T] : truth) {
      ids_.push_back(id);
      poses_.push_back(T);
    }
  }

  int size() const { return static_cast<int>(ids_.size()); }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(generator_); }
  int id(int k) const { return ids_[static_cast<std::size_t>(k)]; }
  const Isometry3d& pose(int k) const { return poses_[static_cast<std::size_t>(k)]; }
  Isometry3d between(int a, int b) const { return pose(a).inverse() * pose(b); }
  bool far(int a, int b) const { return between(a, b).translation().norm() > kWrong; }
  Isometry3d noise() {
    const auto normal = [&](double sigma) {
      return std::normal_distribution<double>(0.0, sigma)(generator_);
    };
    Isometry3d T = Isometry3d::Identity();
    T.translation() << normal(0.3), normal(0.3), planar_ ? 0.0 : normal(0.3);
    const Vector3d w = planar_ ? Vector3d(0.0, 0.0, normal(0.17))
                               : Vector3d(normal(0.1), normal(0.1), normal(0.1));
    T.linear() = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
    return T;
  }
  /// `length` loops, every `step` keyframes, that take the stretch from a on for that from b on.
  void stretch(int a, int b, int length, int step, std::vector<WrongLoop>& loops) {
    const Isometry3d start = noise();
    for (int k = 0; k < length; ++k) {
      const int from = a + k * step, to = b + k * step;
      add(from, to, between(from, a) * start * between(b, to), loops);
    }
  }
  void add(int a, int b, const Isometry3d& T, std::vector<WrongLoop>& loops) const {
    if (!far(a, b)) return;
    WrongLoop loop;
    loop.from = id(a);
    loop.to = id(b);
    loop.measured.T = T;
    loops.push_back(loop);
  }

 private:
  bool planar_;
  std::mt19937_64 generator_;
  std::vector<int> ids_;
  std::vector<Isometry3d> poses_;
};

void try_one(const std::string& kind, WrongLoopMaker& maker, std::vector<WrongLoop>& loops) {
  const int n = maker.size();
  if (kind == "alike") {
    const int a = maker.below(n), b = maker.below(n);
    maker.add(a, b, maker.noise(), loops);
  } else if (kind == "anywhere") {
    const int a = maker.below(n), b = maker.below(n);
    const Isometry3d T = maker.between(maker.below(n), maker.below(n));
    const Isometry3d off = T.inverse() * maker.between(a, b);
    if (off.translation().norm() > 10.0 || Eigen::AngleAxisd(off.linear()).angle() > 0.5) {
      maker.add(a, b, T, loops);
    }
  } else if (kind == "groups" && n > 60) {
    const int a = maker.below(n - 20), b = maker.below(n - 20);
    const int length = 5 + maker.below(6), step = 1 + maker.below(2);
    if (std::abs(a - b) > 50) maker.stretch(a, b, length, step, loops);
  } else if (kind == "beside" && n > 60) {
    const int a = maker.below(n - 10), b = maker.below(n - 10);
    const Isometry3d T = maker.between(a, b);
    const double apart = T.translation().norm();
    if (apart > 10.5 && apart < 35.0 && T.linear()(0, 0) > 0.9 && std::abs(a - b) > 40) {
      maker.stretch(a, b, 3 + maker.below(8), 1, loops);
    }
  }
}

}  // namespace

std::vector<std::string> wrong_loop_kinds() { return {"alike", "anywhere", "groups", "beside"}; }

std::vector<WrongLoop> wrong_loops(const std::map<int, Isometry3d>& truth, bool planar,
                                   const std::string& kind, int count, std::uint64_t seed,
                                   const std::vector<Eigen::Matrix<double, 6, 6>>& informations) {
  std::vector<WrongLoop> loops;
  if (truth.empty() || informations.empty()) return loops;
  WrongLoopMaker maker(truth, planar, seed);
  for (long tries = 0; std::ssize(loops) < count && tries < long{kTries} * count; ++tries) {
    try_one(kind, maker, loops);
  }
  for (WrongLoop& loop : loops) {
    loop.measured.information =
        informations[static_cast<std::size_t>(maker.below(static_cast<int>(informations.size())))];
  }
  return loops;
}

}  // namespace prospect
