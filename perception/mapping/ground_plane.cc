// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/ground_plane.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <vector>

namespace prospect {
namespace {

constexpr int kIterations = 8;
constexpr int kBlocks = 8;       // of errors that are alike, across the image
constexpr double kApart = 0.05;  // [m]: planes nearer than this are one

struct Plane {
  Eigen::Vector3d n;
  double h = 0.0;
};

/// Points, and the squared noise of their depth over the depth: ground_sigma() in parts.
struct Scored {
  std::vector<double> x, y, z, noise2;
  std::vector<Eigen::Vector3d> points;

  void add(const Eigen::Vector3d& p, const GroundPlaneOptions& options) {
    const double noise = depth_sigma(p.z(), options) / p.z();
    x.push_back(p.x());
    y.push_back(p.y());
    z.push_back(p.z());
    noise2.push_back(noise * noise);
    points.push_back(p);
  }
};

struct Sums {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

class Search {
 public:
  Search(const GroundPrior& prior, const GroundPlaneOptions& options)
      : prior_(prior), options_(options), cos_tilt_(std::cos(prior.tilt_tolerance)) {}

  bool admits(const Plane& plane) const {
    return plane.n.dot(prior_.up) >= cos_tilt_ &&
           std::abs(plane.h - prior_.height) <= prior_.height_tolerance;
  }

  /// Whether some plane that the prior admits passes through p, nearly.
  bool may_hold(const Eigen::Vector3d& p) const {
    const double above = prior_.up.dot(p) + prior_.height;
    return std::abs(above) <= prior_.height_tolerance + p.norm() * std::sin(prior_.tilt_tolerance);
  }

  /// `on`: number of points on the plane.
  double score(const Scored& points, const Plane& plane, int& on) const {
    const double g2 = options_.gate * options_.gate;
    const double floor2 = g2 * options_.unevenness * options_.unevenness;
    const double slope2 = g2 * plane.h * plane.h;
    const double below = -1.0 / options_.most_below;
    double sum = 0.0;
    on = 0;
    for (std::size_t i = 0; i < points.x.size(); ++i) {
      const double e = plane.n.x() * points.x[i] + plane.n.y() * points.y[i] +
                       plane.n.z() * points.z[i] + plane.h;
      const double share = e * e / (floor2 + slope2 * points.noise2[i]);
      const bool inside = share < 1.0;
      on += inside;
      sum += inside ? 1.0 - share : e < 0.0 ? below : 0.0;
    }
    return sum;
  }

  /// Tukey's weights reach further than the gate at first, so that a hypothesis from three noisy
  /// points can move. False if the points do not fix the plane.
  bool refine(const std::vector<Eigen::Vector3d>& points, Plane& plane) const {
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      const double reach = options_.gate * (iteration < kIterations / 2 ? 2.0 : 1.0);
      const Sums s = sums(points, plane, [reach](double w) {
        const double x = 1.0 - (w / reach) * (w / reach);
        return std::abs(w) < reach ? x * x : 0.0;
      });
      const Eigen::FullPivLU<Eigen::Matrix3d> lu(s.information);
      if (!lu.isInvertible()) return false;
      const Eigen::Vector3d step = -lu.solve(s.gradient);
      if (!step.allFinite()) return false;
      Eigen::Vector3d t1, t2;
      ground_tangents(plane.n, t1, t2);
      plane.n = (plane.n + step[0] * t1 + step[1] * t2).normalized();
      plane.h += step[2];
      if (step.norm() < 1e-9) break;
    }
    return true;
  }

  /// Normal equations of (theta_1, theta_2, h); weight(e/sigma).
  template <typename Weight>
  Sums sums(const std::vector<Eigen::Vector3d>& points, const Plane& plane, Weight weight) const {
    Eigen::Vector3d t1, t2;
    ground_tangents(plane.n, t1, t2);
    Sums s;
    for (const Eigen::Vector3d& p : points) {
      const double e = plane.n.dot(p) + plane.h;
      const double sigma = ground_sigma(plane.h, p.z(), options_);
      const double w = weight(e / sigma) / (sigma * sigma);
      if (w == 0.0) continue;
      const Eigen::Vector3d J(t1.dot(p), t2.dot(p), 1.0);
      s.information += w * J * J.transpose();
      s.gradient += w * e * J;
    }
    return s;
  }

