// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/support/resumable.h"

namespace prospect {

class Knobs;

struct FrontierOrderOptions {
  double horizon = 20.0;  ///< [m] of way in which what is still to be seen loses a factor of e
  double every_observation =
      0.3;                  ///< [m^2] that a frontier which is trusted counts besides its area
  int candidates = 7;       ///< frontiers that are put in order
  int sequence_length = 5;  ///< of them that a sequence holds at most
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, FrontierOrderOptions& options);

/// A frontier that could be next.
struct FrontierCandidate {
  int frontier = -1;        ///< index of the frontier
  double area = 0.0;        ///< E: area that a look at it is expected to show [m^2]
  double path = 0.0;        ///< [m of path equivalent] from the robot until it has looked
  double time = 0.0;        ///< [s] that it takes until then
  double confidence = 1.0;  ///< share of what it promises that it is still believed to show
  double length = 0.0;      ///< of the frontier [m]
};

/// A sequence of candidates and its value,
///
///     J(s) = sum_n (every_observation tau_{s_n} + E_{s_n}) exp(-W_n / horizon),
///     W_n  = w_{s_1} + sum_{m=2..n} d_{s_{m-1} s_m},
///
/// tau the confidence in a candidate, w the path to it, d the path between two: what is near, or
/// lies on the path, comes first, but a room comes before the slivers around it.
struct FrontierSequence {
  std::vector<int> order;  ///< indices of candidates
  double value = 0.0;      ///< J [m^2]
};

/// The greatest rate of a beginning of the sequence [m^2/s],
///
///     max_n sum_{m <= n} E_{s_m} / (time of s_1 + sum_{m=2..n} (d_{s_{m-1} s_m} / v_max +
///                                   observation_time))
///
/// 0 for an empty one.
double rate(const FrontierSequence& sequence, const std::vector<FrontierCandidate>& candidates,
            const Eigen::MatrixXd& between, double v_max, double observation_time);

/// The candidates worth putting in order: those with the greatest (every_observation tau + E)
/// exp(-w / horizon), `options.candidates` at most, greatest first; of equal ones the first.
std::vector<FrontierCandidate> leading_candidates(std::vector<FrontierCandidate> candidates,
                                                  const FrontierOrderOptions& options,
                                                  const PausePoint& pause = {});

/// The sequence of at most options.sequence_length candidates with the greatest J, by trying all;
/// `first`: index of the candidate that it must begin with, -1 for any. between(a, b): d_ab [m of
/// path equivalent], n x n, infinite where there is no path. Empty without candidates.
/// Deterministic: of equal ones the first in the order of the candidates. Source: measured against
/// tours and greedy rules (docs/results/frontiers.md).
FrontierSequence best_sequence(const std::vector<FrontierCandidate>& candidates,
                               const Eigen::MatrixXd& between, const FrontierOrderOptions& options,
                               int first = -1);

}  // namespace prospect
