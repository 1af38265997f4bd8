// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_publisher.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/ros/diagnostic_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/octomap_msgs.h"
#include "adapters/formats/ros/pose_message.h"
#include "adapters/formats/ros/tf2_msgs.h"
#include "adapters/formats/ros/visualization_msgs.h"
#include "engine/maps/correction.h"
#include "engine/planner/planner.h"
#include "runtime/driver.h"

namespace prospect {
namespace {

constexpr std::size_t kMostLandmarks = 2000;  // in a message of markers

ros::Point point(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }
Eigen::Isometry3d isometry_of(const Pose& pose) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = pose.position;
  return T;
}

ros::TransformStamped transform(const ros::Header& header, const std::string& child,
                                const Eigen::Isometry3d& T) {
  const Eigen::Quaterniond q(T.linear());
  const Eigen::Vector3d& t = T.translation();
  return {header, child, {{t.x(), t.y(), t.z()}, {q.x(), q.y(), q.z(), q.w()}}};
}

/// What is in W, in the map's frame as it is now.
Pose in_map(const Pose& pose, const Belief& belief) {
  return belief.map_frame ? belief.map_frame->to_map(pose) : pose;
}

bool is_turned(const Belief& belief) {
  const Pose origin = origin_of(belief.map_frame.get());
  return !origin.position.isZero(0.0) || origin.yaw != 0.0;
}

/// The lower left corner of the cells may lie anywhere in the map, turned.
ros::OccupancyGrid grid_message(const ros::Header& header, const Belief& belief,
                                std::vector<std::int8_t>& cells) {
  const GroundMap& ground = *belief.ground;
  const GridFrame& frame = ground.frame();
  ros::OccupancyGrid m;
  m.header = header;
  m.info.map_load_time = header.stamp;
  m.info.resolution = static_cast<float>(frame.resolution);
  m.info.width = static_cast<std::uint32_t>(frame.width);
  m.info.height = static_cast<std::uint32_t>(frame.height);
  const Pose corner =
      in_map({{frame.i0 * frame.resolution, frame.j0 * frame.resolution, 0.0}, 0.0}, belief);
  m.info.origin = ros::pose_message(corner);
  cells.resize(static_cast<std::size_t>(frame.size()));
  for (int n = 0; n < frame.size(); ++n) {
    const CellState state = ground.state(frame.at(n));
    cells[static_cast<std::size_t>(n)] = state == CellState::kFree       ? std::int8_t{0}
                                         : state == CellState::kOccupied ? std::int8_t{100}
                                                                         : std::int8_t{-1};
  }
  m.data = cells;
  return m;
}

ros::Octomap octomap_message(const ros::Header& header, const octomap::OcTree& tree,
                             std::string& bytes) {
  std::ostringstream out;
  tree.writeBinaryData(out);
  bytes = out.str();
  ros::Octomap m;
  m.header = header;
  m.binary = true;
  m.id = tree.getTreeType();
  m.resolution = tree.getResolution();
  m.data = {reinterpret_cast<const std::int8_t*>(bytes.data()), bytes.size()};
  return m;
}

ros::Marker marker(const ros::Header& header, const char* name, std::int32_t type,
                   const ros::ColorRGBA& color) {
  ros::Marker m;
  m.header = header;
  m.ns = name;
  m.type = type;
  m.color = color;
  return m;
}

}  // namespace

struct DdsPublisher::Impl {
  Impl(const DdsOptions& given, DdsNode& its_node, const DdsBase& its_base, const Clock& its_clock,
       std::shared_ptr<const MotionModel> its_model, const DriveRequests& its_requests)
      : options(given),
        node(its_node),
        base(its_base),
        clock(its_clock),
        model(std::move(its_model)),
        requests(its_requests) {
    const DdsOptions::Output& o = options.output;
    if (!o.path.empty()) path = node.advertise<ros::Path>(o.path, kReliableQos);
    if (!o.map.empty()) map = node.advertise<ros::OccupancyGrid>(o.map, kLatchedQos);
    if (!o.octomap.empty()) octree = node.advertise<ros::Octomap>(o.octomap, kLatchedQos);
    if (!o.markers.empty()) markers = node.advertise<ros::MarkerArray>(o.markers, kReliableQos);
    if (!o.diagnostics.empty()) {
      diagnostics = node.advertise<ros::DiagnosticArray>(o.diagnostics, kReliableQos);
    }
    if (!o.state.empty()) state = node.advertise<ros::DiagnosticStatus>(o.state, kLatchedQos);
    if (o.transforms || o.odom_transform) {
      transforms = node.advertise<ros::TFMessage>(options.tf, kTransformQos);
    }
  }

