// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "adapters/formats/worlds/left_out.h"
#include "adapters/formats/worlds/load_progress.h"

namespace prospect {

/// Points on surfaces, in the coordinates of their file [m]. A value.
struct PointCloud {
  std::vector<Eigen::Vector3d> points;  ///< finite
  LeftOut left_out = {};                ///< what the file holds besides
};

/// Whether read_point_cloud() reads a file: a .pcd, or a .ply whose header states no faces. Of a
/// .ply that cannot be read, no.
bool is_point_cloud_file(const std::string& path);

/// The points of a
/// * PCD, versions 0.5 to 0.7: ascii, binary or binary_compressed. Its numbers are little-endian.
/// * PLY: ascii, binary_little_endian or binary_big_endian.
///
/// Of their fields, in any order, x, y and z are used, of any type that the format has. Points that
/// are not finite (pixels of a depth camera without a depth) are left out and counted. So is all
/// else that a file holds: colours, normals, intensities, whatever they are named; further elements
/// of a PLY; and a PCD's VIEWPOINT, from which its points are not measured.
///
/// Throws InputError, one line: the file is missing, empty, larger than 512 MB, of another kind,
/// not whole, says what it does not hold, or has no finite point.
PointCloud read_point_cloud(const std::string& path, const LoadProgress& progress = {});

/// The same of a file's bytes; `source` stands for its path, and its extension says which kind it
/// is.
PointCloud parse_point_cloud(const std::string& bytes, const std::string& source);

}  // namespace prospect
