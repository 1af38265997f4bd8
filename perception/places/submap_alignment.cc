// SPDX-License-Identifier: Apache-2.0
#include "perception/places/submap_alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace prospect {
namespace {

constexpr double kSigma = 0.05;  // [m], of a wall on a voxel's lattice
constexpr double kFarReach = 0.6, kNearReach = 0.15;
constexpr int kIterations = 15;
constexpr double kIndependent = 0.1;                // share of walls
constexpr double kUnmeasured = 10.0;                // [m], [rad]
constexpr double kStiff = 0.01, kStiffYaw = 0.002;  // [m], [rad]
constexpr int kLeastMatched = 60;
constexpr double kLeastAgreement = 0.6;
constexpr std::size_t kMostWalls = 800;
constexpr double kArm = 3.0;  // [m] at which a turn counts as a shift

/// About a centre: p -> R(yaw) (p - c) + c + (x, y).
PlanarMove about(const Eigen::Vector2d& c, const Eigen::Vector3d& d) {
  return {c + d.head<2>() - Eigen::Rotation2Dd(d[2]) * c, d[2]};
}

/// Less what it owes to the errors of the walls' directions, about 0.15 rad: those of a corridor
/// seem to say a little of what lies along it.
Eigen::Matrix3d without_noise(const Eigen::Matrix3d& information) {
  constexpr double kOfDirections = 0.02;  // variance
  const Eigen::Vector3d scale(1.0, 1.0, 1.0 / kArm);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scale.asDiagonal() * information *
                                                             scale.asDiagonal());
  const double noise = kOfDirections * information.topLeftCorner<2, 2>().trace();
  const Eigen::Vector3d left = (eigen.eigenvalues().array() - noise).max(0.0);
  const Eigen::Vector3d back = scale.cwiseInverse();
  return back.asDiagonal() * eigen.eigenvectors() * left.asDiagonal() *
         eigen.eigenvectors().transpose() * back.asDiagonal();
}

struct Fit {
  PlanarMove move;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
};

/// One step from `move`; with walls within `reach`.
bool improve(const std::vector<SubmapSurface::Wall>& walls, const NearestWall& other,
             const Eigen::Vector2d& centre, double reach, Fit& fit) {
  Eigen::Matrix3d H = Eigen::Vector3d::Constant(1.0 / (kUnmeasured * kUnmeasured)).asDiagonal();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  int matched = 0;
  for (const SubmapSurface::Wall& wall : walls) {
    const Eigen::Vector3d q = fit.move(wall.at);
    const SubmapSurface::Wall* nearest = other.nearest(q);
    if (nearest == nullptr) continue;
    const Eigen::Vector2d off = q.head<2>() - nearest->at.head<2>();
    if (off.squaredNorm() > reach * reach) continue;
    // Walls that face elsewhere are others.
    const Eigen::Vector2d n = Eigen::Rotation2Dd(fit.move.yaw) * wall.normal;
    if (std::abs(n.dot(nearest->normal)) < 0.8) continue;
    const double e = nearest->normal.dot(off) / kSigma;
    const double weight = 1.0 / (1.0 + e * e);
    const Eigen::Vector2d arm = q.head<2>() - centre;
    const Eigen::Vector3d J(nearest->normal.x() / kSigma, nearest->normal.y() / kSigma,
                            nearest->normal.dot(Eigen::Vector2d(-arm.y(), arm.x())) / kSigma);
    H += weight * J * J.transpose();
    g += weight * e * J;
    ++matched;
  }
  if (matched < kLeastMatched / 2) return false;
  fit.information = H;
  const Eigen::Vector3d step = -H.ldlt().solve(g);
  if (!step.allFinite()) return false;
  fit.move = about(centre, step) * fit.move;
  return true;
}

SubmapAlignment judged(const std::vector<SubmapSurface::Wall>& walls, const NearestWall& other,
                       const PlanarMove& move) {
  SubmapAlignment a;
  a.move = move;
  int known = 0;
  for (const SubmapSurface::Wall& wall : walls) {
    const Eigen::Vector3d q = move(wall.at);
    const SubmapSurface::Wall* nearest = other.nearest(q);
    const bool near =
        nearest != nullptr && (q - nearest->at).head<2>().squaredNorm() < kNearReach * kNearReach;
    if (!near && other.place(q) == NearestWall::Place::kUnknown) continue;
    ++known;
    a.matched += near;
  }
  a.agreement = known > 0 ? static_cast<double>(a.matched) / known : 0.0;
  a.overlap = walls.empty() ? 0.0 : static_cast<double>(known) / static_cast<double>(walls.size());
  return a;
}

/// Where to begin.
std::vector<PlanarMove> beginnings(const PlanarMove& guess, const Eigen::Matrix3d& spread,
                                   const Eigen::Vector2d& centre) {
  constexpr double kSure = 0.1, kMostShift = 0.5, kMostTurn = 0.15;
  std::vector<PlanarMove> all = {guess};
  const double x = std::sqrt(std::max(0.0, spread(0, 0))),
               y = std::sqrt(std::max(0.0, spread(1, 1))),
               yaw = std::sqrt(std::max(0.0, spread(2, 2)));
  if (std::max({x, y, kArm * yaw}) < kSure) return all;
  const Eigen::Vector3d by(std::min(2.0 * x, kMostShift), std::min(2.0 * y, kMostShift),
                           std::min(2.0 * yaw, kMostTurn));
  for (int a = -1; a <= 1; ++a) {
    for (int b = -1; b <= 1; ++b) {
      for (int c = -1; c <= 1; ++c) {
        if (a == 0 && b == 0 && c == 0) continue;
        all.push_back(about(centre, by.cwiseProduct(Eigen::Vector3d(a, b, c))) * guess);
      }
    }
  }
  return all;
}

}  // namespace

std::optional<SubmapAlignment> align(const SubmapSurface& one, const NearestWall& other,
                                     const PlanarMove& guess, const Eigen::Matrix3d& spread,
                                     const Eigen::Vector2d& centre) {
  std::vector<SubmapSurface::Wall> walls = one.walls();
  if (walls.size() > kMostWalls) {
    for (std::size_t n = 0; n < kMostWalls; ++n) walls[n] = walls[n * walls.size() / kMostWalls];
    walls.resize(kMostWalls);
  }
  std::optional<SubmapAlignment> best;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const PlanarMove& from : beginnings(guess, spread, centre)) {
    Fit fit{from, {}};
    bool found = true;
    for (int n = 0; n < kIterations && found; ++n) {
      const double reach = std::max(kNearReach, kFarReach * std::pow(0.87, n));
      found = improve(walls, other, centre, reach, fit);
    }
    if (!found) continue;
    const SubmapAlignment end = judged(walls, other, fit.move);
    if (best && end.matched <= best->matched) continue;
    best = end;
    information = fit.information;
  }
  if (!best || best->matched < kLeastMatched || best->agreement < kLeastAgreement) return {};
  const double more =
      walls.empty() ? 1.0
                    : static_cast<double>(one.walls().size()) / static_cast<double>(walls.size());
  const Eigen::Matrix3d unmeasured =
      Eigen::Vector3d::Constant(1.0 / (kUnmeasured * kUnmeasured)).asDiagonal();
  information = kIndependent * more * without_noise(information - unmeasured) + unmeasured;
  best->covariance = information.inverse();
  best->covariance = 0.5 * (best->covariance + best->covariance.transpose()).eval();
  best->covariance.diagonal() +=
      Eigen::Vector3d(kStiff * kStiff, kStiff * kStiff, kStiffYaw * kStiffYaw);
  return best;
}

}  // namespace prospect
