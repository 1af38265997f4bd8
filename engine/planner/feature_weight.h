// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "engine/planner/candidate.h"

namespace prospect {

/// A candidate as the weight of the visible features is chosen by it.
struct WeighedCandidate {
  double others = 0.0;    ///< cost of all terms but the visible features, weighted
  double features = 0.0;  ///< T of the visible features, not weighted, >= 0
};

/// The largest weight w in [0, most] of the visible features with which going on is better than
/// waiting.
///
/// Let b be the cost of standing, G = b - min_i others_i what can be gained, and let those go on
/// that gain at least half of it, G_i = b - others_i >= G / 2; the rest wait. The weight is the
/// largest for which
///
///     min_{i goes on} others_i + w features_i  <=  min_{j waits} others_j + w features_j - G / 10
///
/// With w = 0 this holds with G / 2 to spare, and it holds up to a largest w for each i that goes
/// on: w_i = min over j with features_j < features_i of (others_j - others_i - G / 10) /
/// (features_i - features_j). So the features choose among the ways that gain at least half of
/// what can be gained, and bend them, but cannot make a robot stand that has a path on. Where
/// nothing can be gained (G <= 0, or no candidates) it is `most`.
///
/// standing: b. Continuous in all costs but where the set of those that go on changes. Pure.
/// Thread-safe. Source: our choice.
double feature_weight(const std::vector<WeighedCandidate>& candidates, double standing,
                      double most);

/// The same of the scored candidates of a problem in which the visible features have the weight
/// `most`: of the feasible ones; standing is the one that stops. `most` without such a one.
double feature_weight(const std::vector<Candidate>& candidates, double most);

}  // namespace prospect