 private:
  const GroundPrior& prior_;
  const GroundPlaneOptions& options_;
  double cos_tilt_;
};

}  // namespace

GroundPrior ground_prior(double height, double pitch, double roll, double height_tolerance,
                         double tilt_tolerance) {
  GroundPrior prior;
  // Level, up is -y; the camera then pitches down and rolls.
  prior.up = Eigen::Vector3d(-std::sin(roll) * std::cos(pitch), -std::cos(roll) * std::cos(pitch),
                             -std::sin(pitch));
  prior.height = height;
  prior.height_tolerance = height_tolerance;
  prior.tilt_tolerance = tilt_tolerance;
  return prior;
}

GroundPrior ground_prior(const Eigen::Isometry3d& T_WC, double height_tolerance,
                         double tilt_tolerance) {
  GroundPrior prior;
  prior.up = T_WC.linear().row(2).transpose();
  prior.height = T_WC.translation().z();
  prior.height_tolerance = height_tolerance;
  prior.tilt_tolerance = tilt_tolerance;
  return prior;
}

double GroundPlane::pitch() const { return std::asin(std::clamp(-normal.z(), -1.0, 1.0)); }
double GroundPlane::roll() const { return std::atan2(-normal.x(), -normal.y()); }

double GroundPlane::sigma_tilt() const {
  const Eigen::Matrix2d tilt = covariance.topLeftCorner<2, 2>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(tilt, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[1]));
}
double GroundPlane::sigma_height() const { return std::sqrt(std::max(0.0, covariance(2, 2))); }

double ground_sigma(double height, double z, const GroundPlaneOptions& options) {
  const double along = height / z * depth_sigma(z, options);
  return std::sqrt(options.unevenness * options.unevenness + along * along);
}

namespace {

/// The points of an image that a search looks at.
struct Cloud {
  std::vector<Eigen::Vector3d> points;
  std::vector<int> blocks;              ///< of the image, that the points lie in
  Scored scored;                        ///< every so manyeth of them
  std::vector<std::size_t> candidates;  ///< of `points`: may lie on a plane that the prior admits
  int scored_candidates = 0;
  int depths = 0;  ///< pixels with a depth, `points` or not
};

/// Those that `wanted(p)`.
template <typename Wanted>
Cloud cloud_of(const PinholeCamera& camera, const DepthImage& image, const Search& search,
               const GroundPlaneOptions& options, Wanted wanted) {
  const int stride = std::max(1, options.stride);
  const int every = std::max(1, options.score_stride / stride);
  const int block = std::max(1, image.width / kBlocks);
  const int columns = image.width / block + 1;
  Cloud cloud;
  for (int v = stride / 2, row = 0; v < image.height; v += stride, ++row) {
    for (int u = stride / 2, column = 0; u < image.width; u += stride, ++column) {
      const double z = image.at(u, v);
      if (!options.range.holds(z)) continue;
      ++cloud.depths;
      const Eigen::Vector3d p = z * pixel_ray(camera, u, v);
      if (!wanted(p)) continue;
      const bool candidate = search.may_hold(p);
      if (candidate) cloud.candidates.push_back(cloud.points.size());
      cloud.points.push_back(p);
      cloud.blocks.push_back(v / block * columns + u / block);
      if (row % every == 0 && column % every == 0) {
        cloud.scored.add(p, options);
        cloud.scored_candidates += candidate;
      }
    }
  }
  return cloud;
}

/// Delete-a-block jackknife: what leaving out each block of the image would change, one
/// Gauss-Newton step. `information` is that of all points on the plane.
Eigen::Matrix3d jackknife_covariance(const Cloud& cloud, const GroundPlane& plane,
                                     const GroundPlaneOptions& options,
                                     const Eigen::Matrix3d& information) {
  Eigen::Vector3d t1, t2;
  ground_tangents(plane.normal, t1, t2);
  std::map<int, Sums> blocks;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3d& p = cloud.points[i];
    const double e = plane.above(p);
    const double sigma = ground_sigma(plane.height, p.z(), options);
    if (!(std::abs(e) < options.gate * sigma)) continue;
    const Eigen::Vector3d J(t1.dot(p), t2.dot(p), 1.0);
    Sums& block = blocks[cloud.blocks[i]];
    block.information += J * J.transpose() / (sigma * sigma);
    block.gradient += e / (sigma * sigma) * J;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& [number, block] : blocks) {
    const Eigen::Matrix3d others = information - block.information;
    const Eigen::FullPivLU<Eigen::Matrix3d> lu(others);
    if (!lu.isInvertible()) continue;
    const Eigen::Vector3d change = lu.solve(block.gradient);
    covariance += change * change.transpose();
  }
  const auto n = static_cast<double>(blocks.size());
  return (n - 1.0) / n * covariance;
}

