// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "adapters/formats/worlds/world.h"
#include "adapters/robots/simulator/sensors.h"
#include "adapters/robots/simulator/simulator_options.h"
#include "adapters/robots/simulator/walkers.h"
#include "engine/maps/belief.h"
#include "engine/maps/grid.h"
#include "models/types.h"

namespace prospect {

/// Kinematic simulator: a robot with a depth camera and a stereo camera in a true world. The
/// planner sees sense() and nothing else: the estimate drifts with what is really visible, and all
/// maps are built in the drifting frame.
///
/// The world's truth is left to time(), true_pose(), collisions() etc., which serve evaluation
/// only.
///
/// Determinism: same world, options and sequence of calls -> same bits. Each source of noise has a
/// generator of its own derived from the seed, so switching one off leaves the others' draws as
/// they were. Thread-safety: one thread; the beliefs it returns may be read anywhere. Errors: the
/// constructor throws std::invalid_argument (what, where, what was expected) on options out of
/// range, a start outside the world, or a robot that starts inside a wall. apply() and sense() do
/// not throw; a non-finite twist is executed as a stop. Source: the drift numbers are those of the
/// formulation's prototype; the rest is our choice.
class Simulator {
 public:
  /// perception: the robot's. With sensors that are a model, its map and density of features are
  /// all that is used of it.
  Simulator(std::shared_ptr<const World> world, const SimulatorOptions& options,
            const PerceptionOptions& perception);
  /// With simulated_perception().
  Simulator(std::shared_ptr<const World> world, const SimulatorOptions& options);
  ~Simulator();
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  /// The belief now: a snapshot after the newest image and depth scan. No time passes.
  std::shared_ptr<const Belief> sense();

  /// Executes a body twist (linear x, y [m/s] and yaw rate [rad/s]; z is ignored) for `duration`
  /// [s], taking images and scans on the way. On contact the robot stands still for the rest of it.
  void apply(const Twist& twist, double duration);

  // As SimulatedSensors. Samples of an IMU are delivered, too.
  void deliver_to(FrameSink* sink);
  void leave_ranges();
  void enter(double stamp, const SensorFrame& ranges);

  double time() const;  ///< [s] since the start
  const World& world() const;
  const SimulatorOptions& options() const;

  // The truth, for evaluation.
  Pose true_pose() const;  ///< in the true world's frame, equal to the estimate's frame at t = 0
  Pose estimated_pose() const;          ///< what sense() says now
  double localization_error() const;    ///< [m], horizontal distance between the two
  int collisions() const;               ///< separate contacts so far that it drove into
  std::vector<Walker> walkers() const;  ///< where people are now
  int bumps() const;                    ///< how often they walked into it
  bool fallen() const;                  ///< over an edge; it does not move any more
  bool in_contact() const;              ///< the last motion ended at a wall
  double path_length() const;           ///< [m] really driven
  double rotation() const;              ///< [rad] really turned, in absolute value
  int losses() const;                   ///< how often localization was lost
  std::string complaint() const;        ///< why the sensors cannot be trusted; empty: nothing known
  double lost_time() const;             ///< [s] spent lost

  /// The newest left image, where the robot has cameras; empty otherwise.
  CameraPicture picture() const;

  /// Cells of the true map counted by coverage() and seen_area(): nonzero = counts.
  void set_reachable(const Grid<std::uint8_t>& reachable);
  /// Share of the reachable cells whose column has really been seen by valid depth rays, by the
  /// rule of the ground map (any voxel of the slice seen, solid or free); NaN where none counts.
  double coverage() const;
  /// Area [m^2] of those cells.
  double seen_area() const;
  bool seen(Cell true_cell) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
