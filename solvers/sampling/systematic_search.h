// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "engine/problem/problem.h"

namespace prospect {

/// Candidates of the systematic search over simple motions: knot inputs that are constant (u) or
/// change once (u, then u' from knot s on; s near M/2, M/4, 3M/4), with u and u' on a grid of the
/// input box. The level nearest to zero is moved to zero where the bounds contain it, so that
/// stopping is among them. The grids are the finest that keep the number of candidates within
/// `most`: constants take a quarter of it (all of it if M = 1). Where even two levels an input are
/// too many constants (nu large), an additive-recurrence sequence of `most` points fills the box
/// instead.
///
/// Returns n x B, B <= most, constants first. The points keep the bounds; rate limits are up to the
/// caller. Deterministic.
///
/// Source: the paper's search over constant and piecewise constant inputs; the layout of the grids
/// is our choice. Sequence: Roberts (2018), generalised golden ratio.
Eigen::MatrixXd systematic_candidates(const Problem& problem, int most);

}  // namespace prospect
