#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "adapters/robots/gazebo/gazebo_options.h"
#include "models/types.h"
#include "runtime/sensor_frame.h"

namespace prospect {

/// The world of a Gazebo that stands, and goes on by as many steps of its physics as it is told.
/// Poses, wheels, and which frames come when rest on the world and the calls alone, to the bit, and
/// not on how fast anybody is. Pixels do not: they differ from run to run, also with the same seed
/// (docs/results/gazebo.md).
///
/// Stamps. With h the step and f the rate of a camera, its k-th frame is stamped within
/// [k / f, k / f + h], by the rounding of Gazebo. It is due from the step ceil(k / (f h)) + 1 on,
/// and handed on then: whether it came before does not matter, and it is waited for if it did not.
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

  SteppedGazebo(const GazeboOptions& options, std::uint64_t seed);
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
