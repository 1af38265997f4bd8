// SPDX-License-Identifier: Apache-2.0
#include "runtime/preflight.h"

#include <algorithm>
#include <cmath>

#include "engine/maps/map_projection.h"
#include "models/formatted.h"
#include "models/knobs.h"

namespace prospect {
namespace {

CheckResult not_possible(const std::string& check, const std::string& why) {
  return {check, CheckVerdict::kNotPossible, why};
}

/// By how far a number is off; one that is not finite fails.
CheckVerdict graded(double off, double warn, double fail) {
  if (!(std::abs(off) <= fail)) return CheckVerdict::kFailed;
  return std::abs(off) <= warn ? CheckVerdict::kPassed : CheckVerdict::kWarned;
}

CheckResult height_check(const PreflightFacts& facts, const PreflightOptions& o) {
  if (!facts.floor) return not_possible("camera height", "no floor was seen");
  const PreflightFacts::Floor& f = *facts.floor;
  // What the measurement itself may be off by counts for the camera.
  const double off = f.height - f.stated_height;
  const double sure = std::max(0.0, std::abs(off) - 2.0 * f.sigma_height);
  return {"camera height", graded(std::isfinite(off) ? sure : off, o.height_warn, o.height_fail),
          formatted("%.3f m above the floor as seen (sigma %.3f), %.3f m as mounted; expected "
                    "within %.3f m",
                    f.height, f.sigma_height, f.stated_height, o.height_warn)};
}

CheckResult tilt_check(const PreflightFacts& facts, const PreflightOptions& o) {
  if (!facts.floor) return not_possible("camera tilt", "no floor was seen");
  const PreflightFacts::Floor& f = *facts.floor;
  const double off = std::hypot(f.pitch - f.stated_pitch, f.roll - f.stated_roll);
  const double sure = std::max(0.0, off - 2.0 * f.sigma_tilt);
  return {"camera tilt", graded(std::isfinite(off) ? sure : off, o.tilt_warn, o.tilt_fail),
          formatted("pitch %.3f and roll %.3f rad as seen (sigma %.3f), %.3f and %.3f as mounted; "
                    "expected within %.3f rad",
                    f.pitch, f.roll, f.sigma_tilt, f.stated_pitch, f.stated_roll, o.tilt_warn)};
}

CheckResult body_check(const PreflightFacts& facts, const PreflightOptions& o) {
  const std::string name = "body above the floor";
  if (!facts.body) return not_possible(name, "the body's heights are not known");
  const VerticalExtent& body = *facts.body;
  const double r = facts.resolution;
  if (!std::isfinite(body.z_min) || !std::isfinite(body.z_max) || !(body.z_min < body.z_max) ||
      !std::isfinite(r) || !(r > 0.0)) {
    return {name, CheckVerdict::kFailed,
            formatted("the body reaches from %g to %g m, voxels are %g m; expected heights in "
                      "order and a size",
                      body.z_min, body.z_max, r)};
  }
  const double lowest = slice_layers({body.z_min, body.z_max, std::nullopt}, r).k_low * r;
  const double seen = facts.floor ? facts.floor->stated_height - facts.floor->height : 0.0;
  const double sure = facts.floor ? seen - 2.0 * facts.floor->sigma_height : 0.0;
  const std::string where =
      formatted("its lowest voxels begin at %.3f m, the floor is seen at %.3f m", lowest, seen);
  // At exactly the height where voxels begin a surface is in them; the floor itself is at 0.
  if (!std::isfinite(seen) || !std::isfinite(sure) || (sure > 0.0 && sure >= lowest - 1e-9)) {
    return {name, CheckVerdict::kFailed,
            where +
                ": it is an obstacle everywhere; expected it below (mount the camera as it is "
                "stated, or raise the body's lower end)"};
  }
  if (seen + o.floor_noise >= lowest) {
    return {name, CheckVerdict::kWarned,
            where + formatted("; expected %.3f m between them, or noise is an obstacle",
                              o.floor_noise)};
  }
  if (!facts.floor) return not_possible(name, "no floor was seen; as mounted it is low enough");
  return {name, CheckVerdict::kPassed, where};
}

CheckResult floor_ahead_check(const PreflightFacts& facts) {
  const std::string name = "floor ahead";
  if (!facts.floor_ahead) return not_possible(name, "nobody says what of it is in view");
  const PreflightFacts::FloorAhead& ahead = *facts.floor_ahead;
  if (!ahead.sight) {
    return {name, CheckVerdict::kWarned,
            "no depth sensor shows whether it is there: edges, holes and stairs down are not seen"};
  }
  const double a = facts.deceleration.model, v = facts.speed.model;
  const double most = speed_for_sight(ahead.sight->to - ahead.front, ahead.delay, a);
  const std::string seen =
      formatted("seen from %.2f to %.2f m ahead; what is nearer has to have been",
                ahead.sight->from, ahead.sight->to);
  if (!(v <= most)) {
    return {
        name, CheckVerdict::kWarned,
        seen + formatted("; at %.2f m/s the robot needs %.2f m to rest, so an edge would be seen "
                         "too late; expected at most %.2f m/s",
                         v, v * ahead.delay + 0.5 * v * v / a, most)};
  }
  return {name, CheckVerdict::kPassed, seen + formatted("; in time up to %.2f m/s", most)};
}

CheckResult stereo_check(const PreflightFacts& facts, const PreflightOptions& o) {
  if (!facts.stereo_offset) return not_possible("cameras in step", "no pair of images was stamped");
  return {"cameras in step", graded(*facts.stereo_offset, o.stereo_warn, o.stereo_fail),
          formatted("right image %.2f ms after the left one; expected within %.2f ms",
                    1e3 * *facts.stereo_offset, 1e3 * o.stereo_warn)};
}

CheckResult clock_check(const PreflightFacts::Clock& clock) {
  const std::string name = "clock of " + clock.source;
  if (!clock.offset) {
    return {name, CheckVerdict::kFailed, "its offset is not known yet; expected stamps that agree"};
  }
  if (!std::isfinite(*clock.offset)) {
    return {name, CheckVerdict::kFailed, formatted("offset %g; expected a number", *clock.offset)};
  }
  return {name, clock.jumps > 0 ? CheckVerdict::kWarned : CheckVerdict::kPassed,
          formatted("offset %.6f s, jumped %d times", *clock.offset, clock.jumps)};
}

CheckResult stream_check(const PreflightFacts::Stream& s, const PreflightOptions& o) {
  const bool live = s.age >= 0.0 && s.age <= s.limit && s.live_for >= o.live_time;
  return {"stream of " + s.source, live ? CheckVerdict::kPassed : CheckVerdict::kFailed,
          formatted("%.3f s old, within %.3f s for %.1f s; expected for %.1f s", s.age, s.limit,
                    s.live_for, o.live_time) +
              (s.rate ? formatted("; %.1f a second", *s.rate) : "")};
}

CheckResult localization_check(const PreflightFacts& facts) {
  const std::string name = "localization";
  if (!facts.place) return not_possible(name, "nothing says where the robot is");
  const Pose& at = facts.place->pose;
  std::string why = std::string(to_string(facts.place->localization)) +
                    formatted(", at (%.2f, %.2f) m, turned by %.0f degrees", at.position.x(),
                              at.position.y(), at.yaw * 180.0 / M_PI);
  if (std::isfinite(facts.place->sigma)) why += formatted(", within %.3f m", facts.place->sigma);
  const bool ok = facts.place->localization == Localization::kOk;
  return {name, ok ? CheckVerdict::kPassed : CheckVerdict::kWarned, why};
}

CheckResult ranges_check(const PreflightFacts& facts) {
  if (!facts.ranges) return not_possible("ranges", "no raw ranges come");
  const PreflightFacts::Ranges& r = *facts.ranges;
  if (r.hits == 0) {
    return {"ranges", CheckVerdict::kWarned,
            formatted("none of %zu rays hits anything; expected a sensor that is not covered, and "
                      "walls within its range",
                      r.rays)};
  }
  return {
      "ranges", CheckVerdict::kPassed,
      formatted("%zu of %zu rays hit something, the nearest at %.2f m", r.hits, r.rays, r.nearest)};
}

CheckResult emergency_stop_check(const PreflightFacts& facts) {
  const std::string name = "emergency stop";
  if (!facts.emergency_stop) {
    return not_possible(name, "none is set up: nobody is listened to who could press it");
  }
  if (!facts.emergency_stop->silent.empty()) {
    return {name, CheckVerdict::kFailed, facts.emergency_stop->silent};
  }
  if (facts.emergency_stop->pressed) {
    return {name, CheckVerdict::kFailed, "it is pressed; expected it released"};
  }
  return {name, CheckVerdict::kPassed, "it is heard of, and released"};
}

CheckResult base_check(const PreflightFacts& facts) {
  if (!facts.base) return not_possible("base", "it was not asked");
  if (!facts.base->empty()) return {"base", CheckVerdict::kFailed, *facts.base};
  return {"base", CheckVerdict::kPassed, "it answers, and reports no fault"};
}

CheckResult priority_check(const PreflightFacts& facts) {
  const std::string name = "priority of commands";
  if (!facts.priority) return not_possible(name, "it is not asked for");
  if (!facts.priority->empty()) return {name, CheckVerdict::kWarned, *facts.priority};
  return {name, CheckVerdict::kPassed, "they are sent by SCHED_FIFO"};
}

CheckResult dead_man_check(const PreflightFacts& facts, const PreflightOptions& o) {
  if (!facts.dead_man) {
    return {"dead-man", CheckVerdict::kFailed,
            "the base declares none; expected a base, or a relay, that stops by itself"};
  }
  const double time = *facts.dead_man;
  if (!(time > 0.0 && time <= o.longest_dead_man)) {
    return {"dead-man", CheckVerdict::kFailed,
            formatted("the base stops %g s after the last command; expected above 0, at most %g s",
                      time, o.longest_dead_man)};
  }
  const std::string way =
      formatted("the base stops %.2f s after the last command: %.2f m at full speed", time,
                time * facts.speed.model);
  const double period = facts.command_period;
  if (!(period < time)) {
    return {"dead-man", CheckVerdict::kFailed,
            way + formatted("; commands come every %g s, so that it trips between two of them",
                            period)};
  }
  if (2.0 * period > time) {
    return {
        "dead-man", CheckVerdict::kWarned,
        way + formatted("; commands come every %.2f s, so that one late command trips it", period)};
  }
  return {"dead-man", CheckVerdict::kPassed, way};
}

CheckResult limit_check(const std::string& name, const char* unit,
                        const PreflightFacts::Limit& limit) {
  if (!limit.base) return not_possible(name, "the base does not say");
  const bool enough = std::isfinite(limit.model) && *limit.base >= limit.model * (1.0 - 1e-9);
  return {name, enough ? CheckVerdict::kPassed : CheckVerdict::kFailed,
          formatted("the base reaches %.3g %s, the model counts on %.3g; expected no less",
                    *limit.base, unit, limit.model)};
}

/// How a kind of motion is told of, and by how much its gain may be off.
struct MotionWords {
  const char *unit, *stands, *other_way;
  double warn, fail;
};

CheckResult gain_check(const std::string& name, double from, const std::optional<double>& to,
                       const char* missing, const MotionWords& words) {
  if (!to) return not_possible(name, missing);
  const std::string moved = formatted("%.3f %s of %.3f", *to, words.unit, from);
  const double gain = *to / from;
  if (!std::isfinite(gain)) return {name, CheckVerdict::kFailed, moved + "; expected numbers"};
  if (std::abs(gain) < 0.25) return {name, CheckVerdict::kFailed, moved + words.stands};
  if (gain < 0.0) return {name, CheckVerdict::kFailed, moved + words.other_way};
  return {name, graded(gain - 1.0, words.warn, words.fail),
          moved + formatted(": gain %.2f; expected 1 within %.2f", gain, words.warn)};
}

constexpr const char* kNoWheels = "the base reports no motion";
constexpr const char* kNoPose = "the pose has no motion";
constexpr const char* kNoGyro = "the IMU told nothing while the robot stood";

/// The checks `names` of a motion of which too little was commanded; empty: it was enough.
std::vector<CheckResult> too_little(const std::vector<std::string>& names, const char* unit,
                                    double commanded, double least) {
  std::vector<CheckResult> results;
  if (std::abs(commanded) >= least) return results;
  for (const std::string& name : names) {
    results.push_back(not_possible(
        name, formatted("%.3f %s were commanded; expected %.3f", commanded, unit, least)));
  }
  return results;
}

}  // namespace

std::string_view to_string(CheckVerdict verdict) {
  switch (verdict) {
    case CheckVerdict::kPassed:
      return "passed";
    case CheckVerdict::kWarned:
      return "warned";
    case CheckVerdict::kFailed:
      return "failed";
    case CheckVerdict::kNotPossible:
      return "not possible";
  }
  return "?";
}

std::vector<CheckResult> checks_before_motion(const PreflightFacts& facts,
                                              const PreflightOptions& options) {
  check_knobs("preflight", options);
  std::vector<CheckResult> results;
  if (facts.depth_camera) {
    results = {height_check(facts, options), tilt_check(facts, options)};
  }
  results.push_back(body_check(facts, options));
  results.push_back(floor_ahead_check(facts));
  if (facts.stereo_pair) results.push_back(stereo_check(facts, options));
  for (const PreflightFacts::Clock& clock : facts.clocks) results.push_back(clock_check(clock));
  if (facts.clocks.empty()) results.push_back(not_possible("clocks", "no source was named"));
  for (const PreflightFacts::Stream& stream : facts.streams) {
    results.push_back(stream_check(stream, options));
  }
  // A robot without any stream sees nothing.
  if (facts.streams.empty()) {
    results.push_back(
        {"streams", CheckVerdict::kFailed, "no source was named; expected one or more"});
  }
  results.push_back(localization_check(facts));
  results.push_back(ranges_check(facts));
  results.push_back(base_check(facts));
  results.push_back(emergency_stop_check(facts));
  results.push_back(priority_check(facts));
  results.push_back(dead_man_check(facts, options));
  results.push_back(limit_check("largest speed", "m/s", facts.speed));
  results.push_back(limit_check("largest yaw rate", "rad/s", facts.yaw_rate));
  results.push_back(limit_check("deceleration", "m/s^2", facts.deceleration));
  return results;
}

std::vector<CheckResult> checks_of_turn(const ShortMotion& turn, const PreflightOptions& options) {
  check_knobs("preflight", options);
  std::vector<std::string> names = {"yaw of the wheels", "yaw of the pose", "slip"};
  if (turn.has_gyro) names.emplace_back("yaw of the gyro");
  // No number is too little, too.
  const double commanded = std::isfinite(turn.commanded) ? turn.commanded : 0.0;
  auto results = too_little(names, "rad", commanded, options.least_turn);
  if (!results.empty()) return results;
  const MotionWords words{"rad", ": it does not turn",
                          ": it turns the other way; expected positive to the left",
                          options.yaw_warn, options.yaw_fail};
  results = {gain_check(names[0], commanded, turn.wheels, kNoWheels, words),
             gain_check(names[1], commanded, turn.pose, kNoPose, words),
             turn.wheels ? gain_check(names[2], *turn.wheels, turn.pose, kNoPose, words)
                         : not_possible(names[2], kNoWheels)};
  if (turn.has_gyro) {
    results.push_back(gain_check(names[3], commanded, turn.gyro, kNoGyro, words));
  }
  return results;
}

std::vector<CheckResult> checks_of_distance(const ShortMotion& way,
                                            const PreflightOptions& options) {
  check_knobs("preflight", options);
  const std::vector<std::string> names = {"way of the wheels", "way of the pose"};
  const double commanded = std::isfinite(way.commanded) ? way.commanded : 0.0;
  auto results = too_little(names, "m", commanded, options.least_distance);
  if (!results.empty()) return results;
  const MotionWords words{"m", ": it does not drive",
                          ": it drives the other way; expected positive forwards",
                          options.distance_warn, options.distance_fail};
  return {gain_check(names[0], commanded, way.wheels, kNoWheels, words),
          gain_check(names[1], commanded, way.pose, kNoPose, words)};
}

std::string first_failed(const std::vector<CheckResult>& results) {
  for (const CheckResult& result : results) {
    if (result.verdict == CheckVerdict::kFailed) return result.check;
  }
  return "";
}

std::string to_text(const std::vector<CheckResult>& results) {
  std::size_t width = 0;
  for (const CheckResult& result : results) width = std::max(width, result.check.size());
  std::string text;
  for (const CheckResult& result : results) {
    text += result.check + std::string(width + 2 - result.check.size(), ' ');
    const std::string verdict(to_string(result.verdict));
    text += verdict + std::string(14 - verdict.size(), ' ') + result.why + '\n';
  }
  return text;
}

}  // namespace prospect