  ros::Header header_of(const Belief& belief) const {
    return {base.ros_time(belief.stamp), options.frames.map};
  }

  void publish_transforms(const ros::Header& header, const Belief& belief) {
    const auto T_odom_base = base.odometry(belief.stamp);
    if (transforms < 0 || !T_odom_base) return;
    ros::TFMessage m;
    if (options.output.transforms) {
      m.transforms.push_back(
          transform(header, options.frames.odom,
                    isometry_of(in_map(belief.pose, belief)) * T_odom_base->inverse()));
    }
    if (options.output.odom_transform) {
      m.transforms.push_back(
          transform({header.stamp, options.frames.odom}, options.frames.base, *T_odom_base));
    }
    node.publish(transforms, m);
  }

  void publish_path(const Plan& plan, const std::vector<Pose>& poses) {
    if (path < 0) return;
    ros::Path m;
    m.header = {base.ros_time(plan.stamp), options.frames.map};
    for (std::size_t k = 0; k < poses.size(); ++k) {
      const double time = plan.stamp + static_cast<double>(k) * plan.dt;
      m.poses.push_back({{base.ros_time(time), options.frames.map}, ros::pose_message(poses[k])});
    }
    node.publish(path, m);
  }

  void publish_markers(const ros::Header& header, const MissionStep& step,
                       const std::vector<Pose>& poses) {
    if (markers < 0) return;
    ros::MarkerArray all;
    ros::Marker target = marker(header, "target", ros::Marker::kArrow, {1.0F, 0.55F, 0.0F, 1.0F});
    target.scale = {0.5, 0.1, 0.1};
    if (step.global_plan != nullptr && step.global_plan->target) {
      const FrontierTarget& to = *step.global_plan->target;
      target.pose = ros::pose_message(
          in_map({{to.viewpoint.x(), to.viewpoint.y(), 0.1}, to.yaw}, *step.belief));
    } else if (step.plan->goal) {
      const Goal& goal = *step.plan->goal;
      target.pose = ros::pose_message(in_map(
          {{goal.position.x(), goal.position.y(), 0.1}, goal.yaw.value_or(0.0)}, *step.belief));
    } else {
      target.action = ros::Marker::kDelete;
    }
    all.markers.push_back(std::move(target));

    ros::Marker plan = marker(header, "plan", ros::Marker::kLineStrip, {0.1F, 0.6F, 1.0F, 1.0F});
    plan.scale.x = 0.04;
    for (const Pose& pose : poses) plan.points.push_back(point(pose.position));
    if (plan.points.size() < 2) plan.action = ros::Marker::kDelete;
    all.markers.push_back(std::move(plan));

    ros::Marker points =
        marker(header, "landmarks", ros::Marker::kPoints, {0.2F, 0.9F, 0.3F, 1.0F});
    points.scale = {0.04, 0.04, 0.0};
    if (step.belief->landmarks) {
      const std::vector<Landmark>& landmarks = step.belief->landmarks->landmarks;
      const std::size_t every = landmarks.size() / kMostLandmarks + 1;
      for (std::size_t i = 0; i < landmarks.size(); i += every) {
        points.points.push_back(point(in_map({landmarks[i].position, 0.0}, *step.belief).position));
      }
    }
    if (points.points.empty()) points.action = ros::Marker::kDelete;
    all.markers.push_back(std::move(points));
    node.publish(markers, all);
  }

  void publish_diagnostics(const ros::Header& header, const MissionStep& step) {
    if (diagnostics < 0) return;
    const Plan& plan = *step.plan;
    const Belief& belief = *step.belief;
    using Status = ros::DiagnosticStatus;
    ros::DiagnosticArray m;
    m.header.stamp = header.stamp;
    const std::string us = options.address.node + ": ";
    Status behaviour{Status::kOk, us + "behaviour", plan.why, options.address.node, {}};
    if (plan.kind == PlanKind::kStoppingTail) {
      behaviour.level = Status::kWarn;
      behaviour.message = plan.detail.empty() ? plan.why : plan.detail;
    }
    behaviour.values = {{"mode", std::string(to_string(plan.mode.kind))},
                        {"cause", std::string(to_string(plan.mode.cause))},
                        {"plan", std::string(to_string(plan.kind))},
                        {"guard stops", std::to_string(step.guard_stops)},
                        {"time of the step [ms]", number_text(plan.times.total)}};
    m.status.push_back(std::move(behaviour));

    Status localization{Status::kOk,
                        us + "localization",
                        std::string(to_string(belief.localization)),
                        options.address.node,
                        {}};
    if (belief.localization == Localization::kLost)
      localization.level = Status::kError;
    else if (belief.localization != Localization::kOk)
      localization.level = Status::kWarn;
    localization.values = {{"tracked features", std::to_string(belief.tracked_features)}};
    if (const MapFrame* frame = belief.map_frame.get()) {
      localization.values.push_back({"corrections", std::to_string(frame->taken)});
      localization.values.push_back(
          {"corrections refused", std::to_string(frame->refused + frame->cannot_follow)});
      if (frame->newest) localization.values.push_back({"corrected", to_text(*frame->newest)});
      if (is_turned(belief)) {
        localization.values.push_back(
            {"octomap", "cannot follow: not published since the map was corrected"});
      }
    }
    m.status.push_back(std::move(localization));

    m.status.push_back(topics_status());
    node.publish(diagnostics, m);
  }

