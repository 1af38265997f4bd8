// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/support/resumable.h"

namespace prospect {

class Knobs;

struct FrontierOrderOptions {
  double patience = 20.0;   ///< [s] in which what is still to be seen loses a factor of e
  int candidates = 7;       ///< frontiers that are put in order
  int sequence_length = 5;  ///< of them that a sequence holds at most
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, FrontierOrderOptions& options);

/// A frontier that could be next.
struct FrontierCandidate {
  int frontier = -1;  ///< index of the frontier
  double area = 0.0;  ///< E: area that an observation of it is expected to show [m^2]
  double cost = 0.0;  ///< [s] from the robot until it has observed, with the price of few features
  double time = 0.0;  ///< [s] the same without that price
  double path = 0.0;  ///< [m of path equivalent] to where it observes, with the price
  double length = 0.0;  ///< of the frontier [m]
};

/// A sequence of candidates and its value, the area that it is expected to show, sooner rather than
/// later,
///
///     J(s) = sum_n E_{s_n} exp(-T_n / patience),
///     T_n  = cost of s_1 + sum_{m=2..n} d_{s_{m-1} s_m},
///
/// T_n [s] when it will have observed the n-th, d from having observed one until it has another:
/// what is near, or lies on the path, comes first, but a room comes before the slivers around it,
/// as each observation takes its time.
struct FrontierSequence {
  std::vector<int> order;  ///< indices of candidates
  double value = 0.0;      ///< J [m^2]
};

/// The greatest rate of a beginning of the sequence [m^2/s],
///
///     max_n sum_{m <= n} E_{s_m} / (time of s_1 + sum_{m=2..n} d_{s_{m-1} s_m})
///
/// 0 for an empty one.
double rate(const FrontierSequence& sequence, const std::vector<FrontierCandidate>& candidates,
            const Eigen::MatrixXd& between);

/// The candidates worth putting in order: those with the greatest E exp(-cost / patience),
/// `options.candidates` at most, greatest first; of equal ones the first.
std::vector<FrontierCandidate> leading_candidates(std::vector<FrontierCandidate> candidates,
                                                  const FrontierOrderOptions& options,
                                                  const PausePoint& pause = {});

/// The sequence of at most options.sequence_length candidates with the greatest J, by trying all;
/// `first`: index of the candidate that it must begin with, -1 for any. between(a, b): d_ab [s], n
/// x n, infinite where there is no path. Empty without candidates. Deterministic: of equal ones the
/// first in the order of the candidates. Source: measured against tours and greedy rules
/// (docs/results/frontiers.md).
FrontierSequence best_sequence(const std::vector<FrontierCandidate>& candidates,
                               const Eigen::MatrixXd& between, const FrontierOrderOptions& options,
                               int first = -1);

}  // namespace prospect
