// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/kinematic_robot.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "adapters/formats/worlds/sloped_floor.h"

namespace prospect {
namespace {

constexpr double kTouch = 1e-9;   // [m]: overlap up to this is touching
constexpr double kStride = 0.01;  // [m]: longest way of a point of the body between two tests

void require(bool ok, const std::string& message) {
  if (!ok) throw std::invalid_argument(message);
}

// Convex hull, counter-clockwise, by the monotone chain.
std::vector<Eigen::Vector2d> convex_hull(std::vector<Eigen::Vector2d> p) {
  const auto less = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  };
  const auto cross = [](const Eigen::Vector2d& o, const Eigen::Vector2d& a,
                        const Eigen::Vector2d& b) {
    return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
  };
  std::sort(p.begin(), p.end(), less);
  p.erase(std::unique(p.begin(), p.end()), p.end());
  if (p.size() < 3) return p;
  std::vector<Eigen::Vector2d> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t base = hull.size();
    for (const Eigen::Vector2d& q : p) {
      while (hull.size() >= base + 2 &&
             cross(hull[hull.size() - 2], hull[hull.size() - 1], q) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(q);
    }
    hull.pop_back();
    std::reverse(p.begin(), p.end());
  }
  return hull;
}

// Ground projection of the part of a convex hull between two heights: spanned by the vertices
// between them and the points where segments between vertices cross them (every edge is such a
// segment, and every such segment lies in the hull).
std::vector<Eigen::Vector2d> slab_outline(const std::vector<Eigen::Vector3d>& vertices, double low,
                                          double high) {
  std::vector<Eigen::Vector2d> points;
  for (std::size_t a = 0; a < vertices.size(); ++a) {
    const Eigen::Vector3d& p = vertices[a];
    if (p.z() >= low && p.z() <= high) points.emplace_back(p.head<2>());
    for (std::size_t b = a + 1; b < vertices.size(); ++b) {
      const Eigen::Vector3d& q = vertices[b];
      for (const double z : {low, high}) {
        if ((p.z() - z) * (q.z() - z) >= 0.0) continue;
        const double s = (z - p.z()) / (q.z() - p.z());
        points.emplace_back((p + s * (q - p)).head<2>());
      }
    }
  }
  return convex_hull(std::move(points));
}

bool overlaps(double low_a, double high_a, double low_b, double high_b) {
  return std::min(high_a, high_b) - std::max(low_a, low_b) > kTouch;
}

}  // namespace

Pose advance(const Pose& pose, const Twist& twist, double duration) {
  const double angle = twist.yaw_rate * duration;
  const auto sinc = [](double a) {
    return std::abs(a) < 1e-4 ? 1.0 - a * a / 6.0 : std::sin(a) / a;
  };
  const double s = sinc(angle);
  const double c = 0.5 * angle * sinc(0.5 * angle) * sinc(0.5 * angle);
  const double dx = (s * twist.linear.x() - c * twist.linear.y()) * duration;
  const double dy = (c * twist.linear.x() + s * twist.linear.y()) * duration;
  Pose next = pose;
  next.position.x() += std::cos(pose.yaw) * dx - std::sin(pose.yaw) * dy;
  next.position.y() += std::sin(pose.yaw) * dx + std::cos(pose.yaw) * dy;
  next.yaw += angle;
  return next;
}

