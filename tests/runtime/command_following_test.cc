// SPDX-License-Identifier: Apache-2.0
#include "runtime/command_following.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "models/unicycle.h"

namespace prospect::command_following_test {
namespace {

constexpr double kPeriod = 0.05, kHold = 0.15;  // [s]

/// What is between a command and what is measured of it.
struct World {
  double delay = 0.0;                          // [s] that nobody has declared
  double linear_gain = 1.0, yaw_gain = 1.0;    // of the ground: slip
  double acceleration = 1e9, turning = 1e9;    // [m/s^2], [rad/s^2] of the base
  double wheel_noise = 0.0, pose_noise = 0.0;  // [m/s] and [m], standard deviations
  double pose_delay = 0.0;                     // [s]
  bool has_pose = true;
  bool by_poses = false;  // the base measures nothing: its velocity is made of the poses
  unsigned seed = 1;
  // Of time since the fault and the command: what the base makes of it.
  std::function<Twist(double, const Twist&)> fault{};
  double from = 1e9;  // [s]
  // What becomes of what is measured.
  std::function<void(double, Twist&)> wheels{};
  std::function<void(double, Pose&)> pose{};
  std::function<double(double)> stamp{};
  // A gyro at 100 Hz: its bias and noise [rad/s], and what becomes of what it measures.
  bool has_gyro = false;
  double gyro_bias = 0.02, gyro_noise = 0.01;
  std::function<void(double, ImuSample&)> gyro{};
};

/// What was noticed, and how far the robot had gone since the fault.
struct Noticed {
  Departure what;
  double after = 0.0, way = 0.0, turned = 0.0;  // [s], [m], [rad]
};

/// Tells a base commands each period, as `command` of the time says, for `length` [s].
std::optional<Noticed> drive(const World& w, double length,
                             const std::function<Twist(double)>& command,
                             const CommandFollowingOptions& options = {}) {
  std::mt19937 random(w.seed);
  std::normal_distribution<double> noise;
  CommandFollowing following(options);
  std::deque<std::pair<double, Twist>> sent;
  std::deque<Belief> seen;  // not known yet
  Belief newest;
  Twist velocity, made;
  Pose pose;
  double way = 0.0, turned = 0.0;
  bool has_seen = false;
  constexpr int kSteps = 10;
  std::mt19937 gyro_random(w.seed);
  std::vector<ImuSample> measured;
  for (int tick = 0; tick * kPeriod < length; ++tick) {
    const double now = tick * kPeriod;
    BaseReport report;
    report.connected = true;
    report.stamp = now;
    report.velocity = velocity;
    report.velocity_of_poses = w.by_poses;
    report.velocity.linear.x() += w.wheel_noise * noise(random);
    report.velocity.yaw_rate += 3.0 * w.wheel_noise * noise(random);
    if (w.wheels) w.wheels(now, report.velocity);
    Belief belief;
    belief.stamp = w.stamp ? w.stamp(now) : now;
    belief.pose = pose;
    belief.pose.position.x() += w.pose_noise * noise(random);
    belief.pose.position.y() += w.pose_noise * noise(random);
    belief.pose.yaw += w.pose_noise * noise(random);
    if (w.pose) w.pose(now, belief.pose);
    seen.push_back(belief);
    for (; !seen.empty() && seen.front().stamp <= now - w.pose_delay + 1e-9; seen.pop_front()) {
      newest = seen.front();
      has_seen = w.has_pose;
    }
    if (const auto found = following.look(now, report, has_seen ? &newest : nullptr, measured)) {
      return Noticed{*found, now - w.from, way, turned};
    }
    measured.clear();
    const Twist told = command(now);
    following.told({now, now + kHold, told, false});
    sent.emplace_back(now, told);
    for (int k = 0; k < kSteps; ++k) {
      const double t = now + k * kPeriod / kSteps, dt = kPeriod / kSteps;
      while (sent.size() > 1 && sent[1].first <= t - w.delay) sent.pop_front();
      Twist wanted = sent.front().first <= t - w.delay ? sent.front().second : Twist();
      if (w.fault && t >= w.from) wanted = w.fault(t - w.from, wanted);
      const auto ramp = [&](double from, double to, double rate) {
        return from + std::clamp(to - from, -rate * dt, rate * dt);
      };
      made.linear.x() = ramp(made.linear.x(), wanted.linear.x(), w.acceleration);
      made.yaw_rate = ramp(made.yaw_rate, wanted.yaw_rate, w.turning);
      velocity = made;
      const double v = w.linear_gain * made.linear.x(), r = w.yaw_gain * made.yaw_rate;
      pose.position.x() += v * dt * std::cos(pose.yaw);
      pose.position.y() += v * dt * std::sin(pose.yaw);
      pose.yaw += r * dt;
      if (w.has_gyro && k % 2 == 1) {
        ImuSample sample;
        sample.stamp = t + dt;
        sample.angular_velocity.z() = r + w.gyro_bias + w.gyro_noise * noise(gyro_random);
        sample.linear_acceleration = {0.0, 0.1 * noise(gyro_random), 9.8};
        if (w.gyro) w.gyro(sample.stamp, sample);
        measured.push_back(sample);
      }
      if (t >= w.from) way += std::abs(v) * dt, turned += std::abs(r) * dt;
    }
  }
  return std::nullopt;
}

/// Commands within the bounds and rates of the unicycle that seek another speed every so often.
class RandomDrive {
 public:
  explicit RandomDrive(unsigned seed, double least = 0.0) : random_(seed), least_(least) {}
  Twist operator()(double now) {
    const Unicycle::Parameters limits;
    std::uniform_real_distribution<double> share(0.0, 1.0);
    if (now >= until_) {
      until_ = now + 0.2 + 1.8 * share(random_);
      // Often at a limit, at times at rest.
      const auto pick = [&](double low, double high) {
        const double s = 1.6 * share(random_) - 0.3;
        return low + (high - low) * std::clamp(s, 0.0, 1.0);
      };
      wanted_ = {{pick(least_, limits.v_max), 0.0, 0.0}, pick(-limits.omega_max, limits.omega_max)};
    }
    const auto ramp = [](double from, double to, double most) {
      return from + std::clamp(to - from, -most, most);
    };
    told_.linear.x() = ramp(told_.linear.x(), wanted_.linear.x(), limits.a_max * kPeriod);
    told_.yaw_rate = ramp(told_.yaw_rate, wanted_.yaw_rate, limits.alpha_max * kPeriod);
    return told_;
  }

