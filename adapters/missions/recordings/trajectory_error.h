// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/formats/datasets/trajectory.h"
#include "perception/fusion/scale_agreement.h"

namespace prospect {

/// An estimated and a true pose of one instant.
struct PosePair {
  double stamp = 0.0;
  Eigen::Isometry3d estimate = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();
};

/// Every estimated pose with the true one at its time, interpolated (linearly, and along the
/// geodesic) between neighbours that are at most max_gap [s] apart. Poses outside are left out.
std::vector<PosePair> associate(const Trajectory& estimate, const Trajectory& truth,
                                double max_gap = 0.25);

/// Length of the true path [m].
double path_length(const std::vector<PosePair>& pairs);

enum class Alignment {
  kFirstPose,  ///< the first estimated pose is the first true one: what a robot has
  kBestFit     ///< the rigid motion with the least squared distances (Umeyama 1991, no scale)
};

/// Absolute trajectory error: distances of positions after the alignment [m].
struct AbsoluteError {
  double rmse = 0.0, median = 0.0, max = 0.0;
};
AbsoluteError absolute_error(const std::vector<PosePair>& pairs, Alignment alignment);

/// Error of the last pose with the first poses aligned. NaN where there is none: of fewer than two
/// pairs all of it, of a true path without length its share.
struct EndError {
  double translation = 0.0;  ///< [m]
  double share = 0.0;        ///< of the true path's length
  double rotation = 0.0;     ///< [rad]
};
EndError end_error(const std::vector<PosePair>& pairs);

/// All of them; NaN without two poses to measure them from.
struct TrajectoryErrors {
  AbsoluteError ate_first, ate_fit;
  EndError end;
};
TrajectoryErrors trajectory_errors(const std::vector<PosePair>& pairs);

/// Relative pose error over segments of `length` [m] of the true path, one from every frame: the
/// error of the motion from i to the first j that is at least `length` along, E = (T_i^-1 T_j)^-1
/// (S_i^-1 S_j) with T true and S estimated (Kuemmerle et al. 2009; KITTI). Means over the
/// segments.
struct RelativeError {
  int segments = 0;
  double translation = 0.0;  ///< |t_E| over the true length of the segment
  double rotation = 0.0;     ///< angle of E over it [rad/m]
};
RelativeError relative_error(const std::vector<PosePair>& pairs, double length);

/// Whether the true poses' quaternions were read in the wrong order: over the motion from the first
/// pair to each that by its estimate has turned by 2 deg or more, the angle between the estimated
/// turn and the true one, in the median, as read and with w first. In words, if the second is below
/// half the first and below a quarter of the turns, and the first above; empty if not, or if fewer
/// than three have turned.
std::string quaternion_order_problem(const std::vector<PosePair>& pairs,
                                     const std::vector<PosePair>& w_first);

/// Whether estimate and truth agree about the metre (scale_agreement.h): over consecutive segments
/// of a twentieth of the true path each, but at least 0.1 m, the ratio of the straight lines
/// between their ends. A median, so poses that are off for a while do not matter.
ScaleAgreement scale_of(const std::vector<PosePair>& pairs);

}  // namespace prospect
