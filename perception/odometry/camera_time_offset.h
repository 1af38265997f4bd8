// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/camera.h"
#include "perception/odometry/track.h"

namespace prospect {

class Knobs;

struct CameraTimeOffsetOptions {
  double prior_sigma = 0.2;  ///< [s] before anything was seen; 0: the offset is not estimated
  double prior_rows = 0.5;   ///< [px] of each of the errors of the rows
  /// Evidence is worth this share of what it says at most: a landmark's errors are alike from frame
  /// to frame.
  double trust = 0.1;
  double memory = 300.0;    ///< [frames] that evidence is kept for
  double max_error = 0.01;  ///< share of the depth that the offset may cost; more: out of step
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, CameraTimeOffsetOptions& options);

/// By how much later than the left image the right one was taken, tau [s], or that it is not known.
///
/// A rectified pair shows a point in one row, whatever its disparity. A late image shows it in the
/// row where the left camera sees it later, and the left images around tell which that is: with
/// v(t) the row of a landmark in the left image,
///   v_r - v_l = v(t_k + tau) - v(t_k) + c phi(x, y) + noise,   phi = (1, x, y, x y, y^2),
/// x, y = (u - cx, v - cy) / (width / 2). c is what is wrong with the rectification: the right
/// camera's turn about each axis (pitch 1 + y^2, yaw x y, roll x), focal lengths and rows of the
/// centres. A yaw is an error of the disparities' zero as well (disparity_offset.h): at a constant
/// turn rate it cannot be told from a time, and what is not told apart is not known.
///
/// v(t_m) - v(t_k) of the landmarks that both frames show is fitted by (z, phi), z what the poses
/// say of it: as measured its noise would draw tau to the middle of two frames, and by the poses
/// alone tau would be what the depths allow, which are wrong if the images are late. Rows are so
/// compared with those two frames before to two after, straight between them, by their times and by
/// their numbers (pairs that were shifted); every piece has a least-squares estimate of (tau, c) of
/// its own, with Huber's loss, and of those that lie within their piece the one that fits best is
/// taken. Frames that hardly move, and those of whose landmarks the right image shows fewer than
/// half, which are then a choice of those that agree, do not count.
///
/// Errors of the points of a frame, and of successive frames, are alike: the deviation is that of a
/// jackknife over at most 16 blocks of frames, which lengthen as there are more, widened by
/// Student's t for their number, and no less than trust allows. tau is not known while it exceeds
/// half the prior's, with fewer than four blocks, while a piece that says otherwise fits as well as
/// far as blocks can tell (three deviations of their differences), or if most frames that move do
/// not count.
///
/// Deterministic. Not thread-safe. Costs 0.2 ms a frame.
class CameraTimeOffset {
 public:
  explicit CameraTimeOffset(const CameraTimeOffsetOptions& options = {});

  /// A frame of time `stamp` [s] that was located at T_CW by these tracks, those that are inliers;
  /// velocity as in trusted_pose.h, per second.
  void update(const StereoCamera& camera, const std::vector<Track>& tracks,
              const Eigen::Isometry3d& T_CW, const Eigen::Matrix<double, 6, 1>& velocity,
              double stamp);
  /// A frame was not located.
  void interrupt() { views_.clear(); }

  bool estimated() const { return options_.prior_sigma > 0.0; }
  bool known() const { return known_; }
  double value() const { return value_; }  ///< tau [s]; > 0: the right image is late; else 0
  double sigma() const { return sigma_; }  ///< its standard deviation [s]; the prior's
  /// What it costs: |tau| times the median flow along the rows, over the median disparity; of the
  /// frames that are remembered the mean. Share of the depth.
  double depth_error() const;
  /// Standard deviation of what it costs, as far as it is known: sqrt(tau^2 + sigma^2) in place of
  /// |tau|. Share of the depth, zero while the camera has not moved.
  double depth_sigma() const;
  /// Whether it is known to cost more than max_error: four standard deviations from zero.
  bool out_of_step() const;
  /// "the right camera is 20 ms late"; where that is a whole number of `period`s [s] (0: not
  /// known), that the pairs are shifted by so many frames.
  std::string reason(double period) const;

 private:
  static constexpr int kReach = 2;                                 // frames before and after
  static constexpr std::size_t kPieces = std::size_t{4} * kReach;  // by times, then by numbers
  static constexpr std::size_t kSize = 6;                          // of (tau [s], c [px])
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  struct Row {
    std::uint64_t id;             // of the landmark
    Eigen::Vector3d position;     // in W
    Eigen::Vector2d at;           // (x, y) of phi
    double row;                   // v_l [px]
    std::optional<double> error;  // v_r - v_l [px]; none: the right image does not show it
  };
  struct View {
    double stamp;
    Eigen::Isometry3d T_CW;
    std::vector<Row> rows;  // by id
  };
  /// Weighted sums of a piece: of squares, as a function of its state.
  struct Sums {
    Matrix A = Matrix::Zero();
    Vector b = Vector::Zero();
    double squares = 0.0;

    void add(const Vector& row, double value, double weight);
    Sums& operator+=(const Sums& other);
    double cost(const Vector& state) const;
  };
  struct Block {
    std::array<Sums, kPieces> of;
    int frames = 0, blind = 0;  // that count, and that move but do not
  };
  using Rows = std::vector<std::pair<Vector, double>>;

  double middle(std::size_t piece) const;  // [s] where it begins
  Sums prior() const;
  std::array<Sums, kPieces> total() const;
  /// Enters the view in the middle of those that are there.
  void enter(const StereoCamera& camera);
  /// By how much each landmark of the middle view is lower in that view [px], as fitted; empty:
  /// they have too few in common.
  std::vector<double> shift_to(const View& other, const StereoCamera& camera) const;
  /// The row errors of the middle view as linear functions of the state, of each piece; none: it
  /// hardly moves. Empty: it does not count.
  std::optional<std::array<Rows, kPieces>> linearise(const StereoCamera& camera) const;
  Block& open_block();
  void estimate();

  CameraTimeOffsetOptions options_;
  std::deque<View> views_;
  double period_ = 0.0;  // [s] of the pieces; 0: not known yet
  std::deque<Block> blocks_;
  int length_ = 1;  // of a block [frames]
  bool known_ = false;
  double value_ = 0.0, sigma_ = 0.0;
  double flow_ = 0.0, frames_ = 0.0;  // sum of flow over disparity [1/s], and of frames
};

}  // namespace prospect