 private:
  std::mt19937 random_;
  double least_;
  double until_ = 0.0;
  Twist wanted_, told_;
};

/// At a speed and a yaw rate, from rest.
std::function<Twist(double)> steadily(double speed, double rate) {
  return [=](double now) {
    return Twist{{std::min(speed, 0.8 * now), 0.0, 0.0},
                 std::copysign(std::min(std::abs(rate), 2.5 * now), rate)};
  };
}

struct Verb {
  const char* name;
  int axis;
  std::function<Twist(double, const Twist&)> made;
};
const std::vector<Verb>& verbs() {
  static const std::vector<Verb> all = {
      {"inverted", 0,
       [](double, const Twist& t) {
         return Twist{-t.linear, t.yaw_rate};
       }},
      {"mirrored", 2,
       [](double, const Twist& t) {
         return Twist{t.linear, -t.yaw_rate};
       }},
      {"both", 0,
       [](double, const Twist& t) {
         return Twist{-t.linear, -t.yaw_rate};
       }},
      {"double", 0,
       [](double, const Twist& t) {
         return Twist{2.0 * t.linear, 2.0 * t.yaw_rate};
       }},
      {"ignores", 0, [](double, const Twist&) { return Twist(); }},
      {"faster", 0,
       [](double, const Twist& t) {
         return Twist{t.linear + Eigen::Vector3d(0.4, 0.0, 0.0), t.yaw_rate};
       }},
      {"left wheel dead", 2,
       [](double, const Twist& t) {
         const double right = t.linear.x() + 0.15 * t.yaw_rate;
         return Twist{{0.5 * right, 0.0, 0.0}, right / 0.3};
       }},
      {"right wheel dead", 2,
       [](double, const Twist& t) {
         const double left = t.linear.x() - 0.15 * t.yaw_rate;
         return Twist{{0.5 * left, 0.0, 0.0}, -left / 0.3};
       }},
  };
  return all;
}

TEST(CommandFollowing, EachWayNotToFollowIsNoticedWithinASecondOrThirtyCentimetres) {
  for (const Verb& verb : verbs()) {
    for (const double speed : {0.2, 0.6}) {
      for (const double pose_delay : {0.0, 0.2}) {
        for (const bool has_pose : {true, false}) {
          World w;
          w.fault = verb.made;
          w.from = 2.0;
          w.pose_delay = pose_delay;
          w.has_pose = has_pose;
          w.wheel_noise = 0.02;
          w.pose_noise = 0.002;
          const std::string name = std::string(verb.name) + " at " + std::to_string(speed) +
                                   ", pose late by " + std::to_string(pose_delay) +
                                   (has_pose ? "" : ", none");
          const auto found = drive(w, 8.0, steadily(speed, 0.5));
          ASSERT_TRUE(found) << name;
          EXPECT_GE(found->after, 0.0) << name;
          EXPECT_TRUE(found->after <= 1.0 || found->way <= 0.3)
              << name << ": " << found->after << " s, " << found->way << " m";
          EXPECT_EQ(found->what.witness, has_pose ? "wheels and pose" : "wheels") << name;
        }
      }
    }
  }
}

// Who measures nothing but where it is has one witness, and no other that could deny it.
TEST(CommandFollowing, ByPosesAloneEachWayNotToFollowIsNoticedWithinASecondOrThirtyCentimetres) {
  for (const Verb& verb : verbs()) {
    for (const double speed : {0.2, 0.6}) {
      for (unsigned seed = 1; seed <= 5; ++seed) {
        World w;
        w.seed = seed;
        w.fault = verb.made;
        w.from = 2.0;
        w.by_poses = true;
        w.pose_noise = 0.003;
        const auto found = drive(w, 8.0, steadily(speed, 0.5));
        ASSERT_TRUE(found) << verb.name;
        EXPECT_GE(found->after, 0.0) << verb.name;
        EXPECT_TRUE(found->after <= 1.0 || found->way <= 0.3)
            << verb.name << ": " << found->after << " s, " << found->way << " m";
        EXPECT_EQ(found->what.witness, "pose") << verb.name;
      }
    }
  }
}

// Who holds a heading tells small turns, until they are made the other way.
TEST(CommandFollowing, AMirroredBaseThatIsToldToDriveStraightIsNoticedBeforeItGoesAstray) {
  for (const double gain : {1.0, 2.0, 4.0}) {  // [1/s]
    for (unsigned seed = 1; seed <= 10; ++seed) {
      World w;
      w.by_poses = seed % 2 == 0;
      w.seed = seed;
      w.fault = verbs()[1].made;
      w.from = 2.0;
      w.wheel_noise = 0.01;
      w.pose_noise = 0.002;
      Pose seen;
      w.pose = [&](double, Pose& p) { seen = p; };
      const auto found = drive(w, 30.0, [&](double now) {
        const double wanted = now < 1.0 ? 0.0 : 0.02;
        return Twist{{std::min(0.6, 0.8 * now), 0.0, 0.0},
                     std::clamp(gain * (wanted - seen.yaw), -1.0, 1.0)};
      });
      ASSERT_TRUE(found) << gain << ", seed " << seed;
      EXPECT_EQ(found->what.axis, 2);
      EXPECT_LT(found->turned, 0.25) << gain << ", seed " << seed;
    }
  }
}

// A heading that is held against what pulls at it: what is told and what is made are against each
// other until nothing is left of it.
TEST(CommandFollowing, WhoHoldsAHeadingAgainstWhatPullsIsNotBlamed) {
  for (const double pull : {0.02, -0.04, 0.08}) {  // [rad/m]
    for (const double gain : {1.0, 3.0}) {         // [1/s]
      for (const bool by_poses : {false, true}) {
        for (unsigned seed = 1; seed <= 10; ++seed) {
          World w;
          w.seed = seed;
          w.by_poses = by_poses;
          w.wheel_noise = 0.01, w.pose_noise = 0.002, w.delay = 0.1, w.yaw_gain = 0.87;
          w.from = 10.0;
          // From there on, and in turn the other way.
          w.fault = [=](double since, const Twist& t) {
            const double side = std::fmod(since, 20.0) < 10.0 ? 1.0 : -1.0;
            return Twist{t.linear, t.yaw_rate + side * pull * t.linear.x()};
          };
          Pose seen;
          w.pose = [&](double, Pose& p) { seen = p; };
          const auto found = drive(w, 60.0, [&](double now) {
            return Twist{{std::min(0.6, 0.8 * now), 0.0, 0.0},
                         std::clamp(-gain * seen.yaw, -1.0, 1.0)};
          });
          ASSERT_FALSE(found) << pull << ", " << gain << ", seed " << seed << ": "
                              << to_text(found->what);
        }
      }
    }
  }
}

TEST(CommandFollowing, SaysWhichAxisAndByHowMuch) {
  for (const Verb& verb : verbs()) {
    World w;
    w.fault = verb.made;
    w.from = 2.0;
    const auto found = drive(w, 8.0, steadily(0.6, 0.0));
    if (std::string(verb.name) == "mirrored") {
      EXPECT_FALSE(found) << "it was told no turn";
      continue;
    }
    ASSERT_TRUE(found) << verb.name;
    EXPECT_EQ(found->what.axis, verb.axis) << verb.name;
  }
  World w;
  w.fault = verbs()[0].made;
  w.from = 2.0;
  EXPECT_EQ(to_text(drive(w, 8.0, steadily(0.6, 0.0))->what),
            "forward -0.60 of +0.60 m/s told: -0.10 m, by wheels and pose");
  w.fault = verbs()[1].made;
  EXPECT_EQ(drive(w, 8.0, steadily(0.3, -0.8))->what.axis, 2);
  EXPECT_GT(drive(w, 8.0, steadily(0.3, -0.8))->what.by, 0.0);
}

TEST(CommandFollowing, ABaseThatDrivesOnWhenItIsToldToStop) {
  World w;
  w.fault = [](double, const Twist&) { return Twist{{0.6, 0.0, 0.0}, 0.0}; };
  w.from = 2.0;
  const auto found = drive(w, 8.0, [](double now) {
    return Twist{{std::clamp(0.6 - 0.8 * (now - 2.0), 0.0, 0.6), 0.0, 0.0}, 0.0};
  });
  ASSERT_TRUE(found);
  EXPECT_LE(found->after, 1.0);
}

// Another speed than the one it has held is none that slip explains, though it is within slip.
TEST(CommandFollowing, ABaseThatHeldItsSpeedAndRunsOnAtAnother) {
  for (const double gain : {1.0, 0.9}) {
    for (const bool has_pose : {true, false}) {
      World w;
      w.acceleration = 2.0;
      w.wheel_noise = 0.02, w.pose_noise = 0.002, w.pose_delay = 0.1;
      w.has_pose = has_pose;
      w.from = -1.0;
      const double begins = 8.0;
      w.fault = [=](double since, const Twist& told) {
        const double speed = since + w.from < begins ? told.linear.x() : 0.4;
        return Twist{{gain * speed, 0.0, 0.0}, 0.0};
      };
      const auto found = drive(w, 20.0, steadily(0.6, 0.0));
      ASSERT_TRUE(found) << gain;
      const double after = found->after + w.from - begins;
      EXPECT_GE(after, 0.0) << gain;
      EXPECT_LE(after, 1.0) << gain;
      EXPECT_LT(found->what.by, 0.0);
    }
  }
  // Faster than it is told, while it is told to stop.
  World braked;
  braked.fault = [](double, const Twist& told) {
    return Twist{told.linear + Eigen::Vector3d(0.4, 0.0, 0.0), told.yaw_rate};
  };
  braked.from = 6.0;
  braked.acceleration = 2.0;
  const auto found = drive(braked, 20.0, [](double now) {
    return Twist{{std::clamp(0.6 - 0.8 * (now - 6.3), 0.0, std::min(0.6, 0.8 * now)), 0.0, 0.0},
                 0.0};
  });
  ASSERT_TRUE(found);
  EXPECT_LE(found->after, 0.75);
  // In its first half metre nobody knows what is slip.
  World w;
  w.fault = [](double, const Twist&) { return Twist{{0.45, 0.0, 0.0}, 0.0}; };
  w.from = 1.0;
  EXPECT_FALSE(drive(w, 20.0, steadily(0.6, 0.0)));
}

// Nothing of the speed told away from a side is slip to that side.
TEST(CommandFollowing, WhoRunsTheOtherWaySlowlyIsNotOneWhoSlips) {
  World w;
  w.fault = [](double, const Twist&) { return Twist{{-0.12, 0.0, 0.0}, 0.0}; };
  w.from = 0.0;
  const auto found = drive(w, 8.0, steadily(0.4, 0.0));
  ASSERT_TRUE(found);
  EXPECT_LE(found->way, 0.12);
}

TEST(CommandFollowing, SlowlyBackwardsWithoutAJump) {
  // The gain falls from 1 to -1 over 6 s.
  World w;
  w.from = 2.0;
  w.fault = [](double since, const Twist& t) {
    return Twist{std::max(-1.0, 1.0 - since / 3.0) * t.linear, t.yaw_rate};
  };
  const auto found = drive(w, 12.0, steadily(0.4, 0.0));
  ASSERT_TRUE(found);
  EXPECT_LT(found->after, 3.6) << "as it begins to go backwards, at the latest";
}

// A base whose odometry is what it was told: only the pose knows.
TEST(CommandFollowing, WheelsThatSayWhatTheyWereToldAreContradictedByThePose) {
  for (const Verb& verb : verbs()) {
    if (std::string(verb.name) == "ignores") continue;
    Twist told;
    World w;
    w.fault = verb.made;
    w.from = 2.0;
    w.wheels = [&](double, Twist& measured) { measured = told; };
    const auto found = drive(w, 8.0, [&](double now) { return told = steadily(0.6, 0.5)(now); });
    ASSERT_TRUE(found) << verb.name;
    EXPECT_EQ(found->what.witness, "pose") << verb.name;
    EXPECT_LE(found->after, 2.0) << verb.name << ": one witness alone takes longer";
  }
}

TEST(CommandFollowing, LegalDrivesAreNotBlamed) {
  struct Case {
    const char* name;
    World world;
  };
  const auto with = [](const std::function<void(World&)>& set) {
    World w;
    set(w);
    return w;
  };
  const std::vector<Case> cases = {
      {"exact", {}},
      {"late", with([](World& w) { w.delay = 0.25; })},
      {"late, and the pose later", with([](World& w) { w.delay = 0.15, w.pose_delay = 0.4; })},
      {"noise", with([](World& w) { w.wheel_noise = 0.05, w.pose_noise = 0.005; })},
      {"slips as much as a pre-flight check lets through",
       with([](World& w) { w.linear_gain = 0.8, w.yaw_gain = 0.75; })},
      {"is not where it looks to",
       with([](World& w) { w.pose = [](double, Pose& p) { p.yaw += 0.15; }; })},
      {"turns more than it is told", with([](World& w) { w.yaw_gain = 1.2; })},
      {"ramps of its own", with([](World& w) { w.acceleration = 0.8, w.turning = 2.5; })},
      {"slow ramps, late, slip, noise", with([](World& w) {
         w.acceleration = 1.0, w.turning = 3.0, w.delay = 0.15, w.yaw_gain = 0.87;
         w.wheel_noise = 0.03, w.pose_noise = 0.003, w.pose_delay = 0.1;
       })},
      {"makes less of each command", with([](World& w) {
         w.from = 0.0, w.fault = [](double, const Twist& t) {
           return Twist{0.75 * t.linear, 0.75 * t.yaw_rate};
         };
       })},
      {"its battery falls", with([](World& w) {
         w.from = 0.0, w.wheel_noise = 0.02;
         w.fault = [](double since, const Twist& t) {
           const double gain = 1.0 - 0.25 * since / 40.0;
           return Twist{gain * t.linear, gain * t.yaw_rate};
         };
       })},
      {"goes up and down", with([](World& w) {
         w.from = 0.0, w.wheel_noise = 0.02, w.pose_noise = 0.002;
         w.fault = [](double since, const Twist& t) {
           const double gain = std::fmod(since, 6.0) < 3.0 ? 0.92 : 1.0;
           return Twist{gain * t.linear, gain * t.yaw_rate};
         };
       })},
      {"without a pose", with([](World& w) { w.has_pose = false, w.delay = 0.2; })},
      {"by poses alone, slip, late", with([](World& w) {
         w.by_poses = true, w.pose_noise = 0.003, w.delay = 0.15, w.yaw_gain = 0.87;
         w.acceleration = 1.0, w.turning = 3.0;
       })},
      {"by noisy poses alone", with([](World& w) { w.by_poses = true, w.pose_noise = 0.01; })},
      {"pulls to one side, by poses alone", with([](World& w) {
         w.by_poses = true, w.pose_noise = 0.003, w.from = 0.0;
         w.fault = [](double, const Twist& t) {
           return Twist{t.linear, t.yaw_rate + 0.08 * t.linear.x()};
         };
       })},
  };
  for (const Case& c : cases) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
      World w = c.world;
      w.seed = seed;
      RandomDrive commands(100 + seed);
      const auto found = drive(w, 40.0, [&](double now) { return commands(now); });
      ASSERT_FALSE(found) << c.name << ", seed " << seed << ": " << to_text(found->what);
    }
  }
}

