// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace prospect {

/// The corners of a polygon in turn, either way round.
using Ring = std::vector<Eigen::Vector2d>;

/// Triangles of a polygon with holes, which run to the left: of each the numbers of three corners,
/// counted through `outer` and then through the holes in their order. Each hole is joined to what
/// is about it by a cut, then ears are cut off. A hole that does not lie inside counts as none;
/// what is left of a polygon that crosses itself stays open.
std::vector<std::array<std::uint32_t, 3>> polygon_triangles(const Ring& outer,
                                                            const std::vector<Ring>& holes = {});

/// Twice the area that a ring runs round, negative to the right [m^2].
double doubled_area(const Ring& ring);

/// Whether a point lies in a ring (even-odd).
bool is_within(const Eigen::Vector2d& point, const Ring& ring);

}  // namespace prospect
