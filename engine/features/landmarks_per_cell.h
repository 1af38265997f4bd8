// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/maps/landmark_map.h"

namespace prospect {

/// Notes how crowded the landmarks of a map are for a tracker that keeps one in each image cell.
///
///   c_i = a^2 rho_i,   rho_i = [ sum_{j != i} mu_j tau_j + (mu_i - 1) tau_i ] / (pi h^2)
///
/// over the landmarks j within h = 0.5 m of i that were made from the same side (n_j . n_i > 0):
/// the number of others on a square metre of its surface. From a depth Z an image cell, of side a
/// over the focal length, shows (a Z)^2 of a surface that faces the camera, and so m_i = c_i Z^2
/// others. A robot remembers the landmarks of all the views it has had of a wall, near and far; the
/// tracker keeps one a cell of the view that it has. Without this, three times as many were
/// predicted as tracked where textures are rich (docs/results/visible_features.md).
///
/// a is LandmarkMap::image_cell; without such cells (0, or not finite) nothing is crowded. Sets
/// Landmark::per_cell of every landmark. What is not finite counts for nothing, and has 0.
/// Deterministic; independent of the order of the landmarks but for rounding. Cost: n log n, and n
/// times the number of landmarks within h along one axis. Source: ours.
void note_landmarks_per_cell(LandmarkMap& map);

}  // namespace prospect