/// A second of standing, in which a gyro learns its bias, before a drive.
std::function<Twist(double)> after_standing(std::function<Twist(double)> drive) {
  return [drive = std::move(drive)](double now) { return now < 1.0 ? Twist() : drive(now - 1.0); };
}

/// Wheels that say what they were told, and no pose.
struct BlindDrive {
  explicit BlindDrive(const std::function<Twist(double, const Twist&)>& fault) {
    world.fault = fault;
    world.from = 4.0;
    world.has_pose = false;
    world.has_gyro = true;
    world.wheels = [this](double, Twist& measured) { measured = told; };
  }
  std::optional<Noticed> drive_on(double speed, double rate) {
    const auto command = after_standing(steadily(speed, rate));
    return drive(world, 10.0, [&](double now) { return told = command(now); });
  }
  World world;
  Twist told;
};

TEST(CommandFollowing, TheGyroAloneNamesATurnThatIsNotTheOneThatWasTold) {
  const std::vector<std::pair<const char*, std::function<Twist(double, const Twist&)>>> turns = {
      {"mirrored",
       [](double, const Twist& t) {
         return Twist{t.linear, -t.yaw_rate};
       }},
      {"ignores turns",
       [](double, const Twist& t) {
         return Twist{t.linear, 0.0};
       }},
      {"turns twice as fast",
       [](double, const Twist& t) {
         return Twist{t.linear, 2.0 * t.yaw_rate};
       }},
      {"runs away in yaw",
       [](double, const Twist& t) {
         return Twist{t.linear, t.yaw_rate + 0.6};
       }},
      {"left wheel dead", verbs()[6].made},
      {"right wheel dead", verbs()[7].made},
  };
  for (const auto& [name, fault] : turns) {
    for (const double rate : {0.5, -0.8}) {
      for (unsigned seed = 1; seed <= 5; ++seed) {
        BlindDrive blind(fault);
        blind.world.seed = seed;
        const auto found = blind.drive_on(0.4, rate);
        ASSERT_TRUE(found) << name << " at " << rate;
        EXPECT_GE(found->after, 0.0) << name;
        EXPECT_LE(found->after, 1.0) << name << " at " << rate;
        EXPECT_EQ(found->what.witness, "gyro") << name;
        EXPECT_EQ(found->what.axis, 2) << name;
      }
    }
  }
  // On a straight way, too, where it is told no turn.
  for (const std::size_t verb : {6u, 7u}) {
    const auto found = BlindDrive(verbs()[verb].made).drive_on(0.4, 0.0);
    ASSERT_TRUE(found);
    EXPECT_LE(found->after, 1.0);
  }
}

