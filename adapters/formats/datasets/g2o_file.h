// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

#include "perception/odometry/relative_pose.h"

namespace prospect {

/// A pose graph in the text format of g2o (Kuemmerle et al. 2011).
///
/// | line | numbers |
/// |---|---|
/// | `VERTEX_SE2 id` | x y yaw |
/// | `VERTEX_SE3:QUAT id` | x y z qx qy qz qw |
/// | `EDGE_SE2 from to` | x y yaw, and the upper triangle of the information, 6 |
/// | `EDGE_SE3:QUAT from to` | x y z qx qy qz qw, and the upper triangle, 21 |
/// | `FIX id` | checked, else neutral: a graph is fixed only up to a motion of all of it |
/// | `PARAMS_SE3OFFSET ...` | passed over, as no edge above refers to it |
/// | empty, or from # on | passed over |
///
/// Planar poses lie in z = 0. Planar measurements also say that z, roll and pitch do not change: z
/// as surely as x and y in the mean, roll and pitch as surely as yaw; nothing contradicts them, so
/// the poses are those of the planar graph. Without any vertex, the edges name them.
struct G2oGraph {
  struct Edge {
    int from = 0, to = 0;
    RelativePose measured;  ///< `to` in `from`
    std::string where;      ///< file:line
  };
  std::string path;
  std::map<int, Eigen::Isometry3d> vertices;  ///< that the file has
  std::vector<Edge> edges;
};

/// Throws InputError, a line a problem, up to 20: lines of other kinds, numbers that are missing,
/// too many or not finite, rotations and information matrices that are none
/// (is_information()), vertices twice, edges and FIX of vertices that are not there, edges from a
/// vertex to itself; and for a file without edges and vertices.
G2oGraph read_g2o(const std::string& path);

/// Which edges are odometry: g2o does not tell. A tree through all vertices: between neighbours in
/// the order of their numbers, where there is such an edge, else between those that lie nearest in
/// it; of several the first one. All other edges are loops.
struct G2oOrder {
  struct Step {
    int id = 0, from = 0;
    RelativePose measured;  ///< id in from
  };
  int first = 0;                   ///< the vertex with the lowest number
  std::vector<Step> odometry;      ///< each from one that came before
  std::vector<std::size_t> loops;  ///< numbers of edges
};
/// Throws InputError if not all vertices are connected, or there is none.
G2oOrder order_of(const G2oGraph& graph);

/// The vertices of the file; if it has none, each along the odometry from the first one, at the
/// origin. Throws InputError as order_of().
std::map<int, Eigen::Isometry3d> poses_of(const G2oGraph& graph);

}  // namespace prospect
