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

/// What is known before: the guess, and the inverse of its covariance about the centre.
struct Prior {
  PlanarMove guess;
  Eigen::Matrix3d information;
};

/// By which (x, y, yaw) about the centre the second one lies off the first one.
Eigen::Vector3d between(const PlanarMove& first, const PlanarMove& second,
                        const Eigen::Vector2d& centre) {
  const PlanarMove off = second * first.inverse();
  Eigen::Vector3d d;
  d << off(centre) - centre, std::remainder(off.yaw, 2.0 * M_PI);
  return d;
}

/// One step from `move`; with walls within `reach`. share: of walls that are independent.
bool improve(const std::vector<SubmapSurface::Wall>& walls, const NearestWall& other,
             const Prior& prior, double share, const Eigen::Vector2d& centre, double reach,
             Fit& fit) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
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
  H += prior.information / share;
  g += prior.information * between(prior.guess, fit.move, centre) / share;
  const Eigen::Vector3d step = -H.ldlt().solve(g);
  if (!step.allFinite()) return false;
  fit.move = about(centre, step) * fit.move;
  return true;
}

struct Judged {
  SubmapAlignment alignment;
  int known = 0;      // walls that lie where the other knows something
  double gain = 0.0;  // sum of what each of them gains

  /// log L less that of `best`, of walls that are all independent: each counts against the mean of
  /// the best, so those that lie where nothing is known say nothing.
  double less_than(const Judged& best) const { return gain - known * best.gain / best.known; }
};

Judged judged(const std::vector<SubmapSurface::Wall>& walls, const NearestWall& other,
              const PlanarMove& move) {
  constexpr double kBound = kNearReach / kSigma;
  static const double most = std::log(1.0 + kBound * kBound);
  Judged end;
  SubmapAlignment& a = end.alignment;
  a.move = move;
  const Eigen::Rotation2Dd turn(move.yaw);
  for (const SubmapSurface::Wall& wall : walls) {
    const Eigen::Vector3d q = move(wall.at);
    const SubmapSurface::Wall* nearest = other.nearest(q, turn * wall.normal, wall.either);
    const bool near =
        nearest != nullptr && (q - nearest->at).head<2>().squaredNorm() < kNearReach * kNearReach;
    if (!near && other.place(q) == NearestWall::Place::kUnknown) continue;
    ++end.known;
    a.matched += near;
    if (!near) continue;
    const double e = nearest->normal.dot((q - nearest->at).head<2>()) / kSigma;
    end.gain += most - std::log(1.0 + e * e);
  }
  a.agreement = end.known > 0 ? static_cast<double>(a.matched) / end.known : 0.0;
  a.overlap =
      walls.empty() ? 0.0 : static_cast<double>(end.known) / static_cast<double>(walls.size());
  return end;
}

/// What the walls say about the centre, as a Gaussian: information and mean from `end`.
struct Told {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
};

/// Moments of a density along a line, by trapezia.
class Moments {
 public:
  void add(double at, double width, double density) {
    zeroth_ += density * width;
    first_ += density * width * at;
    second_ += density * width * at * at;
  }
  double mean() const { return first_ / zeroth_; }
  double variance() const { return second_ / zeroth_ - mean() * mean(); }

 private:
  double zeroth_ = 0.0, first_ = 0.0, second_ = 0.0;
};

/// Walks from `end` along the eigenvectors of H, of which a turn counts by kArm.
Told walked(const std::vector<SubmapSurface::Wall>& walls, const NearestWall& other,
            const Prior& prior, const Eigen::Vector2d& centre, const Judged& end,
            const Eigen::Matrix3d& H, double share) {
  constexpr double kFar = 0.6;  // [m]
  constexpr double kGrowth = 1.3;
  const Eigen::DiagonalMatrix<double, 3> scale(1.0, 1.0, 1.0 / kArm), back(1.0, 1.0, kArm);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scale * H * scale);
  const Eigen::Matrix3d before = scale * prior.information * scale;
  const Eigen::Vector3d off = back * between(prior.guess, end.alignment.move, centre);
  Told told;
  for (int n = 0; n < 3; ++n) {
    const Eigen::Vector3d direction = eigen.eigenvectors().col(n);
    const double p = direction.dot(before * direction), q = direction.dot(before * off);
    Moments prior_alone, posterior;
    for (const double sense : {-1.0, 1.0}) {
      // Steps grow with the way, so that both a sharp and a flat one are met.
      double at = 0.0, step = 0.2 / std::sqrt(p + share * eigen.eigenvalues()[n]), width = 0.0;
      while (true) {
        const double t = sense * at;
        const PlanarMove moved =
            about(centre, scale * Eigen::Vector3d(t * direction)) * end.alignment.move;
        const double l = share * judged(walls, other, moved).less_than(end);
        const double next = std::min(step, kFar - at);
        const double density = std::exp(-0.5 * p * t * t - q * t);
        prior_alone.add(t, 0.5 * (width + next), density);
        posterior.add(t, 0.5 * (width + next), density * std::exp(l));
        if (next <= 0.0) break;
        at += next, width = next, step *= kGrowth;
      }
    }
    const double v = posterior.variance(), u = prior_alone.variance();
    const double information = 1.0 / v - 1.0 / u;
    if (!(information > 0.0)) continue;
    const double mean = (posterior.mean() / v - prior_alone.mean() / u) / information;
    told.information += information * direction * direction.transpose();
    told.mean += std::clamp(mean, -kFar, kFar) * direction;
  }
  told.information = back * told.information * back;
  told.mean = scale * told.mean;
  return told;
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
  const Eigen::Matrix3d stiff =
      Eigen::Vector3d(kStiff * kStiff, kStiff * kStiff, kStiffYaw * kStiffYaw).asDiagonal();
  const Prior prior{guess, (spread + stiff).inverse()};
  struct End {
    Judged judged;
    Eigen::Matrix3d information;
    double likelihood;  // its logarithm, with what was known before
  };
  std::vector<End> ends;
  for (const PlanarMove& from : beginnings(guess, spread, centre)) {
    Fit fit{from, {}};
    bool found = true;
    for (int n = 0; n < kIterations && found; ++n) {
      const double reach = std::max(kNearReach, kFarReach * std::pow(0.87, n));
      found = improve(walls, other, prior, share, centre, reach, fit);
    }
    if (!found) continue;
    const Eigen::Vector3d off = between(guess, fit.move, centre);
    End end{judged(walls, other, fit.move), fit.information, 0.0};
    end.likelihood = share * end.judged.gain - 0.5 * off.dot(prior.information * off);
    ends.push_back(end);
  }
  if (ends.empty()) return {};
  const End& best = *std::max_element(ends.begin(), ends.end(), [](const End& a, const End& b) {
    return a.likelihood < b.likelihood;
  });
  SubmapAlignment found = best.judged.alignment;
  if (found.matched < kLeastMatched || found.agreement < kLeastAgreement) return {};
  const Told told = walked(walls, other, prior, centre, best.judged, best.information, share);
  const Eigen::Matrix3d unmeasured =
      Eigen::Vector3d::Constant(1.0 / (kUnmeasured * kUnmeasured)).asDiagonal();
  found.covariance = (told.information + unmeasured).inverse();
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
    const double weight = std::exp(end.likelihood - best.likelihood);
    weights += weight;
    square += weight * off * off.transpose();
  }
  found.move = about(centre, told.mean) * found.move;
  found.covariance += square / weights + stiff;
  found.covariance = 0.5 * (found.covariance + found.covariance.transpose()).eval();
  return found;
}

}  // namespace prospect