ContactTest::ContactTest(const World& world, const RobotShape& shape, double base_height)
    : world_(&world) {
  validate(shape);
  const double r = world.voxels.resolution();
  const VerticalExtent extent = vertical_extent(shape);
  const int k_from = static_cast<int>(std::floor((base_height + extent.z_min) / r)) - 1;
  const int k_to = static_cast<int>(std::ceil((base_height + extent.z_max) / r)) + 1;
  for (int k = k_from; k <= k_to; ++k) {
    const double low = k * r - base_height;  // of the layer, in B
    const double high = (k + 1) * r - base_height;
    Layer layer;
    layer.k = k;
    std::visit(
        [&](const auto& s) {
          using Shape = std::decay_t<decltype(s)>;
          if constexpr (std::is_same_v<Shape, SphereSetShape>) {
            for (const Sphere& sphere : s.spheres) {
              const double dz = std::max({low - sphere.center.z(), sphere.center.z() - high, 0.0});
              if (dz + kTouch >= sphere.radius) continue;
              layer.outlines.push_back({sphere.center.template head<2>(),
                                        std::sqrt(sphere.radius * sphere.radius - dz * dz),
                                        {}});
            }
          } else if constexpr (std::is_same_v<Shape, CylinderShape>) {
            if (!overlaps(low, high, s.center.z() - 0.5 * s.height,
                          s.center.z() + 0.5 * s.height)) {
              return;
            }
            layer.outlines.push_back({s.center.template head<2>(), s.radius, {}});
          } else {
            std::vector<Eigen::Vector3d> vertices;
            if constexpr (std::is_same_v<Shape, BoxShape>) {
              for (int corner = 0; corner < 8; ++corner) {
                const Eigen::Vector3d sign((corner & 1) ? 0.5 : -0.5, (corner & 2) ? 0.5 : -0.5,
                                           (corner & 4) ? 0.5 : -0.5);
                vertices.emplace_back(s.center + sign.cwiseProduct(s.size));
              }
            } else {
              vertices = s.vertices;
            }
            if (!overlaps(low, high, extent.z_min, extent.z_max)) return;
            Outline outline;
            outline.corners = slab_outline(vertices, low, high);
            if (outline.corners.size() < 3) return;
            for (const auto& p : outline.corners) outline.center += p;
            outline.center /= static_cast<double>(outline.corners.size());
            for (const auto& p : outline.corners) {
              outline.radius = std::max(outline.radius, (p - outline.center).norm());
            }
            layer.outlines.push_back(std::move(outline));
          }
        },
        shape);
    for (const Outline& o : layer.outlines) {
      if (o.corners.empty()) radius_ = std::max(radius_, o.center.norm() + o.radius);
      for (const auto& p : o.corners) radius_ = std::max(radius_, p.norm());
    }
    if (!layer.outlines.empty()) layers_.push_back(std::move(layer));
  }
}

bool ContactTest::touches(const Outline& outline, int k, const Pose& pose) const {
  const double r = world_->voxels.resolution();
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(pose.yaw).toRotationMatrix();
  const Eigen::Vector2d center = R * outline.center + pose.position.head<2>();
  const auto address = [r](double x) { return static_cast<int>(std::floor(x / r)); };
  std::vector<Eigen::Vector2d> corners;
  for (int j = address(center.y() - outline.radius); j <= address(center.y() + outline.radius);
       ++j) {
    for (int i = address(center.x() - outline.radius); i <= address(center.x() + outline.radius);
         ++i) {
      if (!world_->solid(i, j, k)) continue;
      const Eigen::Vector2d low(i * r, j * r), high((i + 1) * r, (j + 1) * r);
      const Eigen::Vector2d nearest = center.cwiseMax(low).cwiseMin(high);
      const double reach = outline.radius - kTouch;
      if (!(reach > 0.0) || (nearest - center).squaredNorm() >= reach * reach) continue;
      if (outline.corners.empty()) return true;
      // Separating axes of two convex polygons: the square's two, and the outline's edge normals.
      if (corners.empty()) {
        for (const auto& p : outline.corners) corners.emplace_back(R * p + pose.position.head<2>());
      }
      bool apart = false;
      const auto separated_along = [&](const Eigen::Vector2d& n) {
        double a_low = 1e300, a_high = -1e300, b_low = 1e300, b_high = -1e300;
        for (const auto& p : corners) {
          a_low = std::min(a_low, n.dot(p));
          a_high = std::max(a_high, n.dot(p));
        }
        for (int corner = 0; corner < 4; ++corner) {
          const double s = n.x() * ((corner & 1) ? low.x() : high.x()) +
                           n.y() * ((corner & 2) ? low.y() : high.y());
          b_low = std::min(b_low, s);
          b_high = std::max(b_high, s);
        }
        return !overlaps(a_low, a_high, b_low, b_high);
      };
      apart =
          separated_along(Eigen::Vector2d::UnitX()) || separated_along(Eigen::Vector2d::UnitY());
      for (std::size_t a = 0; a < corners.size() && !apart; ++a) {
        const Eigen::Vector2d edge = corners[(a + 1) % corners.size()] - corners[a];
        const double length = edge.norm();
        if (length > 0.0) apart = separated_along(Eigen::Vector2d(edge.y(), -edge.x()) / length);
      }
      if (!apart) return true;
    }
  }
  return false;
}

