// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "models/camera.h"
#include "perception/mapping/depth_image.h"

namespace prospect {

/// What is known of the ground before an image is looked at: where up is in the camera's frame C,
/// how high the camera is, and how wrong both may be.
struct GroundPrior {
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();  ///< unit vector in C
  double height = 0.45;                            ///< of the camera above the ground [m]
  double tilt_tolerance = 0.17;                    ///< [rad]
  double height_tolerance = 0.1;                   ///< [m]
};
/// The prior of a camera at height `height` [m], pitched down by `pitch` and rolled by `roll`, the
/// image's right side down [rad].
GroundPrior ground_prior(double height, double pitch, double roll, double height_tolerance,
                         double tilt_tolerance);
/// The prior of a camera at pose T_WC, where W's floor is z = 0 and z points up.
GroundPrior ground_prior(const Eigen::Isometry3d& T_WC, double height_tolerance,
                         double tilt_tolerance);

class Knobs;

struct GroundPlaneOptions {
  DepthRange range{0.3, 5.0};  ///< of the depths used [m]
  int stride = 4;              ///< every so manyeth pixel along rows and columns is used
  int score_stride = 8;        ///< likewise, to score hypotheses; rounded down to a multiple
  /// Noise of a depth z, one standard deviation: noise_constant + noise_quadratic z^2 [m; 1/m], and
  /// of the floor itself [m]. Between those of a structured-light camera and of a stereo one.
  double noise_constant = 0.0015;
  double noise_quadratic = 0.003;
  double unevenness = 0.008;
  double gate = 2.5;                 ///< [standard deviations]
  double confidence = 0.999;         ///< that some draw had all three points on the ground
  int most_draws = 20000;            ///< of three points
  int patch = 32;                    ///< [px]: the errors of pixels nearer than this are as one
  double min_share = 0.03;           ///< of the points that must lie on the plane
  double most_below = 0.25;          ///< points below the plane, of those on it
  double most_sigma_tilt = 0.035;    ///< [rad]
  double most_sigma_height = 0.035;  ///< [m]
  std::uint64_t seed = 1;
};

/// The knobs (models/knobs.h); the range comes from the robot.
void describe(Knobs& knobs, GroundPlaneOptions& options);

/// The directions in which a unit normal n tips: t1 = the x axis made perpendicular to n (the z
/// axis, where n is the x axis), t2 = n x t1.
void ground_tangents(const Eigen::Vector3d& n, Eigen::Vector3d& t1, Eigen::Vector3d& t2);
/// Between two directions, in [0, pi] [rad].
double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

struct GroundPlane {
  bool found = false;
  std::string reason;  ///< why it was not found
  /// n . p + h = 0 for points p of the ground, in C: n points up, h is the camera's height [m].
  Eigen::Vector3d normal = -Eigen::Vector3d::UnitY();
  double height = 0.0;
  /// Of (theta_1, theta_2, h): the normal tips by theta_1 towards t_1 and by theta_2 towards t_2
  /// [rad; m], both as ground_tangents() has them.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int points = 0;   ///< that were looked at
  int inliers = 0;  ///< of them on the plane
  int below = 0;    ///< of them below it
  double chi2_per_dof = 0.0;

  double pitch() const;         ///< of the camera, down [rad]
  double roll() const;          ///< of the camera, the image's right side down [rad]
  double sigma_tilt() const;    ///< largest standard deviation of the normal's direction [rad]
  double sigma_height() const;  ///< [m]
  /// Height of a point of C above the plane [m].
  double above(const Eigen::Vector3d& p) const { return normal.dot(p) + height; }
};

/// [m] of a depth z: see GroundPlaneOptions.
inline double depth_sigma(double z, const GroundPlaneOptions& options) {
  return options.noise_constant + options.noise_quadratic * z * z;
}
/// Standard deviation of above() for a point of the ground at depth z > 0, camera at height h [m]:
///   sigma^2 = unevenness^2 + ((h/z) (noise_constant + noise_quadratic z^2))^2,
/// since a depth error moves a point of the ground along its ray p, and n . p / z = -h/z.
double ground_sigma(double height, double z, const GroundPlaneOptions& options);

/// The ground in one depth image, by RANSAC (Fischler and Bolles 1981) within a prior: three points
/// make a plane; it is a hypothesis only if its tilt and height are the prior's within the
/// tolerances. So a wall, often the largest plane in view, is none. Of the hypotheses the best has
/// the largest
///   sum over points on it (1 - (e/(gate sigma))^2) - (points below it) / most_below,
/// e = n . p + h; on it: |e| < gate sigma, below: e <= -gate sigma. Nothing can be seen through the
/// ground, but for reflections on it: so a table is not it where the floor is seen beside it, nor
/// is a plane that cuts through things. Each new best is refined: Gauss-Newton on (theta_1,
/// theta_2, h) with Tukey's weights.
///
/// The covariance is that of errors which are alike within blocks of an eighth of the image's
/// width, whatever their size, by leaving out each block in turn (delete-a-group jackknife, Miller
/// 1974). It knows the noise of the image alone: an error that the whole image shares, as of the
/// depth scale, is not in it.
///
/// Not found, with the reason: no depth, no plane within the prior, too few points on the plane,
/// too many below it, or points that do not fix it: max(1, chi^2/dof) (J^T W J)^-1 times the number
/// of points in a patch is above the squares of the largest standard deviations.
///
/// Pure function; concurrent calls are safe. Never throws for an image, whatever it holds: one that
/// is not whole or not of the camera's size has no ground. Same input, same bits.
GroundPlane find_ground(const PinholeCamera& camera, const DepthImage& image,
                        const GroundPrior& prior, const GroundPlaneOptions& options = {});

/// Planes that a prior admits among the points below `above`, the highest first, at most three: as
/// find_ground(), of the points more than 5 cm and the gate below `above`, then of those below the
/// plane found. `above` need not be found. Empty if there is none.
std::vector<GroundPlane> find_planes_below(const PinholeCamera& camera, const DepthImage& image,
                                           const GroundPrior& prior, const GroundPlane& above,
                                           const GroundPlaneOptions& options = {});

}  // namespace prospect