TEST(CommandFollowing, AGyroThatIsOffAndNoisyAccusesNobody) {
  for (const double bias : {0.02, -0.02, 0.08}) {
    for (const bool has_pose : {true, false}) {
      for (unsigned seed = 1; seed <= 10; ++seed) {
        World w;
        w.seed = seed;
        w.has_pose = has_pose;
        w.has_gyro = true;
        w.gyro_bias = bias;
        w.acceleration = 1.0, w.turning = 3.0, w.delay = 0.15, w.yaw_gain = 0.87;
        w.wheel_noise = 0.03, w.pose_noise = 0.003;
        RandomDrive commands(200 + seed);
        // Half of it straight on, where a bias adds up.
        const auto found =
            drive(w, 120.0, after_standing([&](double now) {
                    const Twist told = commands(now);
                    return now < 60.0 ? told : Twist{{std::min(0.5, now - 60.0), 0.0, 0.0}, 0.0};
                  }));
        ASSERT_FALSE(found) << bias << ", seed " << seed << ": " << to_text(found->what);
      }
    }
  }
  // What it has not learned is not held against anybody.
  World never;
  never.has_pose = false, never.has_gyro = true, never.gyro_bias = 0.08;
  EXPECT_FALSE(drive(never, 60.0, steadily(0.5, 0.0)));
}