bool ContactTest::in_contact(const Pose& pose) const {
  int up = 0;  // layers that it stands higher
  if (!world_->slopes.empty()) {
    const double height = floor_height(*world_, pose.position.head<2>());
    up = static_cast<int>(std::lround(height / world_->voxels.resolution()));
  }
  for (const Layer& layer : layers_) {
    for (const Outline& outline : layer.outlines) {
      if (touches(outline, layer.k + up, pose)) return true;
    }
  }
  return false;
}

bool ContactTest::touches(const Pose& pose, const Disc& disc) const {
  const Eigen::Vector2d at =
      Eigen::Rotation2Dd(-pose.yaw) * (disc.center - pose.position.head<2>());
  const double reach = disc.radius - kTouch;
  for (const Layer& layer : layers_) {
    for (const Outline& outline : layer.outlines) {
      const double apart = (at - outline.center).norm();
      if (apart >= outline.radius + reach) continue;
      if (outline.corners.empty()) return true;
      bool inside = true;
      for (std::size_t n = 0; n < outline.corners.size(); ++n) {
        const Eigen::Vector2d& a = outline.corners[n];
        const Eigen::Vector2d edge = outline.corners[(n + 1) % outline.corners.size()] - a;
        const double along = std::clamp(edge.dot(at - a) / edge.squaredNorm(), 0.0, 1.0);
        if ((a + along * edge - at).norm() < reach) return true;
        inside = inside && edge.x() * (at - a).y() - edge.y() * (at - a).x() >= 0.0;
      }
      if (inside) return true;
    }
  }
  return false;
}

Stance::Stance(const World& world, const RobotShape& shape, double step)
    : world_(&world), step_(step), layers_{floor_layer(step, world.voxels.resolution()), 0} {
  constexpr int kAround = 16;  // points of a disc
  for (const OutlinePart& part : ground_outline(shape)) {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& corner : part.corners) middle += corner;
    middle /= static_cast<double>(part.corners.size());
    wheels_.push_back(middle);
    for (const Eigen::Vector2d& corner : part.corners) {
      const Eigen::Vector2d drawn_in = middle + kStance * (corner - middle);
      if (!(part.radius > 0.0)) wheels_.push_back(drawn_in);
      for (int n = 0; part.radius > 0.0 && n < kAround; ++n) {
        const double angle = 2.0 * M_PI * n / kAround;
        wheels_.push_back(drawn_in + kStance * part.radius *
                                         Eigen::Vector2d(std::cos(angle), std::sin(angle)));
      }
    }
  }
}

bool Stance::falls(const Pose& pose) const {
  const Eigen::Rotation2Dd R(pose.yaw);
  return std::any_of(wheels_.begin(), wheels_.end(), [&](const Eigen::Vector2d& wheel) {
    const Eigen::Vector2d p = pose.position.head<2>() + R * wheel;
    const Cell c = world_->voxels.frame().cell(p.x(), p.y());
    return floor_state(world_->voxels, c, layers_) == FloorState::kMissing;
  });
}

int Stance::steps(const Pose& from, const Pose& to) const {
  if (world_->slopes.empty()) return 0;
  constexpr double kRounding = 1e-9;
  int step = 0;
  for (const Eigen::Vector2d& wheel : wheels_) {
    const auto under = [&](const Pose& pose) {
      return floor_height(*world_, pose.position.head<2>() + Eigen::Rotation2Dd(pose.yaw) * wheel);
    };
    const double rise = under(to) - under(from);
    if (rise > step_ + kRounding) return 1;
    if (rise < -step_ - kRounding) step = -1;
  }
  return step;
}

