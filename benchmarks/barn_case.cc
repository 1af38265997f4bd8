// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/barn_case.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/run/exploration_run.h"

namespace prospect {
namespace {

constexpr double kCell = 0.15;  // [m]

/// The cells of a reference path, in metres.
std::vector<Eigen::Vector2d> read_path(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) fail(file, "cannot be read; expected the reference path of a world");
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  constexpr std::size_t kBegin = 10, kNumber = 8;  // of the header; of an entry
  if (bytes.size() < kBegin || bytes.compare(0, 8, std::string("\x93NUMPY\x01\x00", 8)) != 0) {
    fail(file, "is no NumPy file of version 1");
  }
  const std::size_t length =
      static_cast<unsigned char>(bytes[8]) + 256U * static_cast<unsigned char>(bytes[9]);
  const std::string header = bytes.substr(kBegin, length);
  const bool whole = header.find("'<i8'") != std::string::npos;
  const bool numbers = whole || header.find("'<f8'") != std::string::npos;
  if (!numbers || header.find("False") == std::string::npos ||
      header.find(", 2)") == std::string::npos) {
    fail(file, "holds " + header + "; expected n x 2 integers or doubles, row by row");
  }
  const std::size_t data = std::min(bytes.size(), kBegin + length);
  const std::size_t rows = (bytes.size() - data) / (2 * kNumber);
  const auto entry = [&](std::size_t n) {
    std::int64_t integer = 0;
    double real = 0.0;
    if (whole) {
      std::memcpy(&integer, bytes.data() + data + n * kNumber, kNumber);
      return static_cast<double>(integer);
    }
    std::memcpy(&real, bytes.data() + data + n * kNumber, kNumber);
    return real;
  };
  std::vector<Eigen::Vector2d> path;
  for (std::size_t n = 0; n < rows; ++n) {
    path.emplace_back(kCell * entry(2 * n) - 4.575, kCell * entry(2 * n + 1) + 5.075);
  }
  if (path.empty()) fail(file, "holds no path");
  return path;
}

/// The smallest t in [0, 1] at which a + t (b - a) is at the distance r from c; none: it is not.
std::optional<double> crossing(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                               const Eigen::Vector2d& c, double r) {
  const Eigen::Vector2d d = b - a, e = a - c;
  const double A = d.squaredNorm(), B = d.dot(e), C = e.squaredNorm() - r * r;
  if (C == 0.0) return 0.0;
  const double D = B * B - A * C;
  if (!(A > 0.0) || D < 0.0) return std::nullopt;
  for (const double t : {(-B - std::sqrt(D)) / A, (-B + std::sqrt(D)) / A}) {
    if (t >= 0.0 && t <= 1.0) return t;
  }
  return std::nullopt;
}

}  // namespace

double barn_path_length(const std::string& file, const Eigen::Vector2d& start,
                        const Eigen::Vector2d& goal) {
  double length = 0.0;
  Eigen::Vector2d before = start;
  std::vector<Eigen::Vector2d> path = read_path(file);
  path.push_back(goal);
  for (const Eigen::Vector2d& place : path) {
    length += (place - before).norm();
    before = place;
  }
  return length;
}

double barn_metric(double length, const std::optional<double>& time) {
  const double best = length / 2.0;
  return time ? best / std::clamp(*time, 4.0 * best, 8.0 * best) : 0.0;
}

std::optional<double> barn_time(const std::vector<TimedPlace>& way, const Eigen::Vector2d& goal) {
  constexpr double kLeft = 0.1;  // [m]
  std::optional<double> begin;
  for (std::size_t n = 1; n < way.size(); ++n) {
    const TimedPlace &a = way[n - 1], &b = way[n];
    const auto time_of = [&](double t) { return a.time + t * (b.time - a.time); };
    if (!begin) {
      if (const auto t = crossing(a.at, b.at, way.front().at, kLeft)) begin = time_of(*t);
    }
    if (!begin) continue;
    if (const auto t = crossing(a.at, b.at, goal, kBarnReach)) return time_of(*t) - *begin;
  }
  return std::nullopt;
}

BarnOutcome drive_barn(const std::string& world, const std::string& path,
                       const Configuration& configuration, bool real_time) {
  const auto loaded =
      std::make_shared<const World>(load_world(world, world_options_for(configuration)));
  const Eigen::Vector2d start = loaded->start.position.head<2>();
  const Eigen::Vector2d goal = configuration.planner.task.goal.position.head<2>();
  BarnOutcome outcome;
  outcome.length = barn_path_length(path, start, goal);
  ExplorationRunOptions options;
  if (real_time) options.real_time.emplace();
  const ExplorationRunResult result = run_exploration(loaded, configuration, options);
  std::vector<TimedPlace> way = {{0.0, start}};
  for (const StepRecord& step : result.record.steps) {
    way.push_back({step.time, step.true_pose.position.head<2>()});
    outcome.longest_step = std::max(outcome.longest_step, 1e-3 * step.wall.plan);
  }
  const Summary& summary = result.record.summary;
  outcome.end = summary.end;
  outcome.contacts = summary.collisions;
  outcome.driven = summary.path_length_m;
  if (outcome.contacts == 0) outcome.time = barn_time(way, goal);
  outcome.metric = barn_metric(outcome.length, outcome.time);
  return outcome;
}

}  // namespace prospect