TEST(CommandFollowing, AGyroThatIsAtFaultDecidesNothing) {
  const auto on = after_standing(steadily(0.4, 0.4));
  const std::vector<std::pair<const char*, std::function<void(double, ImuSample&)>>> faults = {
      {"one in a second is none",
       [](double now, ImuSample& s) {
         if (std::fmod(now + 1e-9, 1.0) < 0.01) s.angular_velocity.z() = std::nan("");
       }},
      {"one in a second is anything",
       [](double now, ImuSample& s) {
         if (std::fmod(now + 1e-9, 1.0) < 0.01) s.angular_velocity.z() = -30.0;
       }},
      {"none are numbers",
       [](double now, ImuSample& s) {
         if (now > 4.0) s.angular_velocity.setConstant(std::nan(""));
       }},
      {"it hangs", [last = ImuSample()](double now, ImuSample& s) mutable {
         if (now <= 2.0) last = s;
         s.angular_velocity = last.angular_velocity;
         s.linear_acceleration = last.linear_acceleration;
       }}};
  for (const auto& [name, fault] : faults) {
    World w;
    w.has_pose = false, w.has_gyro = true, w.gyro = fault;
    const auto found = drive(w, 20.0, on);
    EXPECT_FALSE(found) << name << ": " << to_text(found->what);
  }
  // In a frame that nobody has told of: the wheels and the pose outvote it.
  World upside_down;
  upside_down.has_gyro = true;
  upside_down.gyro = [](double, ImuSample& s) { s.angular_velocity *= -1.0; };
  EXPECT_FALSE(drive(upside_down, 20.0, on));
}