/// The best plane of a cloud. `fixed` says whether normal and height are those of a plane, found or
/// not.
GroundPlane search_cloud(const Cloud& cloud, const GroundPrior& prior, const Search& search,
                         const GroundPlaneOptions& options, bool& fixed) {
  GroundPlane out;
  fixed = false;
  const auto missed = [&out](std::string why) {
    out.found = false;
    out.reason = std::move(why);
    return out;
  };
  const std::vector<Eigen::Vector3d>& points = cloud.points;
  const std::vector<std::size_t>& candidates = cloud.candidates;
  out.points = cloud.depths;
  if (points.size() < 3) return missed("no depth");
  if (candidates.size() < 3) return missed("no point where the ground is expected");

  std::mt19937_64 generator(options.seed);
  const auto draw = [&]() -> const Eigen::Vector3d& {
    return points[candidates[((generator() >> 32) * candidates.size()) >> 32]];
  };
  Plane best;
  double best_score = 0.0;
  bool any = false;
  double needed = options.most_draws;
  for (int n = 0; n < needed; ++n) {
    const Eigen::Vector3d &a = draw(), &b = draw(), &c = draw();
    const Eigen::Vector3d cross = (b - a).cross(c - a);
    const double area = cross.norm();
    if (!(area > 1e-4)) continue;
    Plane plane{cross / area, 0.0};
    if (plane.n.dot(prior.up) < 0.0) plane.n = -plane.n;
    plane.h = -plane.n.dot(a);
    if (!search.admits(plane)) continue;
    int on = 0;
    double score = search.score(cloud.scored, plane, on);
    if (any && score <= best_score) continue;
    Plane refined = plane;
    if (search.refine(cloud.scored.points, refined) && search.admits(refined)) {
      int on_refined = 0;
      const double better = search.score(cloud.scored, refined, on_refined);
      if (better > score) {
        plane = refined;
        score = better;
        on = on_refined;
      }
    }
    any = true;
    best = plane;
    best_score = score;
    // A plane with as much below it as on it is no reason to stop looking.
    const double share =
        score > 0.0 ? static_cast<double>(on) / std::max(1, cloud.scored_candidates) : 0.0;
    const double all_three = std::clamp(share * share * share, 1e-9, 0.999);
    needed = std::min(needed, std::log1p(-options.confidence) / std::log1p(-all_three));
  }
  if (!any) return missed("no plane at the expected tilt and height");
  if (!search.refine(points, best)) return missed("the points do not fix a plane");
  out.normal = best.n;
  out.height = best.h;
  fixed = true;

  const Sums s = search.sums(
      points, best, [&options](double w) { return std::abs(w) < options.gate ? 1.0 : 0.0; });
  double chi2 = 0.0;
  for (const Eigen::Vector3d& p : points) {
    const double w = out.above(p) / ground_sigma(best.h, p.z(), options);
    if (std::abs(w) < options.gate) {
      chi2 += w * w;
      ++out.inliers;
    } else if (w < 0.0) {
      ++out.below;
    }
  }
  if (!search.admits(best)) return missed("no plane at the expected tilt and height");
  if (out.inliers < std::max(10.0, options.min_share * out.points)) {
    return missed("too little ground in view");
  }
  if (out.below > options.most_below * out.inliers) {
    return missed("too much lies below the plane");
  }
  out.chi2_per_dof = chi2 / std::max(1, out.inliers - 3);
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(s.information);
  if (!lu.isInvertible()) return missed("the points do not fix a plane");
  const double patch = static_cast<double>(options.patch) / std::max(1, options.stride);
  out.covariance = std::max(1.0, out.chi2_per_dof) * std::max(1.0, patch * patch) * lu.inverse();
  if (!(out.sigma_tilt() <= options.most_sigma_tilt &&
        out.sigma_height() <= options.most_sigma_height)) {
    return missed("too little ground in view");
  }
  out.covariance = jackknife_covariance(cloud, out, options, s.information);
  out.found = true;
  return out;
}

bool fits(const PinholeCamera& camera, const DepthImage& image) {
  return image.whole() && image.width == camera.width && image.height == camera.height;
}

}  // namespace

void ground_tangents(const Eigen::Vector3d& n, Eigen::Vector3d& t1, Eigen::Vector3d& t2) {
  t1 = Eigen::Vector3d::UnitX() - n.x() * n;
  if (t1.squaredNorm() < 1e-6) t1 = Eigen::Vector3d::UnitZ() - n.z() * n;
  t1.normalize();
  t2 = n.cross(t1);
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

GroundPlane find_ground(const PinholeCamera& camera, const DepthImage& image,
                        const GroundPrior& prior, const GroundPlaneOptions& options) {
  GroundPlane out;
  if (!fits(camera, image)) {
    out.reason = "the image has the wrong size";
    return out;
  }
  const Search search(prior, options);
  bool fixed = false;
  return search_cloud(
      cloud_of(camera, image, search, options, [](const Eigen::Vector3d&) { return true; }), prior,
      search, options, fixed);
}

std::vector<GroundPlane> find_planes_below(const PinholeCamera& camera, const DepthImage& image,
                                           const GroundPrior& prior, const GroundPlane& above,
                                           const GroundPlaneOptions& options) {
  constexpr int kMost = 3;
  std::vector<GroundPlane> found;
  if (!fits(camera, image)) return found;
  const Search search(prior, options);
  GroundPlane last = above;
  for (int n = 0; n < kMost; ++n) {
    bool fixed = false;
    const Cloud cloud = cloud_of(camera, image, search, options, [&](const Eigen::Vector3d& p) {
      const double noise = options.gate * ground_sigma(last.height, p.z(), options);
      return last.above(p) < -std::max(kApart, noise);
    });
    if (static_cast<double>(cloud.candidates.size()) < options.min_share * cloud.depths) break;
    const GroundPlane plane = search_cloud(cloud, prior, search, options, fixed);
    if (plane.found) found.push_back(plane);
    if (!fixed) break;
    last = plane;
  }
  return found;
}

}  // namespace prospect
