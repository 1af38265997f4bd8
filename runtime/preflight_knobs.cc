// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "runtime/preflight.h"

namespace prospect {

void describe(Knobs& knobs, PreflightOptions& o) {
  const auto pair = [&](const char* warn, double& warned, const char* fail, double& failed,
                        const char* unit, const char* warn_sentence, const char* fail_sentence) {
    knobs.number(warn, warned, {0.0, 10.0}, unit, warn_sentence);
    knobs.number(fail, failed, {0.0, 10.0}, unit, fail_sentence);
    knobs.require(warned <= failed, fail, "less than what is warned of; expected no less");
  };
  pair("height_warn", o.height_warn, "height_fail", o.height_fail, "m",
       "error of the camera's height above the floor that is warned of", "... that fails");
  pair("tilt_warn", o.tilt_warn, "tilt_fail", o.tilt_fail, "rad",
       "error of the camera's tilt that is warned of", "... that fails");
  pair("stereo_warn", o.stereo_warn, "stereo_fail", o.stereo_fail, "s",
       "time between the captures of a stereo pair that is warned of", "... that fails");
  pair("yaw_warn", o.yaw_warn, "yaw_fail", o.yaw_fail, "1",
       "error of the gain of yaw that is warned of", "... that fails");
  pair("distance_warn", o.distance_warn, "distance_fail", o.distance_fail, "1",
       "error of the gain of a short way ahead that is warned of", "... that fails");
  knobs.number("floor_noise", o.floor_noise, {0.0, 1.0}, "m", "that points of the floor stand out");
  knobs.number("longest_dead_man", o.longest_dead_man, {0.01, 10.0}, "s",
               "of silence after which the base stops by itself");
  knobs.number("live_time", o.live_time, {0.0, 60.0}, "s",
               "that a stream must have been within its limit");
  knobs.number("least_turn", o.least_turn, {0.01, 3.0}, "rad", "commanded, for the check of yaw");
  knobs.number("least_distance", o.least_distance, {0.001, 1.0}, "m",
               "commanded, for the check of the distance");
}

}  // namespace prospect
