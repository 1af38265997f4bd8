// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "adapters/formats/worlds/world.h"
#include "engine/maps/floor_state.h"
#include "engine/maps/map_projection.h"
#include "models/robot_shape.h"
#include "models/types.h"

namespace prospect {

class Knobs;

/// How motion departs from the command. White noise on the velocity: after T seconds at a constant
/// command the distance driven has the relative standard deviation linear / sqrt(T), the angle
/// turned angular / sqrt(T), and the heading, from driving, coupling x speed x sqrt(T) [rad].
struct ActuationNoise {
  double linear = 0.0;    ///< [sqrt(s)]
  double angular = 0.0;   ///< [sqrt(s)]
  double coupling = 0.0;  ///< [rad sqrt(s) / m]
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, ActuationNoise& options);

/// Exact contact test of a robot's body against the solid voxels of a world, for a body upright at
/// a fixed height over the floor under its origin, where that rises to the nearest voxel.
///
/// For each layer of voxels the body's slab is projected on the ground: discs of cylinders and
/// spheres (radius at the height nearest to the centre), convex outlines of boxes and hulls
/// (vertices in the slab and intersections of the hull's edges with its faces). A voxel is touched
/// if its square and such an outline overlap: exact for every shape, as a voxel is a prism. Contact
/// needs a positive overlap: bodies that only touch a face are free. Immutable after construction;
/// concurrent use is safe.
class ContactTest {
 public:
  /// Throws std::invalid_argument on an invalid shape.
  ContactTest(const World& world, const RobotShape& shape, double base_height);

  bool in_contact(const Pose& pose) const;
  /// Whether any outline of the body reaches into a disc on the ground, of any height.
  bool touches(const Pose& pose, const Disc& disc) const;
  /// Radius [m] about B's z axis that holds the body.
  double radius() const { return radius_; }

 private:
  struct Outline {  // of one layer: a disc (no corners) or a convex polygon, counter-clockwise, in
                    // B
    Eigen::Vector2d center = Eigen::Vector2d::Zero();
    double radius = 0.0;  // of the disc, or around the polygon's centre
    std::vector<Eigen::Vector2d> corners;
  };
  struct Layer {
    int k = 0;
    std::vector<Outline> outlines;
  };
  bool touches(const Outline& outline, int k, const Pose& pose) const;

  const World* world_;
  std::vector<Layer> layers_;
  double radius_ = 0.0;
};

/// Whether the floor is missing under what a body stands on, or too high. Its wheels are taken for
/// the outline of its parts on the ground, drawn in to `kStance` of their size about their middle,
/// which is our choice: a body reaches beyond its wheels. Immutable; concurrent use is safe.
class Stance {
 public:
  static constexpr double kStance = 0.8;

  /// step [m]: drop of the floor that the robot drives down.
  Stance(const World& world, const RobotShape& shape, double step);

  bool falls(const Pose& pose) const;
  /// What the floor under a wheel changes from one pose to the next by more than the step: 1 up, -1
  /// down, 0 nowhere. Up counts first.
  int steps(const Pose& from, const Pose& to) const;

 private:
  const World* world_;
  double step_;
  FloorLayers layers_;
  std::vector<Eigen::Vector2d> wheels_;  // in B
};

/// The true robot: executes body twists in the plane, with or without noise, stops at walls and
/// falls where there is no floor. Its height follows the floor (sloped_floor.h); one that rises by
/// more than the step within a centimetre is a wall to its wheels, and one that drops is an edge.
///
/// A constant twist moves along the exact arc (SE(2) exponential), with sideways motion if asked.
/// The body is tested in steps in which none of its points moves farther than 1 cm; on contact it
/// stays at the last free step. A contact is counted once until the robot has moved freely again.
/// One that has fallen stays where it fell.
/// Thread-safety: one thread. Deterministic in (world, shape, noise, seed, sequence of calls).
class KinematicRobot {
 public:
  /// Throws std::invalid_argument if the start is not finite, outside the world, in contact, or
  /// where there is no floor. step: as of Stance.
  KinematicRobot(const World& world, const RobotShape& shape, const ActuationNoise& noise,
                 const Pose& start, std::uint64_t seed, double step = HeightSlice{}.step);

  /// Moves for `duration` [s]; returns false if the motion was cut short by contact or a fall.
  bool move(const Twist& twist, double duration);
  /// What it cannot drive into from now on, besides the world.
  void stand_among(std::vector<Disc> discs) { discs_ = std::move(discs); }

  /// Somebody carries it; not into a wall.
  void carry_to(const Pose& pose);

  const Pose& pose() const { return pose_; }
  const ContactTest& contact_test() const { return contact_; }
  int collisions() const { return collisions_; }
  bool in_contact() const { return in_contact_; }
  bool fallen() const { return fallen_; }
  double path_length() const { return path_length_; }  ///< [m]
  double rotation() const { return rotation_; }        ///< [rad]

 private:
  Pose on_the_floor(Pose pose) const;

  const World* world_;
  double base_height_;  // [m] over the floor
  ContactTest contact_;
  Stance stance_;
  ActuationNoise noise_;
  std::mt19937_64 generator_;
  std::vector<Disc> discs_;
  Pose pose_;
  int collisions_ = 0;
  bool in_contact_ = false;
  bool fallen_ = false;
  double path_length_ = 0.0;
  double rotation_ = 0.0;
};

/// The pose after moving along a constant body twist for `duration` [s]: the SE(2) exponential
///   p' = p + R(yaw) V(w t) (vx, vy) t,  V(a) = [sin a, -(1-cos a); 1-cos a, sin a] / a.
/// Exact and smooth through w = 0. The twist's z component is ignored.
Pose advance(const Pose& pose, const Twist& twist, double duration);

}  // namespace prospect
