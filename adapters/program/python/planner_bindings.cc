// SPDX-License-Identifier: Apache-2.0
#include <octomap/OcTree.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "adapters/missions/config/configuration.h"
#include "adapters/missions/config/registries.h"
#include "adapters/program/python/arrays.h"
#include "adapters/program/python/bindings.h"
#include "adapters/program/python/motion_arrays.h"
#include "adapters/program/python/python_problem.h"
#include "adapters/program/python/python_solver.h"
#include "engine/maps/correction.h"
#include "engine/maps/map_projection.h"
#include "engine/planner/planner.h"
#include "models/nearest_name.h"
#include "models/version.h"

namespace prospect::python {
namespace {

/// "planner.weights.w_l=0", as the command line has it.
std::vector<YamlSetting> settings_of(const py::dict& given) {
  std::vector<YamlSetting> settings;
  for (const auto& [key, value] : given) {
    std::string text;
    if (py::isinstance<py::bool_>(value)) {
      text = value.cast<bool>() ? "true" : "false";
    } else {
      text = py::str(value);
    }
    settings.emplace_back(std::string(py::str(key)) + "=" + text);
  }
  return settings;
}

/// Maps of Python: an octree and what follows from it.
struct Maps {
  BeliefMaps maps;
};

/// The address of the first of `count` voxels along an axis, which begin at `at` [m]. Throws where
/// that is no multiple of the resolution, or where OctoMap's keys do not reach.
int address(double at, py::ssize_t count, double resolution, const char* axis) {
  constexpr double kReach = 32768.0;  // voxels, either way
  const double exact = at / resolution;
  const double last = exact + static_cast<double>(count);
  if (!(exact >= -kReach - 0.5 && last <= kReach + 0.5)) {
    throw std::invalid_argument("origin: along " + std::string(axis) + " the voxels reach from " +
                                number_text(at) + " to " + number_text(last * resolution) +
                                " m; expected within " + number_text(kReach * resolution) +
                                " m of 0, 32768 voxels: count positions from a place nearby");
  }
  if (std::abs(exact - std::round(exact)) > 1e-6) {
    throw std::invalid_argument("origin: " + std::string(axis) + " is " + number_text(at) +
                                " m; expected a multiple of the resolution, " +
                                number_text(resolution) + " m");
  }
  return static_cast<int>(std::round(exact));
}

Maps make_maps(const ArrayLike& given, double resolution, const ArrayLike& origin,
               const Configuration& configuration) {
  const Bytes voxels =
      codes_of(given, {-1, -1, -1}, 2, "voxels", "0 (unknown), 1 (free) and 2 (occupied)");
  if (!(resolution >= 1e-3 && resolution <= 10.0)) {
    throw std::invalid_argument("resolution: is " + number_text(resolution) +
                                " m; expected 0.001 to 10 m");
  }
  const Eigen::VectorXd corner = vector_of(origin, 3, "origin");
  const int i0 = address(corner.x(), voxels.shape(1), resolution, "x"),
            j0 = address(corner.y(), voxels.shape(0), resolution, "y"),
            k0 = address(corner.z(), voxels.shape(2), resolution, "z");
  const auto v = voxels.unchecked<3>();
  const HeightSlice slice = height_slice(configuration.robot);
  const py::gil_scoped_release release;
  auto octree = std::make_shared<octomap::OcTree>(resolution);
  constexpr int kCenter = 32768;  // of OctoMap's keys
  const auto key = [](py::ssize_t n, int first) {
    return static_cast<octomap::key_type>(static_cast<int>(n) + first + kCenter);
  };
  for (py::ssize_t j = 0; j < v.shape(0); ++j) {
    for (py::ssize_t i = 0; i < v.shape(1); ++i) {
      for (py::ssize_t k = 0; k < v.shape(2); ++k) {
        if (v(j, i, k) == 0) continue;
        const float odds =
            v(j, i, k) == 2 ? octree->getClampingThresMaxLog() : octree->getClampingThresMinLog();
        octree->setNodeValue(octomap::OcTreeKey(key(i, i0), key(j, j0), key(k, k0)), odds, true);
      }
    }
  }
  octree->updateInnerOccupancy();
  octree->prune();
  return {belief_maps(std::move(octree), slice, k0 * resolution,
                      (k0 + static_cast<int>(v.shape(2))) * resolution)};
}

py::array_t<std::uint8_t> cells_of(const GroundMap& ground) {
  const GridFrame& f = ground.frame();
  py::array_t<std::uint8_t> array(std::vector<py::ssize_t>{f.height, f.width});
  std::transform(ground.cells().data.begin(), ground.cells().data.end(), array.mutable_data(),
                 [](CellState s) { return static_cast<std::uint8_t>(s); });
  return array;
}

py::array_t<std::uint8_t> voxels_of(const VoxelGrid& voxels) {
  const GridFrame& f = voxels.frame();
  py::array_t<std::uint8_t> array(std::vector<py::ssize_t>{f.height, f.width, voxels.depth()});
  std::transform(voxels.data().begin(), voxels.data().end(), array.mutable_data(),
                 [](CellState s) { return static_cast<std::uint8_t>(s); });
  return array;
}

/// left, right, bottom, top [m]: as matplotlib's imshow takes it.
py::tuple extent_of(const GridFrame& f) {
  return py::make_tuple(f.i0 * f.resolution, (f.i0 + f.width) * f.resolution, f.j0 * f.resolution,
                        (f.j0 + f.height) * f.resolution);
}

constexpr const char* kExtent =
    "(left, right, bottom, top) [m] of `ground`, as imshow(ground, origin='lower', extent=...) "
    "takes it.";

/// Throws std::invalid_argument unless all numbers, if there are any, are from low to high.
void check_between(const std::optional<Numbers>& numbers, double low, double high,
                   const std::string& name, const std::string& expected) {
  for (py::ssize_t n = 0; numbers && n < numbers->size(); ++n) {
    const double x = numbers->data()[n];
    if (x >= low && x <= high) continue;
    throw std::invalid_argument(name + ": holds " + number_text(x) + " at " + std::to_string(n) +
                                "; expected " + expected);
  }
}

/// Throws unless it is symmetric and no variance in it is negative, up to rounding.
template <typename Matrix>
void check_covariance(const Matrix& covariance, const std::string& name) {
  const double rounding = 1e-9 * covariance.cwiseAbs().maxCoeff();
  const bool symmetric = (covariance - covariance.transpose()).cwiseAbs().maxCoeff() <= rounding;
  const Eigen::SelfAdjointEigenSolver<Matrix> values(covariance, Eigen::EigenvaluesOnly);
  if (symmetric && values.eigenvalues().minCoeff() >= -rounding) return;
  throw std::invalid_argument(
      name +
      (symmetric ? ": has a variance of " + number_text(values.eigenvalues().minCoeff())
                 : std::string(": is not symmetric")) +
      "; expected a covariance");
}

/// Throws for what no robot does, as a number in another unit.
void check_speed(const Twist& twist, const std::string& name) {
  constexpr double kFastest = 100.0;  // [m/s], [rad/s]
  const double most = std::max(twist.linear.norm(), std::abs(twist.yaw_rate));
  if (most <= kFastest) return;
  throw std::invalid_argument(name + ": is " + number_text(most) +
                              "; expected m/s and rad/s, at most 100");
}

std::shared_ptr<LandmarkMap> make_landmarks(const ArrayLike& positions,
                                            const std::optional<ArrayLike>& covariances,
                                            const std::optional<ArrayLike>& directions,
                                            const std::optional<ArrayLike>& ranges,
                                            const std::optional<ArrayLike>& survivals,
                                            double feature_density) {
  const Numbers position = numbers_of(positions, {-1, 3}, "position");
  const py::ssize_t L = position.shape(0);
  const auto numbers = [](const std::optional<ArrayLike>& array,
                          const std::vector<py::ssize_t>& shape, const char* name) {
    return array ? std::optional(numbers_of(*array, shape, name)) : std::nullopt;
  };
  const auto covariance = numbers(covariances, {L, 3, 3}, "covariance");
  const auto direction = numbers(directions, {L, 3}, "direction");
  const auto range = numbers(ranges, {L}, "range");
  const auto survival = numbers(survivals, {L}, "survival");
  check_between(range, 1e-9, 1e9, "range", "distances above 0 m");
  check_between(survival, 0.0, 1.0, "survival", "shares from 0 to 1");
  if (!(feature_density >= 0.0) || !std::isfinite(feature_density)) {
    throw std::invalid_argument("feature_density: is " + number_text(feature_density) +
                                "; expected 0 or more features a square metre");
  }
  auto map = std::make_shared<LandmarkMap>();
  map->feature_density = feature_density;
  for (py::ssize_t n = 0; n < L; ++n) {
    Landmark l;
    l.id = static_cast<std::uint64_t>(n);
    l.position = Eigen::Map<const Eigen::Vector3d>(position.data(n, 0));
    if (covariance) {
      l.covariance = Eigen::Map<const Eigen::Matrix3d>(covariance->data(n, 0, 0)).transpose();
      check_covariance(l.covariance, "covariance: " + std::to_string(n));
    }
    if (direction) {
      const Eigen::Vector3d d = Eigen::Map<const Eigen::Vector3d>(direction->data(n, 0));
      if (!(d.stableNorm() > 1e-9)) {
        throw std::invalid_argument("direction: " + std::to_string(n) +
                                    " is 0; expected a direction");
      }
      l.creation_direction = d.stableNormalized();
    }
    if (range) l.creation_range = *range->data(n);
    if (survival) l.survival = *survival->data(n);
    map->landmarks.push_back(l);
  }
  return map;
}

Numbers positions_of(const std::vector<Landmark>& landmarks) {
  Numbers array(std::vector<py::ssize_t>{static_cast<py::ssize_t>(landmarks.size()), 3});
  double* out = array.mutable_data();
  for (const Landmark& l : landmarks) out = std::copy_n(l.position.data(), 3, out);
  return array;
}

std::shared_ptr<const Movers> movers_of(const ArrayLike& rows, double stamp) {
  const Eigen::MatrixXd columns = transposed(rows, -1, 6, "movers");
  auto known = std::make_shared<Movers>();
  known->stamp = stamp;
  for (Eigen::Index n = 0; n < columns.cols(); ++n) {
    const Eigen::VectorXd m = columns.col(n);
    known->all.push_back({m.head<2>(), m.segment<2>(2), m[4], m[5]});
    if (!known->all.back().sound()) {
      throw std::invalid_argument("movers: row " + std::to_string(n) +
                                  " is not finite, or its radius or spread is below 0");
    }
  }
  return known;
}

std::shared_ptr<Belief> make_belief(const Maps& maps, const ArrayLike& pose, double stamp,
                                    const std::optional<ArrayLike>& covariance,
                                    const ArrayLike& velocity,
                                    const std::optional<ArrayLike>& command,
                                    const std::shared_ptr<LandmarkMap>& landmarks,
                                    const std::string& localization, int tracked_features,
                                    const std::optional<ArrayLike>& map_frame,
                                    const std::optional<ArrayLike>& movers) {
  if (!std::isfinite(stamp)) {
    throw std::invalid_argument("stamp: is " + number_text(stamp) + "; expected seconds, finite");
  }
  if (tracked_features < 0) {
    throw std::invalid_argument("tracked_features: is " + std::to_string(tracked_features) +
                                "; expected 0 or more");
  }
  auto b = std::make_shared<Belief>();
  b->set_stamps(stamp);
  const Eigen::VectorXd p = vector_of(pose, 4, "pose");
  b->pose = {p.head<3>(), p[3]};
  if (covariance) {
    b->covariance = transposed(*covariance, 4, 4, "covariance").transpose();
    check_covariance(b->covariance, "covariance");
  }
  b->twist = twist_of(velocity, "velocity");
  check_speed(b->twist, "velocity");
  if (command) {
    b->command = twist_of(*command, "command");
    check_speed(*b->command, "command");
  }
  const std::vector<std::string> names = {"ok", "degraded", "lost"};
  std::size_t n = 0;
  while (n < names.size() && names[n] != localization) ++n;
  if (n == names.size()) {
    throw std::invalid_argument("localization: is '" + localization + "'" + expected_one_of(names));
  }
  b->localization = static_cast<Localization>(n);
  b->localization_source =
      landmarks ? LocalizationSource::kVisualOdometry : LocalizationSource::kExternal;
  b->tracked_features = tracked_features;
  if (map_frame) {
    const Eigen::VectorXd origin = vector_of(*map_frame, 3, "map_frame");
    auto frame = std::make_shared<MapFrame>();
    frame->origin = {{origin[0], origin[1], 0.0}, origin[2]};
    b->map_frame = std::move(frame);
  }
  if (movers) b->movers = movers_of(*movers, stamp);
  b->octree = maps.maps.octree;
  b->voxels = maps.maps.voxels;
  b->ground = maps.maps.ground;
  b->landmarks = landmarks;
  return b;
}

/// A planner with its guard, for one caller at a time.
struct PythonPlanner {
  PythonPlanner(const Configuration& c, std::shared_ptr<const Solver> solver)
      : planner(c.robot, c.planner, std::move(solver)), guard(planner.make_guard(c.guard)) {}
  std::mutex mutex;
  Planner planner;
  Guard guard;
};

/// f(planner), without the GIL, when nobody else uses it.
template <typename Function>
auto with(PythonPlanner& p, Function&& f) {
  const py::gil_scoped_release release;
  const std::lock_guard lock(p.mutex);
  return f(p.planner);
}

Task task_of(const std::string& kind, const std::optional<ArrayLike>& goal) {
  const std::vector<std::string> names = {"explore", "go", "return", "hold"};
  if (goal && kind != "go") {
    throw std::invalid_argument("goal: of no use to '" + kind + "'; expected the task 'go'");
  }
  if (kind == "explore") return Task::explore();
  if (kind == "return") return Task::return_to_start();
  if (kind == "hold") return Task::hold();
  if (kind != "go") {
    throw std::invalid_argument("task: is '" + kind + "'" + expected_one_of(names));
  }
  if (!goal) throw std::invalid_argument("goal: is missing; expected (x, y) or (x, y, yaw)");
  const Eigen::VectorXd g = vector_of(*goal, -1, "goal");
  if (g.size() != 2 && g.size() != 3) {
    throw std::invalid_argument("goal: has " + std::to_string(g.size()) +
                                " numbers; expected (x, y) or (x, y, yaw)");
  }
  return Task::go_to(g.head<2>(), g.size() == 3 ? std::optional<double>(g[2]) : std::nullopt);
}

Numbers rows_of(const std::vector<Eigen::VectorXd>& rows, int columns) {
  Numbers array(std::vector<py::ssize_t>{static_cast<py::ssize_t>(rows.size()), columns});
  double* out = array.mutable_data();
  for (const Eigen::VectorXd& row : rows) out = std::copy_n(row.data(), row.size(), out);
  return array;
}

Numbers twists_of(const std::vector<Twist>& twists) {
  Numbers array(std::vector<py::ssize_t>{static_cast<py::ssize_t>(twists.size()), 4});
  double* out = array.mutable_data();
  for (const Twist& t : twists) {
    out = std::copy_n(t.linear.data(), 3, out);
    *out++ = t.yaw_rate;
  }
  return array;
}

py::dict times_of(const PlanTimes& t) {
  py::dict d;
  d["frontier_planner"] = t.frontier_planner;
  d["clearance"] = t.clearance;
  d["views"] = t.views;
  d["seeds"] = t.seeds;
  d["polish"] = t.polish;
  d["certify"] = t.certify;
  d["total"] = t.total;
  return d;
}

py::list candidates_of(const Plan& plan) {
  py::list list;
  for (const PlanCandidate& c : plan.candidates) {
    py::dict d;
    d["name"] = c.name;
    d["polished"] = c.polished;
    d["cost"] = c.cost;
    d["violation"] = c.violation;
    d["z"] = array_of(c.z);
    d["verdict"] = to_string(c.verdict);
    list.append(d);
  }
  return list;
}

void bind_plan(py::module_& m) {
  const auto text = [](auto member) {
    return [member](const Plan& p) { return std::string(to_string(p.*member)); };
  };
  py::class_<Plan, std::shared_ptr<Plan>>(
      m, "Plan", "One planning step's result, always executable: certified, or a stop.")
      .def_property_readonly("kind", text(&Plan::kind), "'optimised', 'seed', 'stopping tail'.")
      .def_readonly("stamp", &Plan::stamp, "[s], of the belief: its first stage begins then.")
      .def_readonly("dt", &Plan::dt, "Duration of each command [s].")
      .def_property_readonly(
          "states",
          [](const Plan& p) {
            return rows_of(p.states,
                           p.states.empty() ? 0 : static_cast<int>(p.states.front().size()));
          },
          "(N+1, nx)")
      .def_property_readonly(
          "inputs",
          [](const Plan& p) {
            return rows_of(p.inputs,
                           p.inputs.empty() ? 0 : static_cast<int>(p.inputs.front().size()));
          },
          "(N, nu)")
      .def_property_readonly(
          "commands", [](const Plan& p) { return twists_of(p.commands); },
          "(N, 4): body velocity vx, vy, vz [m/s] and yaw rate [rad/s] to hold over each stage.")
      .def_property_readonly(
          "tail", [](const Plan& p) { return twists_of(p.tail); },
          "(K, 4): the certified stop after the committed stages.")
      .def_property_readonly(
          "visible",
          [](const Plan& p) {
            return array_of(p.visible.data(), {static_cast<py::ssize_t>(p.visible.size())});
          },
          "(N+1,): features predicted to be visible; empty without landmarks.")
      .def_readonly("committed", &Plan::committed, "Leading stages that are certified.")
      .def_readonly("certified", &Plan::certified)
      .def_readonly("certificate", &Plan::certificate, "What the certificate said.")
      .def_readonly("seed", &Plan::seed, "Name of the seed the plan grew from.")
      .def_readonly("solver", &Plan::solver)
      .def_readonly("stop", &Plan::stop, "StopReason of the solver.")
      .def_readonly("quality", &Plan::quality, "Quality of its result.")
      .def_readonly("explanation", &Plan::explanation, "Explanation.")
      .def_property_readonly(
          "mode", [](const Plan& p) { return std::string(to_string(p.mode.kind)); },
          "What the robot does: 'explore', 'retreat', 'done', ...")
      .def_property_readonly(
          "cause", [](const Plan& p) { return std::string(to_string(p.mode.cause)); },
          "Why that mode was entered.")
      .def_readonly("why", &Plan::why, "The same in a sentence.")
      .def_readonly("detail", &Plan::detail, "Why it is a stop, in one sentence.")
      .def_property_readonly(
          "fault", [](const Plan& p) { return std::string(to_string(p.fault)); },
          "Why the step made nothing but a stop: 'none', 'belief', 'misfit' or 'error'.")
      .def_property_readonly(
          "times_ms", [](const Plan& p) { return times_of(p.times); },
          "dict: wall-clock time of each part [ms].")
      .def_property_readonly(
          "candidates", &candidates_of,
          "list of dict, the best: name, polished, cost, violation, z (n,), verdict.")
      .def(
          "command_at", [](const Plan& p, double t) { return array_of(p.command_at(t)); },
          py::arg("t"), "(4,): the body velocity at time t [s] of the clock of stamp.")
      .def("__repr__", [](const Plan& p) {
        return "Plan(" + std::string(to_string(p.kind)) + ", mode='" +
               std::string(to_string(p.mode.kind)) + "', committed=" + std::to_string(p.committed) +
               ")";
      });
}

void bind_belief(py::module_& m) {
  py::class_<Maps>(m, "Maps",
                   "What is known of space, in W: an octree and its ground map. Never changes; "
                   "when a map has grown, make it anew.")
      .def(
          py::init(&make_maps), py::arg("voxels"), py::arg("resolution"), py::arg("origin"),
          py::arg("configuration"),
          "voxels: (ny, nx, nz) of 0 (unknown), 1 (free), 2 (occupied); row j lies at y, column i "
          "at x. resolution: edge of a voxel [m]. origin: (x, y, z) of the lowest corner [m], "
          "multiples of the resolution. configuration: of the robot, whose body says which heights "
          "are projected on the ground.")
      .def_property_readonly(
          "ground", [](const Maps& o) { return cells_of(*o.maps.ground); },
          "(ny, nx) uint8: 0 unknown, 1 free, 2 occupied, over the heights of the body.")
      .def_property_readonly(
          "extent", [](const Maps& o) { return extent_of(o.maps.ground->frame()); }, kExtent);

  py::class_<LandmarkMap, std::shared_ptr<LandmarkMap>>(m, "Landmarks",
                                                        "Points that the cameras track, in W.")
      .def(py::init(&make_landmarks), py::arg("position"), py::kw_only(),
           py::arg("covariance") = py::none(), py::arg("direction") = py::none(),
           py::arg("range") = py::none(), py::arg("survival") = py::none(),
           py::arg("feature_density") = 5.0,
           "position: (L, 3) [m]. covariance: (L, 3, 3) [m^2] [1e-4 on the diagonal]. direction: "
           "(L, 3), from the point to the camera that created it [x]. range: (L,), from there [m] "
           "[2]. survival: (L,), share of expected views in which it was tracked [0.9]. "
           "feature_density: of surfaces not yet seen [1/m^2].")
      .def_property_readonly(
          "position", [](const LandmarkMap& o) { return positions_of(o.landmarks); }, "(L, 3) [m]")
      .def("__len__", [](const LandmarkMap& o) { return o.landmarks.size(); });

  py::class_<Belief, std::shared_ptr<Belief>>(m, "Belief",
                                              "What a planner knows at one instant, in W.")
      .def(py::init(&make_belief), py::arg("maps"), py::arg("pose"), py::kw_only(),
           py::arg("stamp"), py::arg("covariance") = py::none(),
           py::arg("velocity") = std::vector<double>(4, 0.0), py::arg("command") = py::none(),
           py::arg("landmarks") = py::none(), py::arg("localization") = "ok",
           py::arg("tracked_features") = 0, py::arg("map_frame") = py::none(),
           py::arg("movers") = py::none(),
           "pose: (4,), x, y, z [m], yaw [rad]. stamp: [s], of all that is in it. covariance: "
           "(4, 4) of the pose's error [exact]. velocity, command: (4,), vx, vy, vz [m/s], yaw "
           "rate [rad/s], estimated and in force. landmarks: of a robot that is located by its "
           "cameras [none: it is located by something else]. localization: 'ok', 'degraded' or "
           "'lost'. tracked_features: in the newest image. map_frame: (3,), x, y [m], yaw [rad] of "
           "W in "
           "the frame of goals and zones [the same]: another one corrects it. movers: (n, 6), x, y "
           "[m], velocity x, y [m/s], radius [m] and by how much it grows [m/s] of each who moves "
           "[nobody].")
      .def_readonly("stamp", &Belief::stamp, "[s]")
      .def_property_readonly(
          "map_frame",
          [](const Belief& b) {
            const Pose origin = origin_of(b.map_frame.get());
            Eigen::VectorXd place(3);
            place << origin.position.x(), origin.position.y(), origin.yaw;
            return array_of(place);
          },
          "(3,): x, y [m], yaw [rad] of W in the frame of goals and zones.")
      .def_property_readonly(
          "pose", [](const Belief& b) { return array_of(b.pose); }, "(4,): x, y, z [m], yaw [rad].")
      .def_property_readonly(
          "covariance", [](const Belief& b) { return array_of(Eigen::MatrixXd(b.covariance)); },
          "(4, 4): of the error of pose.")
      .def_property_readonly(
          "velocity", [](const Belief& b) { return array_of(b.twist); },
          "(4,): vx, vy, vz [m/s], yaw rate [rad/s], in the body's frame.")
      .def_property_readonly(
          "command",
          [](const Belief& b) -> py::object {
            if (!b.command) return py::none();
            return array_of(*b.command);
          },
          "(4,): the command in force; None: not known.")
      .def_property_readonly(
          "localization", [](const Belief& b) { return std::string(to_string(b.localization)); },
          "'ok', 'degraded', 'lost'")
      .def_readonly("tracked_features", &Belief::tracked_features)
      .def_property_readonly(
          "ground", [](const Belief& b) { return cells_of(*b.ground); },
          "(ny, nx) uint8: 0 unknown, 1 free, 2 occupied.")
      .def_property_readonly(
          "extent", [](const Belief& b) { return extent_of(b.ground->frame()); }, kExtent)
      .def_property_readonly(
          "voxels", [](const Belief& b) { return voxels_of(*b.voxels); },
          "(ny, nx, nz) uint8: 0 unknown, 1 free, 2 occupied.")
      .def_property_readonly(
          "voxels_origin",
          [](const Belief& b) {
            const double r = b.voxels->resolution();
            return py::make_tuple(b.voxels->frame().i0 * r, b.voxels->frame().j0 * r,
                                  b.voxels->k0() * r);
          },
          "(x, y, z) [m] of the lowest corner of voxels.")
      .def_property_readonly(
          "resolution", [](const Belief& b) { return b.voxels->resolution(); },
          "Edge of a voxel [m].")
      .def_property_readonly(
          "landmarks",
          [](const Belief& b) {
            return positions_of(b.landmarks ? b.landmarks->landmarks : std::vector<Landmark>());
          },
          "(L, 3) [m]: positions of the landmarks.")
      .def("__repr__", [](const Belief& b) {
        return "Belief(stamp=" + std::to_string(b.stamp) + ", localization='" +
               std::string(to_string(b.localization)) + "')";
      });
}

void bind_configuration(py::module_& m) {
  py::class_<Configuration, std::shared_ptr<Configuration>>(
      m, "Configuration", "Everything that can be set of a robot, its planner and a mission.")
      .def(py::init([](const std::filesystem::path& path, const py::dict& settings,
                       const std::shared_ptr<Registries>& registries) {
             auto configuration = std::make_shared<Configuration>(read_configuration(
                 path.string(), registries ? *registries : Registries(), settings_of(settings)));
             for (const std::string& notice : configuration->notices) {
               if (PyErr_WarnEx(PyExc_DeprecationWarning, notice.c_str(), 1) < 0)
                 throw py::error_already_set();
             }
             return configuration;
           }),
           py::arg("path") = "", py::arg("settings") = py::dict(),
           py::arg("registries") = py::none(),
           "path: YAML file [the defaults]. settings: {'planner.weights.w_l': 0}, above the file; "
           "keys as `prospect config` prints them. registries: of solvers and terms that are not "
           "built in. ValueError, a line a problem, with file:line or key.")
      .def_property_readonly(
          "values",
          [](const Configuration& c) {
            py::dict d;
            for (const ConfigEntry& e : c.entries) d[e.path.c_str()] = e.value;
            return d;
          },
          "dict: what is in effect, by key, as YAML text.")
      .def_property_readonly(
          "yaml", [](const Configuration& c) { return effective_yaml(c.entries); },
          "All of it as a file with units and defaults.")
      .def_readonly("solver", &Configuration::solver)
      .def_property_readonly(
          "motion_model",
          [](const Configuration& c) {
            return std::const_pointer_cast<MotionModel>(c.robot.model);
          },
          "MotionModel of the robot.");
}

void bind_planning_context(py::module_& m) {
  py::class_<ProblemSpecification, std::shared_ptr<ProblemSpecification>>(
      m, "PlanningContext", "What a term can be made of at one planning step, in W.")
      .def_property_readonly(
          "x0", [](const ProblemSpecification& s) { return array_of(s.x0); }, "(nx,)")
      .def_property_readonly(
          "u_previous", [](const ProblemSpecification& s) { return array_of(s.u_previous); },
          "(nu,)")
      .def_readonly("N", &ProblemSpecification::N, "Stages.")
      .def_readonly("M", &ProblemSpecification::M, "Knots.")
      .def_readonly("dt", &ProblemSpecification::dt, "[s]")
      .def_property_readonly(
          "ground", [](const ProblemSpecification& s) { return cells_of(*s.ground); },
          "(ny, nx) uint8: 0 unknown, 1 free, 2 occupied.")
      .def_property_readonly(
          "extent", [](const ProblemSpecification& s) { return extent_of(s.ground->frame()); },
          kExtent)
      .def_property_readonly(
          "landmarks", [](const ProblemSpecification& s) { return positions_of(s.landmarks); },
          "(L, 3) [m]")
      .def_property_readonly(
          "targets",
          [](const ProblemSpecification& s) {
            const auto& targets = s.targets.targets;
            Numbers array(std::vector<py::ssize_t>{static_cast<py::ssize_t>(targets.size()), 4});
            double* out = array.mutable_data();
            for (const ExplorationTarget& t : targets) {
              out = std::copy_n(t.position.data(), 3, out);
              *out++ = t.mass;
            }
            return array;
          },
          "(T, 4): x, y, z [m] and area [m^2] of the places worth looking at.");
}

void bind_planner_class(py::module_& m) {
  py::class_<PythonPlanner, std::shared_ptr<PythonPlanner>>(
      m, "Planner",
      "Belief in, Plan out. Keeps what it has learned from one step to the next. Waits for a call "
      "on another thread to end.")
      .def(py::init([](const std::shared_ptr<Configuration>& configuration,
                       const py::object& solver, const std::shared_ptr<Registries>& registries) {
             const Configuration c = configuration ? *configuration : read_configuration("");
             std::shared_ptr<const Solver> back_end;
             if (solver.is_none() || py::isinstance<py::str>(solver)) {
               const std::string name = solver.is_none() ? c.solver : std::string(py::str(solver));
               back_end = registries ? registries->solvers.make(name) : make_solver(name);
             } else {
               back_end = std::make_shared<const PythonSolver>(solver);
             }
             return std::make_shared<PythonPlanner>(c, std::move(back_end));
           }),
           py::arg("configuration") = py::none(), py::arg("solver") = py::none(),
           py::arg("registries") = py::none(),
           "solver: a name or a Solver written in Python [the configuration's].")
      .def(
          "plan",
          [](PythonPlanner& p, const Belief& belief, const std::optional<double>& seconds) {
            return with(p, [&](Planner& planner) {
              return seconds ? planner.plan(belief, deadline(checked_deadline(*seconds)))
                             : planner.plan(belief);
            });
          },
          py::arg("belief"), py::arg("deadline") = py::none(),
          "The next Plan. deadline: [s] of the wall clock by which polishing ends [none].")
      .def(
          "set_task",
          [](PythonPlanner& p, const std::string& kind, const std::optional<ArrayLike>& goal) {
            const Task task = task_of(kind, goal);
            const std::string fault =
                with(p, [&](Planner& planner) { return planner.set_task(task); });
            if (!fault.empty()) throw std::invalid_argument(fault);
          },
          py::arg("task"), py::arg("goal") = py::none(),
          "From the next plan on: 'explore', 'go' (goal: x, y [m] and yaw [rad] if it matters), "
          "'return' or 'hold'.")
      .def(
          "check",
          [](PythonPlanner& p, const Plan& plan, int stage, const ArrayLike& previous,
             const Belief& newest, double now) {
            const Twist in_force = twist_of(previous, "previous", Entries::kAny);
            GuardVerdict verdict;
            {
              const py::gil_scoped_release release;
              verdict = p.guard.check(plan, stage, in_force, newest, now);
            }
            py::dict d;
            d["command"] = array_of(verdict.command);
            d["duration"] = verdict.duration;
            d["passed"] = verdict.passed();
            d["reason"] = std::string(to_string(verdict.reason));
            d["detail"] = verdict.detail;
            return d;
          },
          py::arg("plan"), py::arg("stage"), py::arg("previous"), py::arg("newest"), py::arg("now"),
          "The guard, last before the motors: may plan.commands[stage] be sent at time `now` [s], "
          "given the newest Belief and the command (4,) in force? dict: command (4,), finite and "
          "within limits whatever was asked for; duration [s]; passed; reason; detail.")
      .def(
          "problem",
          [](PythonPlanner& p) -> std::shared_ptr<PythonProblem> {
            return with(p, [](Planner& planner) -> std::shared_ptr<PythonProblem> {
              if (!planner.problem()) return nullptr;
              return python_problem(planner.problem(), {{std::string("prospect ") + kVersion, "", 0,
                                                         0, planner.global_plan()->stamp},
                                                        *planner.specification(),
                                                        planner.seeds(),
                                                        std::nullopt});
            });
          },
          "The Problem that the last step solved, which begins at its best seed; None if it met "
          "none.")
      .def_property_readonly(
          "target",
          [](PythonPlanner& p) -> py::object {
            const auto global = with(p, [](Planner& planner) { return planner.global_plan(); });
            if (!global || !global->target) return py::none();
            return array_of(Eigen::VectorXd(global->target->viewpoint));
          },
          "(2,) [m]: the viewpoint where the frontiers want the robot after the last step; None: "
          "nowhere.")
      .def_property_readonly(
          "cost_to_go",
          [](PythonPlanner& p) -> py::object {
            const auto global = with(p, [](Planner& planner) { return planner.global_plan(); });
            if (!global) return py::none();
            const CostToGo& V = *global->cost_to_go;
            const GridFrame& f = V.frame();
            return py::make_tuple(array_of(V.cells().data.data(), {f.height, f.width}),
                                  extent_of(f));
          },
          "(ny, nx) [s at full speed] and its extent [m] after the last step; None before.");
}

}  // namespace

void bind_planner(py::module_& m) {
  bind_configuration(m);
  bind_planning_context(m);
  bind_belief(m);
  bind_plan(m);
  bind_planner_class(m);
}

}  // namespace prospect::python
