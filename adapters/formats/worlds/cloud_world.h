// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "adapters/formats/worlds/load_progress.h"
#include "adapters/formats/worlds/point_cloud_file.h"
#include "adapters/formats/worlds/up_axis.h"
#include "adapters/formats/worlds/world.h"

namespace prospect {

struct CloudWorldOptions {
  /// [m] of the voxels; 0: the finest of 0.05, 0.1, 0.2 and 0.5 m in which the floor is closed
  /// (eight in ten of its columns' neighbours hold points), else 0.1 m.
  double resolution = 0.0;
  double height = 2.5;             ///< [m] above the floor that is kept
  UpAxis up = UpAxis::kZ;          ///< axis of the file's coordinates
  std::optional<double> ground{};  ///< [m] height in the cloud's frame that is meant
  bool unknown_is_free = false;    ///< over no floor, too
  std::size_t max_voxels = 400'000'000;
  LoadProgress progress{};
};

/// The world of points that were measured on surfaces. A cloud does not say where it is free: what
/// stands over a floor and holds no point is (our choice).
///
/// Stray points: what lies more than 100 km from the middle of all (the median along each axis) is
/// left out and told. Of blocks of a metre that touch, those of the part with the most points
/// count; the rest is left out and told if that halves the box.
///
/// Floor: a point can be stood on if its column (a square of `resolution`) has none within a metre
/// above it (between the faces of a floor slab there is less), and points in less than half of the
/// metre below it: so the top of a wall is none. By heights in steps of 5 cm, the floor is the
/// lowest step with at least half as many such columns as the fullest, or the one nearest to
/// options.ground, at most half a metre off, with at least a twentieth; its height is the median of
/// its points, and what lies up to four times their deviation (2 to 10 cm) above it is floor. There
/// is no floor where such columns are less than a quarter of those that hold points or are enclosed
/// by ones that do: then z = 0 is the lowest height with a quarter of the fullest height's points,
/// the floor is what the points enclose, or the box if they enclose nothing, and it is told. The
/// cloud is moved so that the floor is z = 0.
///
/// Voxels: occupied, if a point lies in them; free, if they are not and stand over the floor. Gaps
/// of the floor of at most 1 m^2, in which no point stands, are floor. All else is unknown.
///
/// Beyond 10 km from the origin (UTM), positions count from the lower corner, which is told. start
/// is left at the origin. Throws InputError if there are too few points, no ground at the height
/// that is asked for, or more than max_voxels.
World world_from_cloud(PointCloud cloud, const std::string& name,
                       const CloudWorldOptions& options = {});

}  // namespace prospect