void KinematicRobot::carry_to(const Pose& pose) {
  const double height = pose_.position.z();
  pose_ = pose;
  pose_.position.z() = height;
  pose_ = on_the_floor(pose_);
}

Pose KinematicRobot::on_the_floor(Pose pose) const {
  if (world_->slopes.empty()) return pose;
  pose.position.z() = base_height_ + standing(*world_, pose.position.head<2>(), pose.yaw).height;
  return pose;
}

KinematicRobot::KinematicRobot(const World& world, const RobotShape& shape,
                               const ActuationNoise& noise, const Pose& start, std::uint64_t seed,
                               double step)
    : world_(&world),
      base_height_(start.position.z()),
      contact_(world, shape, start.position.z()),
      stance_(world, shape, step),
      noise_(noise),
      generator_(seed),
      pose_(on_the_floor(start)) {
  const std::string where = "world '" + world.name + "': start (" +
                            std::to_string(start.position.x()) + ", " +
                            std::to_string(start.position.y()) + ") m ";
  require(start.position.allFinite() && std::isfinite(start.yaw),
          "world '" + world.name + "': start is not finite, expected numbers");
  const Eigen::Vector3i v = world.voxels.voxel(start.position);
  require(world.voxels.frame().contains({v.x(), v.y()}),
          where + "lies outside the map, expected a place inside");
  require(!contact_.in_contact(start),
          where + "is in a wall or other solid space, expected a place where the robot fits");
  require(!stance_.falls(start),
          where + "is over a hole or an edge, expected a place with floor under the robot");
  for (const double s : {noise.linear, noise.angular, noise.coupling}) {
    require(std::isfinite(s) && s >= 0.0 && s <= 10.0,
            "actuation noise is " + std::to_string(s) + ", expected 0..10");
  }
}

bool KinematicRobot::move(const Twist& twist, double duration) {
  if (!(duration > 0.0) || !std::isfinite(duration) || !twist.linear.allFinite() ||
      !std::isfinite(twist.yaw_rate)) {
    return true;
  }
  std::normal_distribution<double> normal(0.0, 1.0);
  // Drawn in any case, so that the noise of a later motion does not depend on this one.
  const double e_linear = normal(generator_), e_angular = normal(generator_),
               e_coupling = normal(generator_);
  const double density = 1.0 / std::sqrt(duration);
  Twist real = twist;
  real.linear.z() = 0.0;
  const double commanded = real.linear.norm();
  real.linear *= 1.0 + noise_.linear * e_linear * density;
  real.yaw_rate *= 1.0 + noise_.angular * e_angular * density;
  real.yaw_rate += noise_.coupling * commanded * e_coupling * density;
  const double speed = real.linear.norm();
  if (fallen_) return false;
  const double way = (speed + std::abs(real.yaw_rate) * contact_.radius()) * duration;
  if (way <= 0.0) return true;

  const int steps = std::max(1, static_cast<int>(std::ceil(std::min(way, 1e4) / kStride)));
  const Pose start = pose_;
  int done = 0;
  for (; done < steps; ++done) {
    const Pose next = on_the_floor(advance(start, real, duration * (done + 1) / steps));
    const int step = stance_.steps(pose_, next);
    if (step > 0 || contact_.in_contact(next)) break;
    // Who stands in it already does not hold it.
    if (std::any_of(discs_.begin(), discs_.end(), [&](const Disc& disc) {
          return contact_.touches(next, disc) && !contact_.touches(pose_, disc);
        })) {
      break;
    }
    pose_ = next;
    fallen_ = step < 0 || stance_.falls(next);
    if (fallen_) break;
  }
  const double share = static_cast<double>(done) / steps;
  path_length_ += speed * duration * share;
  rotation_ += std::abs(real.yaw_rate) * duration * share;
  if (done == steps) {
    in_contact_ = false;
    return true;
  }
  if (fallen_) return false;
  if (done > 0 || !in_contact_) ++collisions_;
  in_contact_ = true;
  return false;
}

}  // namespace prospect