TEST(CommandFollowing, TheGyroContradictsWheelsAndPosesThatLie) {
  const auto on = after_standing(steadily(0.4, 0.5));
  World lies;
  lies.has_pose = false;
  lies.wheels = [](double now, Twist& m) {
    if (now > 4.0) m.yaw_rate *= -1.0;
  };
  EXPECT_TRUE(drive(lies, 10.0, on)) << "nobody denies it";
  lies.has_gyro = true;
  EXPECT_FALSE(drive(lies, 10.0, on));
  World wanders;
  wanders.pose = [](double now, Pose& p) { p.yaw += 0.5 * std::max(0.0, now - 4.0); };
  const auto on_the_spot = after_standing(steadily(0.0, 0.5));
  EXPECT_TRUE(drive(wanders, 10.0, on_the_spot)) << "nobody denies it";
  wanders.has_gyro = true;
  EXPECT_FALSE(drive(wanders, 10.0, on_the_spot));
  // A body that touches something while its wheels turn is not a base that does not follow: where
  // the pose knows it, too, the robot knows where it looks to.
  World touches;
  touches.has_gyro = true;
  touches.from = 4.0;
  touches.fault = [](double, const Twist& t) { return Twist{t.linear, 0.0}; };
  Twist told;
  touches.wheels = [&](double, Twist& measured) { measured = told; };
  EXPECT_FALSE(drive(touches, 10.0, [&](double now) { return told = on(now); }));
  // Together they say so sooner than the pose alone.
  World both;
  both.has_gyro = true;
  both.from = 4.0;
  both.fault = verbs()[1].made;
  both.wheels = [&](double, Twist& measured) { measured = told; };
  const auto found = drive(both, 10.0, [&](double now) { return told = on(now); });
  ASSERT_TRUE(found);
  EXPECT_EQ(found->what.witness, "pose and gyro");
  EXPECT_LE(found->after, 0.5);
}

TEST(CommandFollowing, OneBadSampleDecidesNothing) {
  for (const double size : {3.0, -3.0, std::numeric_limits<double>::infinity(),
                            std::numeric_limits<double>::quiet_NaN()}) {
    World w;
    w.has_pose = false;
    w.wheels = [&](double now, Twist& m) {
      if (std::fmod(now + 1e-9, 1.0) < kPeriod) m.linear.x() = size, m.yaw_rate = -size;
    };
    EXPECT_FALSE(drive(w, 20.0, steadily(0.5, 0.3))) << size;
    World jumps;
    jumps.pose = [&](double now, Pose& p) {
      const double turn = 0.3 * std::floor(now / 5.0);  // found again elsewhere
      p.position = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) * p.position;
      p.position.x() += 0.5 * std::floor(now / 3.0);
      p.yaw += turn;
      if (std::fmod(now + 1e-9, 1.0) < kPeriod) p.position.y() += size;  // and an outlier
    };
    EXPECT_FALSE(drive(jumps, 20.0, steadily(0.5, 0.3))) << size;
  }
}