  std::string named(const char* what) const { return options.address.node + ": " + what; }

  ros::DiagnosticStatus topics_status() const {
    using Status = ros::DiagnosticStatus;
    const std::vector<std::string> faults = node.faults();
    Status topics{faults.empty() ? Status::kOk : Status::kError,
                  named("topics"),
                  faults.empty() ? "all fit" : faults.front(),
                  options.address.node,
                  {}};
    for (std::size_t n = 1; n < faults.size(); ++n) {
      topics.values.push_back({"fault " + std::to_string(n + 1), faults[n]});
    }
    return topics;
  }

  void publish_status(const DriverStatus& status) {
    using Status = ros::DiagnosticStatus;
    const DriveMode mode = status.mode.mode;
    const std::string told = requests.told();
    const Status drive{mode == DriveMode::kStopped                               ? Status::kError
                       : mode == DriveMode::kActive || mode == DriveMode::kReady ? Status::kOk
                                                                                 : Status::kWarn,
                       named("drive"),
                       status.why,
                       options.address.node,
                       {{"mode", std::string(to_string(mode))},
                        {"cause", std::string(to_string(status.mode.cause))},
                        {"goal", told}}};
    if (state >= 0) node.publish(state, drive);
    const double now = clock.now();
    constexpr double kEvery = 1.0;  // [s]
    if (diagnostics < 0 || now < next_status) return;
    next_status = now + kEvery;
    ros::DiagnosticArray m;
    m.header.stamp = base.ros_time(now);
    m.status = {drive,
                {!told.empty() && requests.told_refused() ? Status::kWarn : Status::kOk,
                 named("goal"),
                 told.empty() ? "nothing to tell" : told,
                 options.address.node,
                 {}},
                topics_status()};
    node.publish(diagnostics, m);
  }

  void publish_maps(const ros::Header& header, const Belief& belief) {
    const double now = clock.now();
    if (now < next_map) return;
    next_map = now + options.output.map_period;
    if (map >= 0 && belief.ground) {
      std::vector<std::int8_t> cells;
      const ros::OccupancyGrid m = grid_message(header, belief, cells);
      node.publish(map, m, cells.size());
    }
    if (octree >= 0 && belief.octree && !is_turned(belief)) {
      std::string bytes;
      const ros::Octomap m = octomap_message(header, *belief.octree, bytes);
      node.publish(octree, m, bytes.size());
    }
  }

  const DdsOptions options;
  DdsNode& node;
  const DdsBase& base;
  const Clock& clock;
  std::shared_ptr<const MotionModel> model;
  const DriveRequests& requests;
  double next_status = -1e9;
  int state = -1;
  int path = -1, map = -1, octree = -1, markers = -1, diagnostics = -1, transforms = -1;
  double next_map = -1e9;
};

DdsPublisher::DdsPublisher(const DdsOptions& options, DdsNode& node, const DdsBase& base,
                           const Clock& clock, std::shared_ptr<const MotionModel> model,
                           const DriveRequests& requests)
    : impl_(std::make_unique<Impl>(options, node, base, clock, std::move(model), requests)) {}
DdsPublisher::~DdsPublisher() = default;

void DdsPublisher::on_belief(const Belief& belief) {
  impl_->publish_transforms(impl_->header_of(belief), belief);
}

void DdsPublisher::on_step(const MissionStep& step) {
  const Belief& belief = *step.belief;
  const ros::Header header = impl_->header_of(belief);
  std::vector<Pose> poses;
  for (const Eigen::VectorXd& x : step.plan->states) {
    poses.push_back(in_map(impl_->model->pose(x), belief));
  }
  impl_->publish_path(*step.plan, poses);
  impl_->publish_markers(header, step, poses);
  impl_->publish_diagnostics(header, step);
  impl_->publish_maps(header, belief);
}

void DdsPublisher::on_status(const DriverStatus& status, const HealthReport&) {
  impl_->publish_status(status);
}

}  // namespace prospect
