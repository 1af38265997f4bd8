// SPDX-License-Identifier: Apache-2.0
#include "runtime/preflight.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace prospect::preflight_test {
namespace {

using ::testing::HasSubstr;
using enum CheckVerdict;
using Facts = PreflightFacts;

const double kNan = std::nan("");

/// Everything is known and as it should be.
Facts well() {
  Facts f;
  f.floor = Facts::Floor{0.45, 0.452, 0.0, 0.003, 0.0, -0.002, 0.002, 0.002};
  f.body = VerticalExtent{0.1, 0.5};
  f.resolution = 0.1;
  f.floor_ahead = Facts::FloorAhead{FloorSight{0.9, 3.9}, 0.2, 0.6};
  f.stereo_offset = 0.0002;
  f.clocks = {{"cameras", -1.7e9, 0}};
  f.streams = {{"cameras", 0.05, 0.3, 4.0}, {"depth", 0.1, 0.5, 4.0}};
  f.place = Facts::Place{{}, 0.01, Localization::kOk};
  f.ranges = Facts::Ranges{100, 50, 0.5};
  f.base = "";
  f.emergency_stop.emplace();
  f.priority = "";
  f.dead_man = 0.5;
  f.command_period = 0.05;
  f.speed = {0.8, 0.7};
  f.yaw_rate = {1.5, 1.2};
  f.deceleration = {0.6, 0.5};
  return f;
}

CheckResult result_of(const std::vector<CheckResult>& results, const std::string& check) {
  for (const CheckResult& result : results) {
    if (result.check == check) return result;
  }
  ADD_FAILURE() << "no check '" << check << "'";
  return {};
}

std::vector<std::string> names_of(const std::vector<CheckResult>& results) {
  std::vector<std::string> names;
  for (const CheckResult& result : results) names.push_back(result.check);
  return names;
}

TEST(Preflight, PassesARobotThatIsAsItShouldBe) {
  const std::vector<CheckResult> results = checks_before_motion(well());
  EXPECT_THAT(names_of(results),
              ::testing::ElementsAre(
                  "camera height", "camera tilt", "body above the floor", "floor ahead",
                  "cameras in step", "clock of cameras", "stream of cameras", "stream of depth",
                  "localization", "ranges", "base", "emergency stop", "priority of commands",
                  "dead-man", "largest speed", "largest yaw rate", "deceleration"));
  for (const CheckResult& result : results) {
    EXPECT_EQ(to_string(result.verdict), "passed") << result.check << ": " << result.why;
    EXPECT_FALSE(result.why.empty());
  }
  EXPECT_EQ(first_failed(results), "");
}

// Without facts no check is left out: each says what it lacks, or fails.
TEST(Preflight, SkipsNothingInSilence) {
  const std::vector<CheckResult> results = checks_before_motion({});
  const std::map<std::string, CheckVerdict> expected = {{"camera height", kNotPossible},
                                                        {"camera tilt", kNotPossible},
                                                        {"body above the floor", kNotPossible},
                                                        {"floor ahead", kNotPossible},
                                                        {"cameras in step", kNotPossible},
                                                        {"clocks", kNotPossible},
                                                        {"streams", kFailed},
                                                        {"localization", kNotPossible},
                                                        {"ranges", kNotPossible},
                                                        {"base", kNotPossible},
                                                        {"emergency stop", kNotPossible},
                                                        {"priority of commands", kNotPossible},
                                                        {"dead-man", kFailed},
                                                        {"largest speed", kNotPossible},
                                                        {"largest yaw rate", kNotPossible},
                                                        {"deceleration", kNotPossible}};
  ASSERT_EQ(results.size(), expected.size());
  for (const CheckResult& result : results) {
    EXPECT_EQ(result.verdict, expected.at(result.check)) << result.check;
    EXPECT_FALSE(result.why.empty());
  }
  EXPECT_EQ(first_failed(results), "streams");
}

TEST(Preflight, SaysWhatIsSeen) {
  PreflightFacts facts;
  facts.streams = {{"scan", 0.1, 1.0, 2.0, 9.96}};
  facts.place = {{{1.0, -2.0, 0.0}, M_PI_2}, 0.05, Localization::kOk};
  facts.ranges = {360, 300, 0.45};
  const auto of = [&](const char* check) { return result_of(checks_before_motion(facts), check); };
  EXPECT_THAT(of("stream of scan").why, HasSubstr("; 10.0 a second"));
  EXPECT_EQ(of("localization").why, "ok, at (1.00, -2.00) m, turned by 90 degrees, within 0.050 m");
  EXPECT_EQ(of("localization").verdict, kPassed);
  EXPECT_EQ(of("ranges").why, "300 of 360 rays hit something, the nearest at 0.45 m");
  facts.place->localization = Localization::kLost;
  facts.place->sigma = kNan;
  facts.ranges->hits = 0;
  EXPECT_EQ(of("localization").why, "lost, at (1.00, -2.00) m, turned by 90 degrees");
  EXPECT_EQ(of("localization").verdict, kWarned);
  EXPECT_EQ(of("ranges").verdict, kWarned);
}

TEST(Preflight, OfARobotWithoutCamerasNothingIsAskedOfThem) {
  const auto names = [](bool depth, bool pair) {
    PreflightFacts facts;
    facts.depth_camera = depth;
    facts.stereo_pair = pair;
    const std::vector<std::string> all = names_of(checks_before_motion(facts));
    return std::vector<std::string>(all.begin(), std::find(all.begin(), all.end(), "clocks"));
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names(false, false), (Names{"body above the floor", "floor ahead"}));
  EXPECT_EQ(names(false, true), (Names{"body above the floor", "floor ahead", "cameras in step"}));
  EXPECT_EQ(names(true, false),
            (Names{"camera height", "camera tilt", "body above the floor", "floor ahead"}));
}

TEST(Preflight, TableOfFaults) {
  struct Case {
    const char* what;
    std::function<void(Facts&)> change;
    const char* check;
    CheckVerdict verdict;
  };
  for (const Case& c : std::vector<Case>{
           {"2 cm too low", [](Facts& f) { f.floor->height = 0.43; }, "camera height", kWarned},
           {"2 cm too high", [](Facts& f) { f.floor->height = 0.47; }, "camera height", kWarned},
           {"not known well",
            [](Facts& f) { f.floor->height = 0.43, f.floor->sigma_height = 0.01; }, "camera height",
            kPassed},
           {"10 cm too low", [](Facts& f) { f.floor->height = 0.35; }, "camera height", kFailed},
           {"no number", [](Facts& f) { f.floor->height = kNan; }, "camera height", kFailed},
           {"pitched", [](Facts& f) { f.floor->pitch = 0.03; }, "camera tilt", kWarned},
           {"a second commander", [](Facts& f) { f.base = "/cmd_vel: published by two"; }, "base",
            kFailed},
           {"no SCHED_FIFO", [](Facts& f) { f.priority = "it is refused"; }, "priority of commands",
            kWarned},
           {"rolled", [](Facts& f) { f.floor->roll = -0.1; }, "camera tilt", kFailed},
           {"rolled as stated", [](Facts& f) { f.floor->roll = f.floor->stated_roll = 0.3; },
            "camera tilt", kPassed},
           {"pitched, within twice what is not known",
            [](Facts& f) { f.floor->pitch = 0.04, f.floor->sigma_tilt = 0.016; }, "camera tilt",
            kPassed},
           {"pairs as far apart as is warned of",
            [](Facts& f) { f.stereo_offset = PreflightOptions().stereo_warn; }, "cameras in step",
            kPassed},
           {"pairs as far apart as may be",
            [](Facts& f) { f.stereo_offset = PreflightOptions().stereo_fail; }, "cameras in step",
            kWarned},
           {"just come", [](Facts& f) { f.streams[1].age = 0.0; }, "stream of depth", kPassed},
           {"live for as long as it must",
            [](Facts& f) { f.streams[1].live_for = PreflightOptions().live_time; },
            "stream of depth", kPassed},
           {"pitched as stated", [](Facts& f) { f.floor->pitch = f.floor->stated_pitch = 0.3; },
            "camera tilt", kPassed},
           {"no number", [](Facts& f) { f.floor->roll = kNan; }, "camera tilt", kFailed},
           {"pairs 3 ms apart", [](Facts& f) { f.stereo_offset = -0.003; }, "cameras in step",
            kWarned},
           {"pairs a frame apart", [](Facts& f) { f.stereo_offset = 0.066; }, "cameras in step",
            kFailed},
           {"no number", [](Facts& f) { f.stereo_offset = kNan; }, "cameras in step", kFailed},
           {"jumped", [](Facts& f) { f.clocks[0].jumps = 1; }, "clock of cameras", kWarned},
           {"not settled", [](Facts& f) { f.clocks[0].offset.reset(); }, "clock of cameras",
            kFailed},
           {"no number", [](Facts& f) { f.clocks[0].offset = kNan; }, "clock of cameras", kFailed},
           {"stale", [](Facts& f) { f.streams[1].age = 0.6; }, "stream of depth", kFailed},
           {"just begun", [](Facts& f) { f.streams[1].live_for = 0.5; }, "stream of depth",
            kFailed},
           {"no number", [](Facts& f) { f.streams[1].age = kNan; }, "stream of depth", kFailed},
           {"nobody could press it", [](Facts& f) { f.emergency_stop->silent = "/stop: nobody"; },
            "emergency stop", kFailed},
           {"pressed", [](Facts& f) { f.emergency_stop->pressed = true; }, "emergency stop",
            kFailed},
           {"none is set up", [](Facts& f) { f.emergency_stop.reset(); }, "emergency stop",
            kNotPossible},
           {"nothing looks at the floor", [](Facts& f) { f.floor_ahead->sight.reset(); },
            "floor ahead", kWarned},
           {"too fast for what is seen",
            [](Facts& f) {
              f.speed = {4.0, 3.0};
            },
            "floor ahead", kWarned},
           {"just in time",
            [](Facts& f) {
              const double v = f.speed.model;
              f.floor_ahead->sight->to = 0.2 + 0.6 * v + v * v / 2.0 / f.deceleration.model + 1e-9;
            },
            "floor ahead", kPassed},
           {"speed is no number", [](Facts& f) { f.floor_ahead->delay = kNan; }, "floor ahead",
            kWarned},
           {"no dead-man", [](Facts& f) { f.dead_man.reset(); }, "dead-man", kFailed},
           {"never", [](Facts& f) { f.dead_man = INFINITY; }, "dead-man", kFailed},
           {"too late", [](Facts& f) { f.dead_man = 1.5; }, "dead-man", kFailed},
           {"at once", [](Facts& f) { f.dead_man = 0.0; }, "dead-man", kFailed},
           {"one late command", [](Facts& f) { f.command_period = 0.3; }, "dead-man", kWarned},
           {"trips between two", [](Facts& f) { f.command_period = 0.5; }, "dead-man", kFailed},
           {"no period", [](Facts& f) { f.command_period = kNan; }, "dead-man", kFailed},
           {"slower", [](Facts& f) { f.speed.base = 0.5; }, "largest speed", kFailed},
           {"as fast", [](Facts& f) { f.speed.base = 0.7; }, "largest speed", kPassed},
           {"turns slower", [](Facts& f) { f.yaw_rate.base = 1.0; }, "largest yaw rate", kFailed},
           {"brakes less", [](Facts& f) { f.deceleration.base = 0.4; }, "deceleration", kFailed},
           {"brakes, no number", [](Facts& f) { f.deceleration.base = kNan; }, "deceleration",
            kFailed},
       }) {
    Facts facts = well();
    c.change(facts);
    const std::vector<CheckResult> results = checks_before_motion(facts);
    const CheckResult result = result_of(results, c.check);
    EXPECT_EQ(to_string(result.verdict), to_string(c.verdict)) << c.what << ": " << result.why;
    EXPECT_EQ(first_failed(results), c.verdict == kFailed ? c.check : "") << c.what;
  }
}

// The fault that was measured: a camera 2 cm lower than stated and a body down to z = 0. Either
// alone drives.
TEST(Preflight, AFloorInTheBodysLowestVoxelsFails) {
  struct Case {
    const char* what;
    double z_min, height;  // of the body; of the camera as seen, 0.45 as stated
    bool seen;
    CheckVerdict verdict;
    double sigma = 0.002;  // of the height as seen
  };
  for (const Case& c :
       {Case{"not surely in them", 0.1, 0.345, true, kWarned, 0.004},
        Case{"not known how surely", 0.1, 0.45, true, kFailed, kNan},
        Case{"both", 0.0, 0.43, true, kFailed}, Case{"the camera alone", 0.1, 0.43, true, kPassed},
        Case{"the body alone", 0.0, 0.45, true, kWarned}, Case{"neither", 0.1, 0.45, true, kPassed},
        Case{"a body in its lowest voxels by half", 0.05, 0.43, true, kFailed},
        Case{"a camera that is higher", 0.0, 0.48, true, kPassed},
        Case{"a floor at the body's voxels", 0.1, 0.345, true, kFailed},
        Case{"a floor near them", 0.1, 0.365, true, kWarned},
        Case{"no floor was seen", 0.1, 0.0, false, kNotPossible},
        Case{"nor that, a low body", 0.0, 0.0, false, kWarned},
        Case{"no number", 0.1, kNan, true, kFailed},
        Case{"no number of the body", kNan, 0.45, true, kFailed}}) {
    Facts facts = well();
    facts.body = VerticalExtent{c.z_min, 0.5};
    facts.floor->height = c.height;
    facts.floor->sigma_height = c.sigma;
    if (!c.seen) facts.floor.reset();
    const CheckResult result = result_of(checks_before_motion(facts), "body above the floor");
    EXPECT_EQ(to_string(result.verdict), to_string(c.verdict)) << c.what << ": " << result.why;
  }
}

TEST(Preflight, SignAndGainOfYaw) {
  struct Case {
    const char* what;
    ShortMotion turn;
    CheckVerdict wheels, pose, slip;
  };
  for (const Case& c :
       {Case{"as commanded", {0.2, 0.2, 0.199}, kPassed, kPassed, kPassed},
        Case{"to the right", {-0.2, -0.2, -0.199}, kPassed, kPassed, kPassed},
        Case{"Gazebo's sign", {0.2, -0.2, -0.175}, kFailed, kFailed, kWarned},
        Case{"slip of 13 %", {0.2, 0.2, 0.174}, kPassed, kWarned, kWarned},
        Case{"wheels wrong", {0.2, -0.2, 0.2}, kFailed, kPassed, kFailed},
        Case{"twice as far", {0.2, 0.4, 0.4}, kFailed, kFailed, kPassed},
        Case{"stands", {0.2, 0.0, 0.001}, kFailed, kFailed, kFailed},
        Case{"spins on its wheels", {0.2, 0.2, 0.01}, kPassed, kFailed, kFailed},
        Case{"no pose", {0.2, 0.2, {}}, kPassed, kNotPossible, kNotPossible},
        Case{"no wheels", {0.2, {}, 0.2}, kNotPossible, kPassed, kNotPossible},
        Case{"no number", {0.2, 0.2, kNan}, kPassed, kFailed, kFailed},
        Case{"no turn", {0.05, 0.05, 0.05}, kNotPossible, kNotPossible, kNotPossible},
        Case{"no command", {kNan, 0.2, 0.2}, kNotPossible, kNotPossible, kNotPossible}}) {
    const std::vector<CheckResult> results = checks_of_turn(c.turn);
    EXPECT_THAT(names_of(results),
                ::testing::ElementsAre("yaw of the wheels", "yaw of the pose", "slip"));
    EXPECT_EQ(to_string(results[0].verdict), to_string(c.wheels)) << c.what << results[0].why;
    EXPECT_EQ(to_string(results[1].verdict), to_string(c.pose)) << c.what << results[1].why;
    EXPECT_EQ(to_string(results[2].verdict), to_string(c.slip)) << c.what << results[2].why;
  }
  ShortMotion turn{0.2, 0.2, 0.2, true, 0.199};
  ASSERT_EQ(checks_of_turn(turn).size(), 4u);
  EXPECT_EQ(checks_of_turn(turn)[3].check, "yaw of the gyro");
  EXPECT_EQ(checks_of_turn(turn)[3].verdict, kPassed);
  turn.gyro = -0.2;
  EXPECT_EQ(checks_of_turn(turn)[3].verdict, kFailed);
  turn.gyro.reset();
  EXPECT_EQ(checks_of_turn(turn)[3].verdict, kNotPossible);
  EXPECT_THAT(checks_of_turn({0.2, -0.2, -0.2})[0].why, HasSubstr("turns the other way"));
  EXPECT_THAT(checks_of_turn({0.2, -0.02, -0.2})[0].why, HasSubstr("does not turn"));
}

TEST(Preflight, SignAndGainOfTheWay) {
  struct Case {
    const char* what;
    ShortMotion way;
    CheckVerdict wheels, pose;
  };
  for (const Case& c :
       {Case{"as commanded", {0.05, 0.05, 0.052}, kPassed, kPassed},
        Case{"backwards", {0.05, -0.05, -0.048}, kFailed, kFailed},
        Case{"wheels that say what they were told", {0.05, 0.05, -0.05}, kPassed, kFailed},
        Case{"stands", {0.05, 0.0, 0.001}, kFailed, kFailed},
        Case{"twice as far", {0.05, 0.1, 0.1}, kFailed, kFailed},
        Case{"slips", {0.05, 0.05, 0.04}, kPassed, kWarned},
        Case{"no number", {0.05, kNan, {}}, kFailed, kNotPossible},
        Case{"no way", {0.01, 0.01, 0.01}, kNotPossible, kNotPossible},
        Case{"no command", {kNan, 0.05, 0.05}, kNotPossible, kNotPossible}}) {
    const std::vector<CheckResult> results = checks_of_distance(c.way);
    EXPECT_THAT(names_of(results), ::testing::ElementsAre("way of the wheels", "way of the pose"));
    EXPECT_EQ(to_string(results[0].verdict), to_string(c.wheels)) << c.what << results[0].why;
    EXPECT_EQ(to_string(results[1].verdict), to_string(c.pose)) << c.what << results[1].why;
  }
  EXPECT_THAT(checks_of_distance({0.05, -0.05, {}})[0].why, HasSubstr("drives the other way"));
}

TEST(Preflight, TextHasColumns) {
  EXPECT_EQ(to_text({{"dead-man", kPassed, "0.5 s"}, {"largest speed", kNotPossible, "why"}}),
            "dead-man       passed        0.5 s\n"
            "largest speed  not possible  why\n");
}

TEST(Preflight, RefusesOptionsThatDoNotFit) {
  PreflightOptions options;
  options.tilt_fail = 0.001;
  try {
    checks_before_motion({}, options);
    FAIL() << "no error";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("tilt_fail: less than what is warned of"));
  }
}

}  // namespace
}  // namespace prospect::preflight_test
