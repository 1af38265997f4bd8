// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "adapters/missions/run/run_record.h"
#include "adapters/missions/run/summary.h"

namespace prospect {

inline constexpr int kPictureEvery = 3;
inline constexpr int kCostToGoEvery = 10;

/// The record of a drive along fixed waypoints through eight rooms and a corridor (24 m x 16 m),
/// for tests of what is made of records: a map seen by rays, landmarks on the walls, an estimate
/// that drifts, a planner that is now and then late; modes, targets, candidates and a cost-to-go
/// that go with the drive. No planner is involved. Deterministic.
inline RunRecord synthetic_run(int steps) {
  constexpr double kResolution = 0.1, kStep = 0.5, kSpeed = 0.5, kRange = 4.0, kFov = 1.2;
  constexpr int kWidth = 240, kHeight = 160;
  const auto wall = [](double x, double y) {
    if (x < 0.2 || y < 0.2 || x > 23.8 || y > 15.8) return true;
    const double in_room = std::fmod(x, 6.0);
    const bool door = std::abs(in_room - 3.0) < 0.6;
    if ((std::abs(y - 7.0) < 0.1 || std::abs(y - 9.0) < 0.1) && !door) return true;
    if ((y < 7.0 || y > 9.0) && (in_room < 0.1 || in_room > 5.9)) return true;
    const double u = in_room - 4.6, v = (y < 8.0 ? y : 16.0 - y) - 2.6;  // a table in each room
    return std::abs(u) < 0.5 && std::abs(v) < 0.8;
  };

  // Out of the corridor into each room and around its table.
  std::vector<Eigen::Vector2d> way = {{1.2, 8.0}};
  for (const int room : {0, 4, 5, 1, 2, 6, 7, 3}) {
    const double x0 = 6.0 * (room % 4);
    const auto at = [&](double x, double y) { way.emplace_back(x0 + x, room < 4 ? y : 16.0 - y); };
    at(3.0, 8.0);
    at(3.0, 5.5);
    at(1.6, 4.0);
    at(1.6, 1.3);
    at(3.2, 0.9);
    at(3.2, 4.2);
    at(4.6, 4.6);
    at(3.0, 5.5);
    at(3.0, 8.0);
  }

  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector2d> landmarks;
  std::uniform_real_distribution<double> along_x(0.0, 24.0), along_y(0.0, 16.0);
  while (landmarks.size() < 500) {
    const Eigen::Vector2d p(along_x(generator), along_y(generator));
    const bool surface =
        wall(p.x(), p.y()) && (!wall(p.x() + 0.15, p.y()) || !wall(p.x() - 0.15, p.y()) ||
                               !wall(p.x(), p.y() + 0.15) || !wall(p.x(), p.y() - 0.15));
    if (surface) landmarks.push_back(p);
  }

  RunRecord run;
  run.resolution = kResolution;
  run.robot_radius = 0.2;
  run.sensor_range = kRange;
  run.sensor_fov = kFov;
  run.configuration =
      "robot:\n  model: unicycle\n  v_max: 0.5  # forward speed [m/s]\nplanner:\n"
      "  N: 20  # knots of the horizon\n  dt: 0.25  # step [s]\n"
      "  w_o: 4.0  # weight of the exploration gain [1/m^2]; default 1\n"
      "solver: nlopt:LD_SLSQP\nmission:\n  time_limit: 600  # [s]\n";

  std::vector<CellState> known(kWidth * kHeight, CellState::kUnknown);
  Eigen::Vector2d p = way[0];
  double yaw = 0.0, driven = 0.0;
  Eigen::Vector2d drift = Eigen::Vector2d::Zero();
  std::size_t next = 1;
  std::optional<ModeKind> mode;
  std::optional<Cause> cause;
  double mode_since = 0.0;
  const int reachable = 31000;
  int seen = 0;
  for (int k = 0; k < steps; ++k) {
    StepRecord s;
    s.step = k;
    s.time = kStep * k;
    s.true_pose = {{p.x(), p.y(), 0.0}, yaw};
    s.estimated_pose = {{p.x() + drift.x(), p.y() + drift.y(), 0.0}, yaw + 0.2 * drift.x()};
    const Eigen::Vector2d estimate = s.estimated_pose.position.head<2>();

    // Rays from the true pose, drawn where the robot believes to be.
    const auto mark = [&](const Eigen::Vector2d& at, CellState state) {
      const Eigen::Vector2d q = at + drift;
      const Cell c{static_cast<int>(std::floor(q.x() / kResolution)),
                   static_cast<int>(std::floor(q.y() / kResolution))};
      if (c.i < 0 || c.j < 0 || c.i >= kWidth || c.j >= kHeight) return;
      CellState& cell = known[static_cast<std::size_t>(c.j * kWidth + c.i)];
      if (cell == CellState::kOccupied || cell == state) return;
      if (cell == CellState::kUnknown && state == CellState::kFree) ++seen;
      cell = state;
      s.map_changes.emplace_back(c, state);
    };
    for (int ray = 0; ray <= 240; ++ray) {
      const double angle = yaw + kFov * (ray / 240.0 - 0.5);
      for (double d = 0.0; d < kRange; d += 0.05) {
        const Eigen::Vector2d q = p + d * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        if (wall(q.x(), q.y())) {
          mark(q, CellState::kOccupied);
          break;
        }
        mark(q, CellState::kFree);
      }
    }
    for (int j = 1; j + 1 < kHeight; ++j) {
      for (int i = 1; i + 1 < kWidth; ++i) {
        const auto at = static_cast<std::size_t>(j * kWidth + i);
        if (known[at] != CellState::kFree) continue;
        if (known[at - 1] == CellState::kUnknown || known[at + 1] == CellState::kUnknown ||
            known[at - kWidth] == CellState::kUnknown ||
            known[at + kWidth] == CellState::kUnknown) {
          s.frontier_cells.emplace_back((i + 0.5F) * 0.1F, (j + 0.5F) * 0.1F);
        }
      }
    }
    s.active_frontiers = static_cast<int>(s.frontier_cells.size() / 40);

    double expected = 0.0;
    for (const Eigen::Vector2d& l : landmarks) {
      const Eigen::Vector2d to = l - p;
      if (to.norm() > 6.0) continue;
      bool hidden = false;
      for (double d = 0.0; d < to.norm() - 0.25; d += 0.1) {
        const Eigen::Vector2d q = p + d * to.normalized();
        hidden = hidden || wall(q.x(), q.y());
      }
      const double bearing = std::remainder(std::atan2(to.y(), to.x()) - yaw, 2.0 * M_PI);
      const double in_view = 1.0 / (1.0 + std::exp(12.0 * (std::abs(bearing) - 0.6)));
      const double visibility = hidden ? 0.02 : in_view;
      expected += visibility;
      s.landmarks.push_back({static_cast<float>(l.x() + drift.x()),
                             static_cast<float>(l.y() + drift.y()),
                             static_cast<float>(visibility)});
    }
    s.predicted_features = expected;
    s.tracked_features = std::max(0, static_cast<int>(expected + 3.0 * normal(generator)));
    s.localization = s.tracked_features < 8 ? Localization::kDegraded : Localization::kOk;
    s.coverage = std::min(1.0, static_cast<double>(seen) / reachable);
    s.area = 0.01 * seen;
    s.localization_error = drift.norm();
    s.path_length = driven;
    s.clearance = 0.25 + 0.1 * std::sin(0.1 * k);
    s.command.linear.x() = kSpeed;
    s.command.yaw_rate = 0.3 * std::sin(0.2 * k);
    s.plan_kind = k % 61 == 60 ? PlanKind::kStoppingTail : PlanKind::kOptimised;
    s.seed = k % 7 == 0 ? "turn_on_spot" : "cost_to_go_descent";
    s.stop_reason = k % 3 == 0 ? StopReason::kDeadline : StopReason::kConverged;
    s.quality = Quality::kFeasible;
    s.certified = k % 61 != 60;
    s.certificate = s.certified ? "free of collision along 81 poses, 0.21 m clear"
                                : "a pose at 0.9 s would touch an occupied cell; stops before it";
    s.cost_evaluations = 80 + k % 50;
    s.gradient_evaluations = 20 + k % 11;
    const double wobble = std::sin(0.07 * k);
    s.explanation.terms = {
        {"control_effort", "", 0.8, 0.8 + 0.2 * wobble, false},
        {"input_rate", "", 0.3, 0.3 + 0.1 * std::cos(0.3 * k), false},
        {"exploration_gain", "m2", -2.0, -2.6 - 0.8 * std::sin(0.05 * k), false},
        {"cost_to_go", "s", 3.0, 3.4 + 1.2 * std::cos(0.04 * k), false},
        {"visibility_prediction", "", 0.6, std::max(0.0, 1.6 - expected / 40.0), false},
        {"heading_alignment", "", 0.2, 0.3 + 0.2 * std::sin(0.11 * k), false},
        {"clearance", "m", s.clearance - 0.2, 0.0, true}};
    s.explanation.cost =
        std::accumulate(s.explanation.terms.begin(), s.explanation.terms.end(), 0.0,
                        [](double sum, const TermValue& t) { return sum + t.weighted; });
    const double late = k % 61 == 60 ? 40.0 : 0.0;
    s.wall = {28.0 + 6.0 * wobble + late + 2.0 * std::abs(normal(generator)),
              3.1,
              1.2,
              0.8,
              4.5,
              16.0 + 6.0 * wobble,
              1.4};

    // Drive on; the horizon is the drive to come.
    const auto advance = [&](Eigen::Vector2d& at, double& heading, std::size_t& goal,
                             double distance) {
      while (distance > 0.0 && goal < way.size()) {
        const Eigen::Vector2d to = way[goal] - at;
        const double turn = std::remainder(std::atan2(to.y(), to.x()) - heading, 2.0 * M_PI);
        if (std::abs(turn) > 0.3) {
          heading += std::copysign(std::min(0.4, std::abs(turn)), turn);
          return;
        }
        heading += turn;
        const double part = std::min(distance, to.norm());
        if (to.norm() > 0.0) at += part * to.normalized();
        distance -= part;
        if (part >= to.norm() - 1e-9) ++goal;
      }
    };
    {
      Eigen::Vector2d at = p;
      double heading = yaw;
      std::size_t goal = next;
      for (int i = 0; i <= 20; ++i) {
        s.horizon.push_back(
            {{at.x() + estimate.x() - p.x(), at.y() + estimate.y() - p.y(), 0.0}, heading});
        advance(at, heading, goal, 0.12);
      }
    }
    const Eigen::Vector2d before = p;
    advance(p, yaw, next, kSpeed * kStep);
    driven += (p - before).norm();
    drift += 0.004 * Eigen::Vector2d(normal(generator) + 0.15, normal(generator));
    // What it does and why: it looks around at first, turns back where features are scarce, and
    // goes to the next waypoint.
    {
      const bool scarce = s.localization != Localization::kOk;
      const ModeKind now = k < 6         ? ModeKind::kLookAround
                           : scarce      ? ModeKind::kRetreat
                           : k % 97 > 90 ? ModeKind::kTurnOnTheSpot
                                         : ModeKind::kExplore;
      if (now != mode && (k < 12 || s.time - mode_since >= 4.0)) {
        mode = now;
        mode_since = s.time;
        cause = k == 0                             ? Cause::kStart
                : mode == ModeKind::kRetreat       ? Cause::kFeaturesScarce
                : mode == ModeKind::kTurnOnTheSpot ? Cause::kNoProgress
                : cause == Cause::kFeaturesScarce  ? Cause::kLocalizationRegained
                                                   : Cause::kTurned;
      }
      s.mode = mode;
      s.cause = cause;
      s.mode_since = mode_since;
      s.safety_level = mode == ModeKind::kRetreat ? SafetyLevel::kLost
                       : k % 150 > 130            ? SafetyLevel::kReduced
                                                  : SafetyLevel::kNormal;
      s.target_change = k % 40 == 7 ? TargetChange::kSeen : TargetChange::kNone;
      TargetRecord target;
      const Eigen::Vector2d goal = way[std::min(next + 1, way.size() - 1)];
      const Eigen::Vector2d after = way[std::min(next + 2, way.size() - 1)];
      target.viewpoint = goal + drift;
      target.looks_at =
          target.viewpoint + 1.8 * (after - goal + Eigen::Vector2d(1e-9, 0.0)).normalized();
      target.length = 1.4 + 0.3 * std::sin(0.3 * k);
      target.area = 6.0;
      target.path_left = (target.viewpoint - estimate).norm();
      if (mode != ModeKind::kLookAround) s.target = target;
      if (k % 8 == 3) {
        using Why = FrontierStanding::Why;
        for (std::size_t n = 0; n < 3; ++n) {
          const Eigen::Vector2d at = way[std::min(next + 2 + n, way.size() - 1)] + drift;
          s.standings.push_back({at, Why::kInOrder, 6.0 - n, 7.0 - n, 5.0 + 4.0 * n});
        }
        s.standings.push_back({{1.0, 1.0}, Why::kLittle, 0.04, 0.1, 12.0});
        s.standings.push_back({{2.0, 5.0}, Why::kNoPath, 0.02, 0.3});
      }
      char text[200];
      if (mode == ModeKind::kRetreat) {
        std::snprintf(text, sizeof text,
                      "turns back: %d features in view for %.1f s, 41 were seen at the corner",
                      s.tracked_features, s.time - mode_since);
      } else if (mode == ModeKind::kLookAround) {
        std::snprintf(text, sizeof text, "looks around before it sets out: %d frontiers so far",
                      s.active_frontiers);
      } else {
        std::snprintf(text, sizeof text,
                      "goes to a frontier of %.1f m, %.1f m away: promises %.1f m2, the most of "
                      "%d frontiers",
                      target.length, target.path_left, target.area, s.active_frontiers);
      }
      s.why = text;
      s.seeds_scored = 12;
      const char* names[] = {"cost_to_go_descent", "previous_plan", "turn_left", "turn_right",
                             "straight"};
      for (int c = 0; c < 5; ++c) {
        CandidateRecord candidate;
        candidate.name = names[(c + k) % 5];
        candidate.polished = c == 0;
        candidate.explanation = s.explanation;
        for (TermValue& t : candidate.explanation.terms) {
          if (!t.constraint) t.weighted *= 1.0 + 0.15 * c * std::sin(1.0 + c + t.weighted);
        }
        candidate.explanation.cost = s.explanation.cost + 0.4 * c;
        const bool refused = s.plan_kind == PlanKind::kStoppingTail;
        candidate.verdict = refused  ? Verdict{Verdict::Kind::kRefused,
                                              "a pose at 0.9 s would touch an occupied cell"}
                            : c == 0 ? Verdict{Verdict::Kind::kExecuted}
                                     : Verdict{};
        for (const Pose& x : s.horizon) {
          const Eigen::Vector2d along = x.position.head<2>() - estimate;
          candidate.path.push_back(
              (estimate + Eigen::Rotation2Dd(0.3 * (c % 2 == 0 ? c : -c)) * along).cast<float>());
        }
        s.candidates.push_back(std::move(candidate));
      }
      if (k % kCostToGoEvery == 0) {
        CostToGoPicture& picture = s.cost_to_go.emplace();
        picture.frame = {kResolution, 0, 0, kWidth, kHeight};
        for (int n = 0; n < picture.frame.size(); ++n) {
          const double distance =
              (picture.frame.center(picture.frame.at(n)) - target.viewpoint).norm();
          picture.seconds.push_back(known[static_cast<std::size_t>(n)] == CellState::kFree
                                        ? static_cast<float>(distance / kSpeed)
                                        : std::numeric_limits<float>::quiet_NaN());
        }
      }
    }
    // A camera that shows stripes, and as many landmarks as steps have gone by, tracked every
    // other.
    if (k % kPictureEvery == 0) {
      Image image(160, 120);
      for (int v = 0; v < image.height; ++v) {
        for (int u = 0; u < image.width; ++u) {
          image.at(u, v) = static_cast<std::uint8_t>((3 * u + k) % 256);
        }
      }
      std::vector<LandmarkSighting> sightings;
      for (int i = 0; i <= k / 10; ++i) {
        sightings.push_back({static_cast<std::uint64_t>(i), {4.0 + 6.0 * i, 60.0}, i % 2 == 0});
      }
      run.pictures.push_back(landmark_picture(k, image, sightings));
    }
    run.steps.push_back(std::move(s));
  }
  run.summary = summarize(run.steps);
  run.summary.world = "synthetic office";
  run.summary.solver = "nlopt:LD_SLSQP";
  run.summary.seed = 7;
  run.summary.end = MissionEnd::kExplored;
  run.summary.reachable_area_m2 = 0.01 * reachable;
  run.summary.wall_s = 21.4;
  return run;
}

}  // namespace prospect
