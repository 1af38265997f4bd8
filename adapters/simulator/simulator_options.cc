#include "adapters/simulator/simulator_options.h"

#include "models/knobs.h"

namespace prospect {

void describe(Knobs& knobs, CameraSensorsOptions& o) {
  knobs.number("texture_quality", o.texture_quality, {0.0, 1.0}, "1",
               "contrast of surfaces, 0 blank to 1 rich");
  knobs.number("focal_error", o.focal_error, {-0.9, 9.0}, "1",
               "by which the stereo pair's focal length is believed too large");
  knobs.number("baseline_error", o.baseline_error, {-0.9, 9.0}, "1",
               "by which its baseline is believed too large");
  describe(knobs, o.rig);
  knobs.boolean("wheels", o.wheels, "wheel odometry, fused with what the images say");
  knobs.group("wheel_fusion", [&] { describe(knobs, o.wheel_fusion); });
  knobs.group("odometry", [&] { describe(knobs, o.odometry); });
}

void describe(Knobs& knobs, SimulatorOptions& o) {
  knobs.choice("sensors", o.sensors, {"model", "camera"},
               "odometry as a model of its errors, or rendered images through perception");
  knobs.number("map_resolution", o.mapping.resolution, {0.02, 1.0}, "m",
               "of the map that is built");
  knobs.number("depth_rate", o.depth_rate, {0.1, 1000.0}, "1/s", "depth images");
  knobs.number("image_rate", o.image_rate, {0.1, 1000.0}, "1/s", "stereo images");
  knobs.group("actuation", [&] { describe(knobs, o.actuation); });
  knobs.group("odometry", [&] { describe(knobs, o.odometry); });
  knobs.group("depth", [&] { describe(knobs, o.depth); });
  knobs.group("features", [&] { describe(knobs, o.features); });
  knobs.group("landmarks", [&] { describe(knobs, o.landmarks); });
  knobs.group("mapping", [&] { describe(knobs, o.mapping); });
  knobs.group("camera", [&] { describe(knobs, o.camera); });
}

}  // namespace prospect
