// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/maps/landmark_map.h"

namespace prospect {

/// Makes the count that landmarks predict for the present view the one that is tracked.
///
///   N_0 = sum_i mu_i pi_i0,   mu_i <- mu_i (1 + (c - 1) pi_i0 / tau_i),
///   c = 1 + (tracked - N_0) / sum_i mu_i pi_i0^2 / tau_i, between 1/4 and 4
///
/// Those in view now are counted as they are tracked, in proportion to how much they are in view;
/// what lies elsewhere stays as it is: that the tracker finds twice as many here (it holds more
/// than are mapped) or half of them (its image cells are full) says nothing of the next room. If c
/// is not bounded, N_0 is `tracked` afterwards exactly. Source: ours.
///
/// visible: pi_i0, one a landmark. Without a landmark in view nothing changes.
void calibrate_to_tracked(std::vector<Landmark>& landmarks, const Eigen::VectorXd& visible,
                          double tracked);

}  // namespace prospect
