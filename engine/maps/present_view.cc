// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/present_view.h"

#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>

namespace prospect {
namespace {

/// How far a body reaches along a horizontal direction n in B: [least, most] of p . n [m].
std::pair<double, double> extent_along(const RobotShape& shape, const Eigen::Vector3d& n) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  const auto include = [&](const Eigen::Vector3d& p, double reach) {
    least = std::min(least, p.dot(n) - reach);
    most = std::max(most, p.dot(n) + reach);
  };
  std::visit(
      [&](const auto& s) {
        using Shape = std::decay_t<decltype(s)>;
        if constexpr (std::is_same_v<Shape, SphereSetShape>) {
          for (const Sphere& sphere : s.spheres) include(sphere.center, sphere.radius);
        } else if constexpr (std::is_same_v<Shape, BoxShape>) {
          include(s.center, 0.5 * n.cwiseAbs().dot(s.size));
        } else if constexpr (std::is_same_v<Shape, CylinderShape>) {
          include(s.center, s.radius);
        } else {
          for (const Eigen::Vector3d& v : s.vertices) include(v, 0.0);
        }
      },
      shape);
  return {least, most};
}

}  // namespace

PresentView::PresentView(const Belief& belief, const DepthSensor& sensor, const RobotShape& shape,
                         bool planar)
    : voxels_(belief.voxels.get()), sensor_(sensor), shape_(shape), planar_(planar) {
  const Eigen::Isometry3d T_WB = body_transform(belief.pose);
  const Eigen::Isometry3d T_WC = T_WB * sensor.mount.T_BC;
  T_CW_ = T_WC.inverse();
  eye_ = T_WC.translation();
  origin_ = belief.pose.position;
  const Eigen::Vector3d axis = T_WC.linear().col(2);
  const double yaw = std::atan2(axis.y(), axis.x());
  along_ = {std::cos(yaw), std::sin(yaw), 0.0};
  across_ = {-along_.y(), along_.x(), 0.0};
  std::tie(right_, left_) = extent_along(shape, T_WB.linear().transpose() * across_);
  rear_ = extent_along(shape, T_WB.linear().transpose() * along_).first;
  const VerticalExtent extent = vertical_extent(shape);
  extent_ = {extent.z_min + origin_.z(), extent.z_max + origin_.z()};
  if (!planar) return;
  // The part of the map within range.
  const GridFrame& map = belief.ground->frame();
  const double range = sensor.footprint.max_range + map.resolution;
  const auto bound = [&](double v, int low, int high) {
    return static_cast<int>(std::clamp(std::floor(v / map.resolution), 1.0 * low, 1.0 * high));
  };
  const int i_high = map.i0 + map.width, j_high = map.j0 + map.height;
  GridFrame near{map.resolution, bound(eye_.x() - range, map.i0, i_high),
                 bound(eye_.y() - range, map.j0, j_high), 0, 0};
  near.width = bound(eye_.x() + range + map.resolution, near.i0, i_high) - near.i0;
  near.height = bound(eye_.y() + range + map.resolution, near.j0, j_high) - near.j0;
  in_view_ = Grid<std::uint8_t>(near, 0);
  visit_ground_in_view(*belief.ground, belief.pose, sensor, [this](Cell c) {
    ++visits_;
    in_view_[c] = 1;
  });
}

bool PresentView::covers(const Eigen::Vector3d& point) const {
  const RgbdFootprint& depth = sensor_.footprint;
  if (planar_) {
    const Eigen::Vector3d d = point - eye_;
    return std::abs(std::atan2(across_.dot(d), along_.dot(d))) <= 0.5 * depth.horizontal_fov;
  }
  const Eigen::Vector3d q = T_CW_ * point;
  return std::abs(std::atan2(q.x(), q.z())) <= 0.5 * depth.horizontal_fov &&
         std::abs(std::atan2(q.y(), std::hypot(q.x(), q.z()))) <= 0.5 * depth.vertical_fov;
}

bool PresentView::sees(const Eigen::Vector3d& point) const {
  ++visits_;
  const double r = voxels_->resolution();
  if (planar_) return in_view_.get(in_view_.frame.cell(point.x(), point.y()), 0) != 0;
  const double distance = (point - eye_).norm();
  if (!(distance <= sensor_.footprint.max_range) || !covers(point)) return false;
  const Eigen::Vector3i v = voxels_->voxel(point);
  if (voxels_->state(v.x(), v.y(), v.z()) == CellState::kUnknown) return false;
  const VoxelGrid::Ray ray = voxels_->cast(eye_, point, 0.87 * r);  // but for the point's voxel
  visits_ += static_cast<long long>(3.0 * ray.length / r);
  return !ray.blocked && ray.unknown_length < 1e-9;
}

bool PresentView::keeps_to(const Pose& pose) const {
  constexpr double kRounding = 1e-9;  // [m]
  const Eigen::Vector3d moved = pose.position - origin_;
  const double allowed = kSlope * along_.dot(moved) + kRounding;
  const double aside = across_.dot(moved);
  const auto [right, left] =
      extent_along(shape_, body_transform(pose).linear().transpose() * across_);
  return aside + right >= right_ - allowed && aside + left <= left_ + allowed &&
         (planar_ || std::abs(moved.z()) <= allowed);
}

bool PresentView::passes_by(const Eigen::Vector3d& center, double half) const {
  const Eigen::Vector3d d = center - origin_;
  const double reach = half * along_.cwiseAbs().sum();  // of the square, along and across
  if (along_.dot(d) + reach <= rear_) return false;
  const double l = across_.dot(d), wider = kSlope * (left_ - right_);
  if (l + reach <= right_ - wider || l - reach >= left_ + wider) return false;
  if (!planar_ &&
      (center.z() + half <= extent_.z_min - wider || center.z() - half >= extent_.z_max + wider)) {
    return false;
  }
  // The first point straight ahead that the field of view covers, and the cell behind it: the edge
  // of the field of view cuts the first one.
  const int steps = static_cast<int>(std::min(1e3, std::ceil(sensor_.footprint.max_range / half)));
  for (int n = 0; n <= steps; ++n) {
    ++visits_;
    const Eigen::Vector3d ahead = center + n * half * along_;
    if (covers(ahead)) return sees(ahead) || sees(ahead + 2.0 * half * along_);
  }
  return false;
}

bool PresentView::shows(Cell c) const { return in_view_.get(c, 0) != 0; }

bool PresentView::passes_by(Cell c) const {
  const Eigen::Vector2d center = in_view_.frame.center(c);
  return passes_by(Eigen::Vector3d(center.x(), center.y(), eye_.z()),
                   0.5 * in_view_.frame.resolution);
}

bool PresentView::shows(const Eigen::Vector3i& voxel) const {
  return sees((voxel.cast<double>().array() + 0.5) * voxels_->resolution());
}

bool PresentView::passes_by(const Eigen::Vector3i& voxel) const {
  const double r = voxels_->resolution();
  return passes_by(Eigen::Vector3d((voxel.cast<double>().array() + 0.5) * r), 0.5 * r);
}

}  // namespace prospect
