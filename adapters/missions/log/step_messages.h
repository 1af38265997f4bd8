// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "adapters/formats/ros/diagnostic_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/ros/visualization_msgs.h"
#include "adapters/missions/run/run_record.h"
#include "adapters/views/page/landmark_picture.h"

namespace prospect {

// A planning step as messages of ROS 2, and back. Poses and points are in the frame kMapFrame.
// docs/reference/log.md describes them.

inline constexpr const char* kMapFrame = "map";

/// [ns] of the log's clock as a stamp.
ros::Time stamp_at(std::int64_t ns);

/// The numbers and words of a step: `status` holds one for the step, then one for each candidate.
/// Numbers are the shortest text that reads back exactly; what the step lacks has no entry.
ros::DiagnosticArray step_values(const StepRecord& step, std::int64_t ns);
/// Enters what it holds; entries of other names are passed over. Throws InputError, one line, on a
/// value that is no number where one is expected; `name` stands for the message.
void read_step_values(const ros::DiagnosticArray& values, const std::string& name,
                      StepRecord& step);

/// The predicted poses, at the times `dt` [s] apart.
ros::Path horizon_path(const StepRecord& step, double dt, std::int64_t ns);
void read_horizon_path(const ros::Path& path, StepRecord& step);

/// Target (arrow from the viewpoint to what it looks at), active frontier cells, landmarks (from
/// red, not visible, to green) and the ways of the candidates, the one executed last.
ros::MarkerArray step_markers(const StepRecord& step, double resolution, std::int64_t ns);
/// Frontier cells, landmarks, and the ways of the candidates that read_step_values() has entered.
void read_step_markers(const ros::MarkerArray& markers, StepRecord& step);

/// How the frontiers stood when it was asked which is next: of each a text at its centroid, in the
/// namespace of its FrontierStanding::Why, with its place among all as id, and {E [m^2], A [m^2],
/// time [s]} as its one point.
ros::MarkerArray frontier_markers(const StepRecord& step, std::int64_t ns);
void read_frontier_markers(const ros::MarkerArray& markers, StepRecord& step);

/// A picture of the cost-to-go: the centres of cells that are known [m], and their seconds, as
/// fields x, y, z and seconds of float32. `bytes` holds them and outlives the message.
ros::PointCloud2 cost_to_go_points(const CostToGoPicture& picture, std::int64_t ns,
                                   std::string& bytes);
/// The picture with cells of side `resolution` [m].
CostToGoPicture read_cost_to_go_points(const ros::PointCloud2& points, double resolution);

/// The features of a picture: fields u, v [px of the picture] and kind of float32.
ros::PointCloud2 picture_features(const LandmarkPicture& picture, std::int64_t ns,
                                  std::string& bytes);
std::vector<LandmarkPicture::Feature> read_picture_features(const ros::PointCloud2& features);

}  // namespace prospect
