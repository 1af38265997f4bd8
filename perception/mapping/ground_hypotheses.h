// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "models/camera.h"
#include "perception/mapping/depth_image.h"
#include "perception/mapping/ground_plane.h"

namespace prospect {

struct GroundHypothesesOptions {
  /// Where the ground may be for any frame's camera: limits, not a distribution.
  GroundPrior prior = ground_prior(1.1, 0.35, 0.0, 0.9, 0.61);
  /// Height of the first frame's camera above the ground as it was stated [m], and its standard
  /// deviation [m]; none: not known.
  std::optional<double> height;
  double sigma_height = 0.05;
  GroundPlaneOptions ground;
  /// The camera's poses are known. Else planes live in C, and none is seen through another one.
  bool poses = true;
  int least_frames = 3;      ///< that must agree before a plane is taken
  double least_area = 0.25;  ///< that must have been seen of it [m^2]
  /// Planes that differ by no more are one: angle [rad], and height where they were seen [m].
  double tilt_tolerance = 0.06;
  double height_tolerance = 0.06;
  /// What one look at a plane is worth at best, beside the noise of its image: errors that the
  /// whole image shares. Over views the spread of the views says it instead.
  double view_sigma_tilt = 0.01;    ///< [rad]
  double view_sigma_height = 0.01;  ///< [m]
  /// Views from nearer than both are one view.
  double view_distance = 0.1;  ///< [m]
  double view_angle = 0.1;     ///< [rad]
};

/// A plane that may be the ground, as it stands after the newest frame.
struct GroundHypothesis {
  int number = 0;  ///< from 0, as they were first seen
  /// n . p + offset = 0 in D, n points up.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0.0;
  double height = 0.0;        ///< of the first frame's camera above it [m]
  double pitch = 0.0;         ///< of that camera, down [rad]
  double roll = 0.0;          ///< of that camera, the image's right side down [rad]
  double sigma_height = 0.0;  ///< standard deviation [m]
  double sigma_tilt = 0.0;    ///< largest standard deviation of the normal's direction [rad]
  /// Of (theta_1, theta_2, height), as GroundPlane's, of the first frame's camera.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int frames = 0;     ///< that have shown it
  int admitted = 0;   ///< of them, those whose camera was above it as the prior says
  double area = 0.0;  ///< that has been seen of it [m^2]
  bool taken = false;
  std::string why;  ///< why it is taken, or why not
};

/// What a frame did to the hypotheses.
struct GroundObservation {
  int seen = 0;  ///< hypotheses that it shows
  /// Another hypothesis is taken than before the frame.
  bool changed = false;
  /// It shows a plane below the one that is taken, which too few frames have shown yet to say what
  /// it is: what is mapped of the frame may have to be taken back. At most ten frames in a row of
  /// decisions; what is below for longer, and never the same, is no floor.
  bool doubtful = false;
  std::string reason;  ///< why it shows none; empty if it does
};

/// Which plane is the ground, over frames: none is believed from one view.
///
/// Views. Before one is taken: find_ground() with the prior, the planes below what it finds
/// (find_planes_below()), and a plane at the height stated. Afterwards: the one taken, within 0.1
/// rad and 0.12 m, and planes below it where at least min_share of the points lie there; and as
/// before one was taken, if the frame does not show it, or not as the prior says. A view is of the
/// hypothesis whose plane it is within the tolerances, or begins one. An image that is the one
/// before again is no view.
///
/// Estimate. The plane of a hypothesis is the weighted mean of its looks from different views, the
/// newest 64, with the height stated if there is one. The covariance of a view is that of its image
/// plus that between views, tau^2: one view_sigma squared, pooled with the spread of the views that
/// their images do not explain (a random-effects model, DerSimonian and Laird 1986). Without poses
/// all views are of one view, and view_sigma squared is added to their mean's.
///
/// Views of the same floor err alike: it is not flat there, and its depths are distorted. What all
/// share is as large as the noise of a point seen from there (ground_sigma()), alike over 0.25 m^2,
/// and so no number of looks makes it less, but only more of the floor: with the cells seen, of
/// area a at p, J = (t_1 . (p - o), t_2 . (p - o), 1), o the first frame's camera,
///   S = (sum over cells (a / 0.25 m^2) J J^T / sigma^2)^-1
/// is added to the covariance of the mean. A floor seen at an angle in one corner is so hardly
/// known in its tilt. An error of the depth scale is not in it.
///
/// Choice. A hypothesis can be taken if least_frames agree on it, least_area of it was seen, and
/// its height is the one stated within three standard deviations. Of those the one taken stays, or
/// else the one that most frames have shown, unless another beats it; that is then held against the
/// others. B beats A if
///   B is lower   most of what was seen of B lies below A, nothing of A below B: so the floor beats
///   a
///                table; unless B is seen through what was seen of A, a reflection or a depth in a
///                wrong unit: then the one that twice as many frames show beats the other;
///   neither is   and twice as many frames show B to a camera above it as the prior says: so the
///                floor beats a wall, and a ramp does not beat the floor before it.
///
/// Frames: D is the world of the poses, fixed; its axes may point anywhere.
/// Memory: eight hypotheses, of each 64 views and at most 1024 cells of 0.1 m; of images the last
/// one. Thread-safety: one thread at a time. Errors: the constructor throws std::invalid_argument
/// on a wrong camera; add() never throws; a frame whose image or pose is no good shows nothing.
/// Determinism: same frames, same bits.
class GroundHypotheses {
 public:
  explicit GroundHypotheses(const PinholeCamera& camera,
                            const GroundHypothesesOptions& options = {});