TEST(CommandFollowing, FaultsOfTheSensorsAreNotThoseOfTheBase) {
  World lies;
  lies.wheels = [](double, Twist& m) { m.linear *= 2.0, m.yaw_rate *= 2.0; };
  EXPECT_FALSE(drive(lies, 10.0, steadily(0.6, 0.5))) << "the pose denies it";
  lies.has_pose = false;
  EXPECT_TRUE(drive(lies, 10.0, steadily(0.6, 0.5))) << "nobody denies it";
  World holes;
  holes.wheels = [](double now, Twist& m) {
    if (std::fmod(now, 1.0) < 0.5) m = {};
  };
  EXPECT_FALSE(drive(holes, 10.0, steadily(0.6, 0.5)));
  // Stamps that stay while the pose goes on.
  World stuck;
  stuck.stamp = [](double now) { return std::min(now, 3.0 + 1e-4 * now); };
  EXPECT_FALSE(drive(stuck, 10.0, steadily(0.6, 0.5)));
  // A picture that stands still, wheels that spin, a wall: the base does what it is told.
  World still;
  still.pose = [](double now, Pose& p) {
    if (now > 2.0) p = Pose();
  };
  EXPECT_FALSE(drive(still, 10.0, steadily(0.6, 0.0)));
  // But it confirms what the wheels say.
  still.fault = verbs()[0].made;
  still.from = 3.0;
  ASSERT_TRUE(drive(still, 10.0, steadily(0.6, 0.0)));
}

TEST(CommandFollowing, ACommandThatHasExpiredMayActOrNot) {
  for (const bool holds : {false, true}) {
    CommandFollowing following;
    BaseReport base;
    base.connected = true;
    base.velocity.linear.x() = 0.6;
    double now = 0.0;
    const auto look = [&] {
      base.stamp = now;
      return following.look(now, base, nullptr);
    };
    for (; now < 1.0; now += kPeriod) {
      EXPECT_FALSE(look());
      following.told({now, now + kHold, {{0.6, 0.0, 0.0}, 0.0}, false});
    }
    // The command thread sleeps.
    for (; now < 3.0; now += kPeriod) {
      if (!holds && now > 1.2) base.velocity = {};
      EXPECT_FALSE(look()) << now;
    }
  }
  // Base::stop() brakes as hard as the base can.
  CommandFollowing following;
  BaseReport base;
  base.connected = true;
  base.velocity.linear.x() = 1.5;
  for (int k = 0; k < 80; ++k) {
    base.stamp = kPeriod * k;
    if (k == 40) base.velocity = {};
    EXPECT_FALSE(following.look(base.stamp, base, nullptr)) << k;
    const double told = k < 40 ? 1.5 : std::max(0.0, 1.5 - 0.02 * (k - 40));
    following.told({base.stamp, base.stamp + kHold, {{told, 0.0, 0.0}, 0.0}, k >= 40});
  }
}

// Each axis has its own delay; what is declared is no fault, also before the first command acts.
TEST(CommandFollowing, ADeclaredDelayIsThatOfItsAxis) {
  for (const int late : {0, 2}) {
    for (const bool declared : {true, false}) {
      CommandFollowing following({}, {.linear = declared && late == 0 ? 1.2 : 0.0,
                                      .angular = declared && late == 2 ? 1.2 : 0.0});
      bool found = false;
      for (double now = 0.0; now < 3.0; now += kPeriod) {
        BaseReport base;
        base.connected = true;
        base.stamp = now;
        if (now > (late == 0 ? 1.2 : 0.0)) base.velocity.linear.x() = 0.6;
        if (now > (late == 2 ? 1.2 : 0.0)) base.velocity.yaw_rate = 0.8;
        const auto departure = following.look(now, base, nullptr);
        if (departure) {
          EXPECT_EQ(departure->axis, late);
        }
        found = found || departure;
        following.told({now, now + kHold, {{0.6, 0.0, 0.0}, 0.8}, false});
      }
      EXPECT_EQ(found, !declared) << late;
    }
  }
}

/// Base and wheels without a pose: told and measured velocities by time, until it is noticed.
std::optional<double> noticed_at(double length, const std::function<Twist(double)>& told,
                                 const std::function<Twist(double)>& measured,
                                 const CommandFollowingOptions& options = {}) {
  CommandFollowing following(options);
  for (double now = 0.0; now < length; now += kPeriod) {
    BaseReport base;
    base.connected = true;
    base.stamp = now;
    base.velocity = measured(now);
    if (following.look(now, base, nullptr)) return now;
    following.told({now, now + kHold, told(now), false});
  }
  return std::nullopt;
}

TEST(CommandFollowing, WhatCountsOfEachAxisIsItsOwn) {
  const auto rest = [](double) { return Twist(); };
  const auto creeps = [](double) { return Twist{{0.15, 0.0, 0.0}, 0.0}; };
  const auto turns = [](double) { return Twist{{0.0, 0.0, 0.0}, 0.15}; };
  CommandFollowingOptions speed, rate;
  speed.least_speed = 0.2;
  rate.least_rate = 0.2;
  EXPECT_FALSE(noticed_at(10.0, rest, creeps, speed));
  EXPECT_TRUE(noticed_at(10.0, rest, creeps, rate));
  EXPECT_FALSE(noticed_at(10.0, rest, turns, rate));
  EXPECT_TRUE(noticed_at(10.0, rest, turns, speed));
}

