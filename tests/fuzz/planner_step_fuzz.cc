// SPDX-License-Identifier: Apache-2.0
// A belief, the parameters of planner and base, and a mission: two steps from them. What does not
// fit is refused by the constructor or by the step, in clear lines; whatever comes, each plan has
// commands that the base may be sent: finite, and no faster than it can be, however fast it was
// measured to be: the guard lets nothing else pass.
#include <octomap/OcTree.h>

#include <bit>
#include <cmath>
#include <limits>
#include <memory>

#include "engine/maps/map_projection.h"
#include "engine/planner/planner.h"
#include "engine/problem/solver.h"
#include "models/knobs.h"
#include "models/make_model.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

namespace {

/// Bytes one after the other; zeros behind the last.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  unsigned byte() { return at_ < size_ ? data_[at_++] : 0U; }
  /// From low to high; at times a number that is none, or beyond all others.
  double number(double low, double high) {
    const unsigned b = byte();
    if (b < 250) return low + (high - low) * b / 249.0;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    constexpr double kOdd[] = {kNan, kInfinity, -kInfinity, 1e300, -1e18, 1e-300};
    return kOdd[b - 250];
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

/// Most values stay as they are; others become an end of their range, or one between.
class ByteKnobs final : public Knobs {
 public:
  explicit ByteKnobs(Bytes& bytes) : bytes_(bytes) {}
  void number(const char*, double& value, Range range, const char*, const char*) override {
    set(value, range.min, range.max);
  }
  void degrees(const char*, double& value, Range range, const char*) override {
    set(value, kRadiansPerDegree * range.min, kRadiansPerDegree * range.max);
  }
  void integer(const char*, int& value, WholeRange range, const char*, const char*) override {
    double whole = value;
    set(whole, range.min, range.max);
    value = static_cast<int>(whole);
  }
  void boolean(const char*, bool& value, const char*) override {
    if (bytes_.byte() % 8 == 7) value = !value;
  }
  void numbers(const char*, double* values, std::size_t count, Range range, const char*,
               const char*) override {
    for (std::size_t n = 0; n < count; ++n) set(values[n], range.min, range.max);
  }
  void require(bool, const char*, const char*) override {}

 private:
  void word(const char*, std::size_t& index, const std::vector<std::string>& words,
            const char*) override {
    const unsigned b = bytes_.byte();
    if (b % 8 == 7) index = b / 8 % words.size();
  }
  void enter(const char*) override {}
  void leave() override {}
  void set(double& value, double low, double high) {
    const unsigned b = bytes_.byte();
    if (b < 240) return;
    if (!std::isfinite(low) || !std::isfinite(high)) return;
    const double wanted[] = {low,         high,        0.5 * (low + high), 0.1 * value,
                             0.5 * value, 2.0 * value, 10.0 * value};
    value = std::clamp(wanted[(b - 240) % 7], low, high);
  }
  Bytes& bytes_;
};

class IdleSolver final : public Solver {
 public:
  std::string name() const override { return "idle"; }
  std::vector<OptionInfo> options() const override { return {}; }
  std::string explain_unsupported(const Problem&) const override { return ""; }
  Result solve(const Problem&, const WarmStart&, const Options&,
               const StopCondition&) const override {
    return {};
  }
};

std::shared_ptr<const MotionModel> model_of(Bytes& bytes) {
  const auto names = model_names();
  const std::string name = names[bytes.byte() % names.size()];
  ModelParameters parameters = default_parameters(name);
  ByteKnobs knobs(bytes);
  describe(knobs, name, parameters);
  return make_model(name, parameters);
}

Belief belief_of(Bytes& bytes, double stamp) {
  constexpr double kResolutions[] = {0.1, 0.05, 0.2, 0.5};
  const double r = kResolutions[bytes.byte() % 4];
  const int n = 8 + static_cast<int>(bytes.byte() % 40);
  VoxelGrid voxels(GridFrame{r, -n / 2, -n / 3, n, n}, 0.0, 0.7);
  for (int i = -n / 2; i < n - n / 2; ++i) {
    unsigned runs = bytes.byte();
    for (int j = -n / 3; j < n - n / 3; ++j) {
      if (j % 8 == 0) runs = bytes.byte();
      const unsigned state = (runs >> (j & 7)) & 1U;
      const bool inner = std::abs(i) < 3 && std::abs(j) < 3 && runs != 0xff;
      for (int k = voxels.k0(); k < voxels.k0() + voxels.depth(); ++k) {
        voxels.set(i, j, k,
                   inner || state == 0 ? CellState::kFree
                   : runs % 3 == 0     ? CellState::kOccupied
                                       : CellState::kUnknown);
      }
    }
  }
  Belief belief;
  belief.set_stamps(bytes.byte() < 240 ? stamp : bytes.number(0.0, 2.0 * stamp));
  belief.pose.position = {bytes.number(-1.0, 1.0), bytes.number(-1.0, 1.0), bytes.number(0.0, 0.6)};
  belief.pose.yaw = bytes.number(-4.0, 4.0);
  belief.twist.linear.x() = bytes.number(-0.5, 1.0);
  belief.twist.yaw_rate = bytes.number(-1.0, 1.0);
  belief.covariance(0, 0) = bytes.number(0.0, 0.1);
  belief.covariance(3, 3) = bytes.number(0.0, 0.1);
  belief.localization = static_cast<Localization>(bytes.byte() % 3);
  belief.tracked_features = static_cast<int>(bytes.byte());
  if (bytes.byte() % 2 == 1) belief.command = belief.twist;
  belief.ground = std::make_shared<const GroundMap>(project(voxels, {0.1, 0.5}));
  belief.voxels = std::make_shared<const VoxelGrid>(std::move(voxels));
  if (bytes.byte() % 16 != 15) belief.octree = std::make_shared<const octomap::OcTree>(r);
  auto landmarks = std::make_shared<LandmarkMap>();
  for (unsigned l = bytes.byte() % 64; l > 0; --l) {
    Landmark& landmark = landmarks->landmarks.emplace_back();
    landmark.id = l;
    landmark.position = {bytes.number(-2.0, 2.0), bytes.number(-2.0, 2.0), 0.4};
    if (l % 8 == 0) landmark.survival = bytes.number(0.0, 1.0);
    if (l % 8 == 1) landmark.covariance(0, 0) = bytes.number(0.0, 0.1);
  }
  belief.landmarks = std::move(landmarks);
  return belief;
}

Task task_of(Bytes& bytes) {
  switch (bytes.byte() % 8) {
    case 0:
      return Task::go_to({bytes.number(-3.0, 3.0), bytes.number(-3.0, 3.0)});
    case 1:
      return Task::go_to({bytes.number(-3.0, 3.0), bytes.number(-3.0, 3.0)},
                         bytes.number(-4.0, 4.0));
    case 2:
      return Task::return_to_start();
    case 3:
      return Task::hold();
    case 4:
      return Task::explore(Polygon{{bytes.number(-3.0, 3.0), bytes.number(-3.0, 3.0)},
                                   {bytes.number(-3.0, 3.0), bytes.number(-3.0, 3.0)},
                                   {bytes.number(-3.0, 3.0), bytes.number(-3.0, 3.0)}});
    default:
      return Task::explore();
  }
}

void finding(const char* what, const std::string& detail) {
  std::fprintf(stderr, "%s: %s\n", what, detail.c_str());
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  fuzz::read_or_refuse<std::invalid_argument>([&] {
    RobotDescription robot;
    robot.model = model_of(bytes);
    PlannerParameters parameters;
    ByteKnobs knobs(bytes);
    describe(knobs, parameters);
    parameters.polished = 0;
    parameters.threads = 1;
    parameters.deadline = 0.0;
    const std::shared_ptr<const MotionModel> model = robot.model;
    Planner planner(std::move(robot), parameters, std::make_shared<IdleSolver>());
    for (const double stamp : {10.0, 10.5}) {
      const std::string wrong = planner.set_task(task_of(bytes));
      if (!wrong.empty() && !fuzz::is_clear(wrong)) finding("no clear line", wrong);
      const Belief belief = belief_of(bytes, stamp);
      const Plan plan = planner.plan(belief);
      if (!plan.detail.empty() && !fuzz::is_clear(plan.detail)) {
        finding("no clear line", plan.detail);
      }
      if (plan.fault == PlanFault::kError) finding("a step that failed", plan.detail);
      if (plan.commands.empty()) finding("a plan without commands", plan.detail);
      for (const Twist& command : plan.commands) {
        if (!command.linear.allFinite() || !std::isfinite(command.yaw_rate) ||
            command.linear.norm() > (1.0 + 1e-9) * model->max_speed() ||
            std::abs(command.yaw_rate) > model->max_yaw_rate()) {
          finding("a command that no base may be sent",
                  std::to_string(command.linear.norm()) + " m/s, " +
                      std::to_string(command.yaw_rate) + " rad/s of " +
                      std::to_string(model->max_speed()) + ", " +
                      std::to_string(model->max_yaw_rate()) + ": " + plan.detail);
        }
      }
    }
  });
  return 0;
}
