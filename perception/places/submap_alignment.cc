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
    const Eigen::Vector2d n = Eigen::Rotation2Dd(fit.move.yaw) * wall.normal;
    const SubmapSurface::Wall* nearest = other.nearest(q, n, wall.either);
    if (nearest == nullptr) continue;
    const Eigen::Vector2d off = q.head<2>() - nearest->at.head<2>();
    if (off.squaredNorm() > reach * reach) continue;
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

struct Judged {
  SubmapAlignment alignment;
  double likelihood = 0.0;  // its logarithm, of walls that are all independent
};

Judged judged(const std::vector<SubmapSurface::Wall>& walls, const NearestWall& other,
              const PlanarMove& move) {
  constexpr double kBound = kNearReach / kSigma;
  static const double most = std::log(1.0 + kBound * kBound);
  Judged end;
  SubmapAlignment& a = end.alignment;
  a.move = move;
  const Eigen::Rotation2Dd turn(move.yaw);
  int known = 0;
  for (const SubmapSurface::Wall& wall : walls) {
    const Eigen::Vector3d q = move(wall.at);
    const SubmapSurface::Wall* nearest = other.nearest(q, turn * wall.normal, wall.either);
    const bool near =
        nearest != nullptr && (q - nearest->at).head<2>().squaredNorm() < kNearReach * kNearReach;
    if (!near && other.place(q) == NearestWall::Place::kUnknown) continue;
    ++known;
    a.matched += near;
    if (!near) continue;
    const double e = nearest->normal.dot((q - nearest->at).head<2>()) / kSigma;
    end.likelihood += most - std::log(1.0 + e * e);
  }
  a.agreement = known > 0 ? static_cast<double>(a.matched) / known : 0.0;
  a.overlap = walls.empty() ? 0.0 : static_cast<double>(known) / static_cast<double>(walls.size());
  return end;
}

/// Information about the centre, of a likelihood that is `end`'s at its place: walked along the
/// eigenvectors of H, of which a turn counts by kArm. share: of walls that are independent.
Eigen::Matrix3d walked(const std::vector<SubmapSurface::Wall>& walls, const NearestWall& other,
                       const Eigen::Vector2d& centre, const Judged& end, const Eigen::Matrix3d& H,
                       double share) {
  constexpr double kFar = 0.6;  // [m]
  constexpr double kFlat = 3.0 / (kFar * kFar);
  constexpr double kGrowth = 1.4;
  const Eigen::DiagonalMatrix<double, 3> scale(1.0, 1.0, 1.0 / kArm), back(1.0, 1.0, kArm);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scale * H * scale);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (int n = 0; n < 3; ++n) {
    const Eigen::Vector3d direction = eigen.eigenvectors().col(n);
    double area = 0.0, square = 0.0;
    for (const double sense : {-1.0, 1.0}) {
      // Steps grow with the way, so that both a sharp and a flat one are met. Trapezia.
      double at = 0.0, weight = 1.0;
      for (double step = 0.25 / std::sqrt(share * std::max(eigen.eigenvalues()[n], 1.0)); at < kFar;
           step *= kGrowth) {
        const double next = std::min(at + step, kFar);
        const PlanarMove moved =
            about(centre, scale * Eigen::Vector3d(sense * next * direction)) * end.alignment.move;
        const double w = std::exp(
            std::min(0.0, share * (judged(walls, other, moved).likelihood - end.likelihood)));
        area += 0.5 * (weight + w) * (next - at);
        square += 0.5 * (weight * at * at + w * next * next) * (next - at);
        at = next, weight = w;
      }
    }
    const double told = std::max(0.0, area / square - kFlat);
    information += told * direction * direction.transpose();
  }
  return back * information * back;
}

/// By which (x, y, yaw) about the centre the second one lies off the first one.
Eigen::Vector3d between(const PlanarMove& first, const PlanarMove& second,
                        const Eigen::Vector2d& centre) {
  const PlanarMove off = second * first.inverse();
  Eigen::Vector3d d;
  d << off(centre) - centre, std::remainder(off.yaw, 2.0 * M_PI);
  return d;
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
  const double share = kIndependent * static_cast<double>(one.walls().size()) /
                       static_cast<double>(std::max<std::size_t>(1, walls.size()));
  struct End {
    Judged judged;
    Eigen::Matrix3d information;
  };
  std::vector<End> ends;
  for (const PlanarMove& from : beginnings(guess, spread, centre)) {
    Fit fit{from, {}};
    bool found = true;
    for (int n = 0; n < kIterations && found; ++n) {
      const double reach = std::max(kNearReach, kFarReach * std::pow(0.87, n));
      found = improve(walls, other, centre, reach, fit);
    }
    if (found) ends.push_back({judged(walls, other, fit.move), fit.information});
  }
  if (ends.empty()) return {};
  const End& best = *std::max_element(ends.begin(), ends.end(), [](const End& a, const End& b) {
    return a.judged.likelihood < b.judged.likelihood;
  });
  SubmapAlignment found = best.judged.alignment;
  if (found.matched < kLeastMatched || found.agreement < kLeastAgreement) return {};
  const Eigen::Matrix3d unmeasured =
      Eigen::Vector3d::Constant(1.0 / (kUnmeasured * kUnmeasured)).asDiagonal();
  const Eigen::Matrix3d information =
      walked(walls, other, centre, best.judged, best.information, share) + unmeasured;
  found.covariance = information.inverse();
  // Other ends: those that are not the same one, each once.
  std::vector<Eigen::Vector3d> others = {Eigen::Vector3d::Zero()};
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  double weights = 1.0;
  for (const End& end : ends) {
    const Eigen::Vector3d off = between(found.move, end.judged.alignment.move, centre);
    const bool met = std::any_of(others.begin(), others.end(), [&](const Eigen::Vector3d& o) {
      const Eigen::Vector3d d = off - o;
      return std::max(d.head<2>().norm(), kArm * std::abs(d[2])) < kSigma;
    });
    if (met) continue;
    others.push_back(off);
    const double weight = std::exp(share * (end.judged.likelihood - best.judged.likelihood));
    weights += weight;
    square += weight * off * off.transpose();
  }
  found.covariance += square / weights;
  found.covariance = 0.5 * (found.covariance + found.covariance.transpose()).eval();
  found.covariance.diagonal() +=
      Eigen::Vector3d(kStiff * kStiff, kStiff * kStiff, kStiffYaw * kStiffYaw);
  return found;
}

}  // namespace prospect
