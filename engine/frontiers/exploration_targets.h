// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "engine/maps/belief.h"
#include "engine/maps/grid.h"
#include "models/camera.h"
#include "models/robot_description.h"

namespace prospect {

/// A cluster of unknown ground cells worth looking at.
struct ExplorationTarget {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< a cell of the cluster, in W [m]
  double mass = 0.0;                                   ///< m_c: area of its cells [m^2]
};

struct ExplorationTargets {
  std::vector<ExplorationTarget> targets;
  double reference_area = 0.3;  ///< A_ref [m^2]
  int visible_now = 0;          ///< clusters left out because they are in view and still unknown

  /// Where a sensor that is mounted so much higher [m] looks for them.
  std::vector<Eigen::Vector3d> positions(double raised = 0.0) const;
};

struct ExplorationTargetOptions {
  double band = 1.2;      ///< unknown cells this near an active frontier count [m]
  double block = 0.4;     ///< side of a cluster [m], rounded to whole cells
  int max_targets = 200;  ///< the nearest are kept: to the robot, or to what it is led to
  /// What it is led to, in W [m]; none: nothing. Among walls two hundred clusters lie within a few
  /// metres, and a robot must gain by a look at what it has come for.
  std::optional<Eigen::Vector2d> led_to{};
  double reach = 10.0;       ///< targets farther than this from the robot are left out [m]
  bool drop_visible = true;  ///< leave out targets that the present pose sees and that stay unknown
  double attenuation = 0.5;  ///< lambda of the present view through unknown space [1/m]
  double visible_above = 0.5;  ///< a target counts as in view if its q exceeds this
  double near = 5.0;           ///< radius of the mass that sets A_ref [m]
  double reference_min = 0.3;  ///< bounds of A_ref [m^2]
  double reference_max = 4.0;
};

/// Targets of the exploration gain: the unknown cells of G(n) within `band` of a cell of an active
/// frontier, clustered in world-aligned blocks.
///
///   m_c   = (number of such cells in the block) r^2
///   A_ref = clamp(half the mass of the targets within `near` of the robot, reference_min,
///   reference_max)
///
/// A target stands on the cell of its cluster nearest to the cluster's centroid (a mean could fall
/// into a wall), at the height of the first depth sensor in the present pose. Clusters that one of
/// the sensors should see now, by its footprint (FootprintVisibility) and a hard ray cast at its
/// own height, and that are unknown all the same, are left out: looking again will not resolve
/// them. They do not count in A_ref.
///
/// Deterministic: the result does not depend on the order of `frontier_cells`; targets are ordered
/// by block address. Frontier cells outside the map are ignored. No active frontier: no target. At
/// least one sensor. Source: formulation, section 4; the choice of the cell and of the height is
/// ours.
ExplorationTargets exploration_targets(const Belief& belief,
                                       const std::vector<Cell>& frontier_cells,
                                       const std::vector<DepthSensor>& sensors,
                                       const ExplorationTargetOptions& options = {});

}  // namespace prospect
