// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "adapters/robots/gazebo/gazebo_options.h"
#include "models/types.h"
#include "runtime/sensor_frame.h"

namespace prospect {

/// The world of a Gazebo that stands, and goes on by as many steps of its physics as it is told.
/// Poses, wheels, which frames come when, and their pixels rest on the world, the seed and the
/// calls alone, to the bit, and not on how fast anybody is; if its cameras have no noise of
/// Gazebo's.
///
/// Stamps. With h the step and f the rate of a camera, it takes its first frame at the first of the
/// times k / f + [0, h) at which it looks, and each other 1 / f after the one before. Whether it
/// looks at 1 / f rests on how fast it is, so the world stands at the first step t of there, until
/// it has. Then the k-th frame is that of the step next to t + (k - 1) / f; another is a fault. It
/// is due from the step ceil(k / (f h)) + 1 on, and handed on then: whether it came before does not
/// matter, and it is waited for if it did not.
///
/// Poses are the wheels' and the truth's: at each pair and at the end of a command. Gazebo tells at
/// most 60 a second of the machine, whatever the world does. So the last step to there is made by
/// itself, more than a sixtieth of a second after the one before; and where a busy machine has left
/// them out all the same they are asked for, which takes up to 0.2 s.
///
/// A velocity is taken by the plug-in before the world goes on: an answer to a request that was
/// sent after it says that it was handled.
///
/// For its first second the world stands and nothing is handed on: who publishes has to hear of who
/// listens.
///
/// Who ends leaves a world that stands, so no relay is needed. Thread-safety: one thread; none is
/// started. Errors: the constructor throws InputError, one line: no Gazebo, no such robot or
/// sensor, a world that runs or has run; NotBuiltIn. Later nothing throws: see fault().
class SteppedGazebo {
 public:
  /// Who is told what a step brings.
  struct Told {
    std::function<void(const SensorFrame&)> frame;          ///< wheels, then others by stamp
    std::function<void(double stamp, const Pose&)> pose{};  ///< that is true of the model
  };

  explicit SteppedGazebo(const GazeboOptions& options);
  ~SteppedGazebo();
  SteppedGazebo(const SteppedGazebo&) = delete;
  SteppedGazebo& operator=(const SteppedGazebo&) = delete;

  /// Holds a velocity until a time [s], rounded to a step.
  void advance(const Twist& command, double until, const Told& told) noexcept;

  double time() const;  ///< [s] since the world's beginning
  const std::string& world() const;
  const Pose& start() const;  ///< of the model, at time 0
  /// Why it does not go on any more; empty: it does. Then advance() does nothing.
  const std::string& fault() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