  GroundObservation add(const DepthImage& image, const Eigen::Isometry3d& T_DC);
  /// After the last frame: if none is taken, the best of those that too few frames have shown, if
  /// there is one. Whether one was.
  bool settle();

  const std::vector<GroundHypothesis>& all() const { return shown_; }  ///< by number
  const GroundHypothesis* taken() const;                               ///< null: none

 private:
  struct View {
    Eigen::Vector3d normal, eye;  // in D
    Eigen::Matrix3d orientation;  // of the camera in D
    double height = 0.0;
    Eigen::Matrix3d covariance;
  };
  struct Sighting {
    Eigen::Vector3d point, eye;
  };
  struct Plane {
    GroundHypothesis state;
    Eigen::Vector3d u, v;  // of the lattice of cells
    std::vector<View> views;
    std::unordered_map<std::uint64_t, Sighting> cells;
  };

  const Plane* plane_taken() const;  ///< null: none
  std::uint64_t cell_of(const Plane& plane, const Eigen::Vector3d& p) const;
  Plane* match(const View& view, const Eigen::Vector3d& middle);
  /// What a view finds, and of which hypothesis it is known to be; -1: of the one it matches.
  struct Found {
    GroundPlane plane;
    int number = -1;
  };

  template <typename Visit>
  void each_point(const DepthImage& image, Visit visit) const;
  bool admits(const Eigen::Vector3d& up, double height) const;
  std::vector<Found> view(const DepthImage& image, const Eigen::Isometry3d& T_DC,
                          std::string& reason) const;
  /// The number of its hypothesis; -1: it shows nothing, or one that is in `seen`.
  int enter(const Found& found, const std::vector<int>& seen, const DepthImage& image,
            const Eigen::Isometry3d& T_DC);
  void estimate(Plane& plane) const;
  Eigen::Matrix3d shared_covariance(const Plane& plane, const Eigen::Vector3d& t1,
                                    const Eigen::Vector3d& t2, const Eigen::Vector3d& origin) const;
  bool is_below(const Plane& b, const Plane& a, bool mostly) const;
  bool is_seen_through(const Plane& b, const Plane& a) const;
  bool beats(const Plane& b, const Plane& a) const;
  bool as_high_as_stated(const Plane& plane) const;
  std::string obstacle(const Plane& plane, int least_frames) const;
  bool choose(int least_frames);
  void show();

  PinholeCamera camera_;
  GroundHypothesesOptions options_;
  std::vector<Plane> planes_;
  std::vector<GroundHypothesis> shown_;
  int taken_ = -1;  // number
  int next_ = 0;
  int doubts_ = 0;  // doubtful frames since another one was taken
  bool any_ = false;
  Eigen::Isometry3d first_ = Eigen::Isometry3d::Identity();
  DepthImage last_image_;
};

}  // namespace prospect