// The sums of the header, by hand.
TEST(CommandFollowing, TakesItsTimeByItsFormula) {
  const auto rest = [](double) { return Twist(); };
  // Told nothing, weight 1: 0.17 m/s count of 0.2, for 0.1 m.
  EXPECT_NEAR(*noticed_at(9.0, rest,
                          [](double) {
                            return Twist{{0.2, 0.0, 0.0}, 0.0};
                          }),
              0.6, 0.06);
  // Told to go and to stand in turn, the largest is what slips.
  const auto in_turn = [](double now) {
    return Twist{{std::fmod(now, 0.4) < 0.2 ? 0.6 : 0.0, 0.0, 0.0}, 0.0};
  };
  const auto faster = [](double) { return Twist{{0.7, 0.0, 0.0}, 0.0}; };
  EXPECT_FALSE(
      noticed_at(10.0, in_turn, [&](double now) { return now < 0.2 ? Twist() : faster(now); }));
}

TEST(CommandFollowing, WhatWasWrongIsOverSoonAfterItHasEnded) {
  CommandFollowing following;
  bool still = false;
  for (double now = 0.0; now < 12.0; now += kPeriod) {
    BaseReport base;
    base.connected = true;
    base.stamp = now;
    base.velocity.linear.x() = now > 2.0 && now < 8.0 ? -0.6 : 0.6;
    const bool departs = following.look(now, base, nullptr).has_value();
    if (now > 3.0 && now < 8.0) {
      EXPECT_TRUE(departs) << now;
    }
    still = departs;
    following.told({now, now + kHold, {{0.6, 0.0, 0.0}, 0.0}, false});
  }
  EXPECT_FALSE(still);
}

// A number that is none, a link that is down, and reports that come twice or late say nothing, and
// hide nothing.
TEST(CommandFollowing, AReportThatSaysNothingHidesNothing) {
  CommandFollowing following;
  double noticed = 0.0;
  for (double now = 0.0; now < 6.0 && noticed == 0.0; now += kPeriod) {
    BaseReport base;
    base.connected = true;
    base.stamp = now;
    base.velocity.linear.x() = now > 3.0 ? -0.6 : 0.6;
    BaseReport none = base, before = base;
    none.velocity.linear.x() = std::numeric_limits<double>::quiet_NaN();
    before.stamp -= kPeriod;
    if (std::abs(now - 1.0) < 1e-6 && following.look(now, none, nullptr)) noticed = now;
    if (following.look(now, base, nullptr)) noticed = now;
    if (following.look(now, before, nullptr)) noticed = now;
    following.told({now, now + kHold, {{0.6, 0.0, 0.0}, 0.0}, false});
  }
  EXPECT_NEAR(noticed, 3.3, 0.25);
  CommandFollowing without;
  for (double now = 0.0; now < 3.0; now += kPeriod) {
    BaseReport base;
    base.stamp = now;
    base.velocity.linear.x() = 5.0;
    EXPECT_FALSE(without.look(now, base, nullptr));
    without.told({now, now + kHold, {}, false});
  }
}

// A turn is held against the limit of turns, the way against those of ways.
TEST(CommandFollowing, EachLimitIsThatOfItsAxis) {
  World mirrored;
  mirrored.fault = verbs()[1].made;
  mirrored.from = 2.0;
  EXPECT_TRUE(drive(mirrored, 4.0, steadily(0.2, 0.5)));
  EXPECT_TRUE(drive(mirrored, 4.0, steadily(0.2, 0.5), {.more_distance = 10, .less_distance = 10}));
  EXPECT_FALSE(drive(mirrored, 4.0, steadily(0.2, 0.5), {.turn = 3.0}));
  World backwards;
  backwards.fault = verbs()[0].made;
  backwards.from = 2.0;
  EXPECT_TRUE(drive(backwards, 4.0, steadily(0.4, 0.0), {.turn = 3.0}));
  EXPECT_FALSE(
      drive(backwards, 4.0, steadily(0.4, 0.0), {.more_distance = 10, .less_distance = 10}));
}

// Of the time between two reports that are far apart nothing is known.
TEST(CommandFollowing, AReportAfterAGapDecidesNothing) {
  CommandFollowing following;
  BaseReport base;
  base.connected = true;
  for (double now = 0.0; now < 6.0; now += kPeriod) {
    if (now < 3.0 || now > 5.0) base.stamp = now;
    base.velocity.linear.x() = now > 5.0 && now < 5.0 + 1.5 * kPeriod ? -0.6 : 0.6;
    EXPECT_FALSE(following.look(now, base, nullptr)) << now;
    following.told({now, now + kHold, {{0.6, 0.0, 0.0}, 0.0}, false});
  }
}

// Poses that come seldom: a turn of more than 0.3 rad between two is no turn the other way; looked
// at twice, stamps that hardly grow are still those of a clock that is stuck.
TEST(CommandFollowing, PosesThatComeSeldom) {
  World seldom;
  seldom.stamp = [](double now) { return 0.25 * std::floor(now / 0.25 + 1e-6); };
  EXPECT_FALSE(drive(seldom, 10.0, steadily(0.3, 1.5)));
  World slow;
  slow.stamp = [](double now) { return 0.025 * std::floor(now / 0.2 + 1e-6); };
  EXPECT_FALSE(drive(slow, 10.0, steadily(0.6, 0.0)));
}

TEST(CommandFollowing, OptionsOutOfRangeAreRefused) {
  CommandFollowingOptions options;
  options.slip = -0.1;
  EXPECT_THROW(CommandFollowing{options}, std::invalid_argument);
}

}  // namespace
}  // namespace prospect::command_following_test
