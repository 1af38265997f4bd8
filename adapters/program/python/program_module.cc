// SPDX-License-Identifier: Apache-2.0
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/missions/config/registries.h"
#include "adapters/program/cli/command_line.h"
#include "adapters/program/python/bindings.h"
#include "adapters/program/python/callback.h"
#include "adapters/program/python/ground_arrays.h"
#include "adapters/program/python/logged_run_arrays.h"
#include "adapters/program/python/motion_arrays.h"
#include "adapters/program/python/simulation.h"
#include "engine/maps/map_projection.h"

namespace prospect::python {
namespace {

/// Adds what a file of Python offers: its function prospect_plugin(registries). All or nothing.
std::string load_python(const std::string& path, const PluginTargets& targets,
                        const py::object& run_file) {
  auto registries = std::make_shared<Registries>(targets.solvers);
  registries->terms = targets.terms;
  registries->problems = targets.problems;
  try {
    Callback(run_file, "prospect_plugin")("",
                                          [&](const py::object& run) { run(path, registries); });
  } catch (const std::exception& e) {
    throw std::invalid_argument("plug-in '" + path + "': " + e.what());
  }
  targets.solvers = registries->solvers;
  targets.terms = registries->terms;
  targets.problems = registries->problems;
  return "";
}

int run_program(const std::vector<std::string>& arguments, const py::object& run_file,
                const std::vector<std::string>& program) {
  std::vector<std::string> words = {"prospect"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const py::gil_scoped_release release;
  return run_command_line(
      static_cast<int>(words.size()), argv.data(),
      [&](const std::string& path, const PluginTargets& targets) {
        return path.ends_with(".py") ? load_python(path, targets, run_file)
                                     : load_plugin(path, targets);
      },
      program);
}

}  // namespace
}  // namespace prospect::python

PYBIND11_MODULE(_program, m) {
  using namespace prospect;
  using namespace prospect::python;
  m.doc() = "The simulator and the command line of Prospect.";
  py::module_::import("prospect._core");  // the classes that are handed over

  const auto truth = [](auto member) {
    return [member](const Simulation& s) { return (s.truth().*member)(); };
  };
  py::class_<Simulation>(m, "Simulation",
                         "A simulated robot that is driven step by step, as fast as the machine "
                         "is. The planner sees belief() alone; the truth is for evaluation.")
      .def(py::init([](const std::filesystem::path& world,
                       const std::shared_ptr<Configuration>& given, std::uint64_t seed) {
             const Configuration configuration = given ? *given : read_configuration("");
             const py::gil_scoped_release release;
             return std::make_unique<Simulation>(world.string(), configuration, seed);
           }),
           py::arg("world") = "office", py::arg("configuration") = py::none(), py::arg("seed") = 1,
           "world: a built-in name or a file, as `prospect explore` takes it. seed: of all noise.")
      .def("reset", &Simulation::reset, py::arg("seed") = 1,
           py::call_guard<py::gil_scoped_release>(),
           "Everything from the start. A planner knows nothing of it: make a new one.")
      .def("belief", &Simulation::belief, py::call_guard<py::gil_scoped_release>(),
           "The Belief now, with the command in force. No time passes.")
      .def(
          "apply",
          [](Simulation& s, const ArrayLike& command, double duration) {
            const Twist twist = twist_of(command, "command", Entries::kAny);
            if (!(duration >= 0.0 && duration <= 3600.0)) {
              throw std::invalid_argument("duration: is " + number_text(duration) +
                                          " s; expected 0 to 3600 s");
            }
            const py::gil_scoped_release release;
            s.apply(twist, duration);
          },
          py::arg("command"), py::arg("duration"),
          "Executes a body velocity (4,), vx, vy, vz [m/s], yaw rate [rad/s], for duration [s], "
          "without a guard. vz counts for nothing. A command that is not finite is a stop.")
      .def(
          "drive",
          [](Simulation& s, const Plan& plan) {
            GuardVerdict verdict;
            {
              const py::gil_scoped_release release;
              verdict = s.drive(plan);
            }
            return verdict.passed() ? std::string() : std::string(verdict.detail);
          },
          py::arg("plan"),
          "Executes the committed stages of a Plan, each past the guard. '' or why the guard "
          "braked instead.")
      .def_property_readonly("time", truth(&Simulator::time), "[s] since the start.")
      .def_property_readonly(
          "true_pose", [](const Simulation& s) { return array_of(s.truth().true_pose()); },
          "(4,): x, y, z [m], yaw [rad], in the true world.")
      .def_property_readonly(
          "estimated_pose",
          [](const Simulation& s) { return array_of(s.truth().estimated_pose()); },
          "(4,): what belief() says.")
      .def_property_readonly("localization_error", truth(&Simulator::localization_error),
                             "Distance between the two [m].")
      .def_property_readonly("coverage", truth(&Simulator::coverage),
                             "Share of the reachable area that has been seen.")
      .def_property_readonly("seen_area", truth(&Simulator::seen_area), "[m^2]")
      .def_property_readonly("path_length", truth(&Simulator::path_length), "Driven so far [m].")
      .def_property_readonly("collisions", truth(&Simulator::collisions), "Contacts so far.")
      .def_property_readonly("losses", truth(&Simulator::losses),
                             "How often localization was lost.")
      .def_property_readonly(
          "true_ground",
          [](const Simulation& s) {
            return ground_arrays(project(s.world().voxels, height_slice(s.configuration().robot)));
          },
          "(ny, nx) uint8 (0 unknown, 1 free, 2 occupied) of the true world over the heights of "
          "the body, and its (left, right, bottom, top) [m].")
      .def_property_readonly(
          "configuration",
          [](const Simulation& s) { return std::make_shared<Configuration>(s.configuration()); })
      .def("__repr__", [](const Simulation& s) {
        return "Simulation('" + s.world().name + "', time=" + std::to_string(s.truth().time()) +
               ")";
      });

  m.def(
      "read_log",
      [](const std::filesystem::path& path) { return logged_run_arrays(path.string()); },
      py::arg("path"), "The log of a mission (.mcap): what prospect.Log is made of.");
  m.def("run_program", &run_program, py::arg("arguments"), py::arg("run_file"), py::arg("program"),
        "The command line: gives its exit code. run_file(path, registries) runs a plug-in in "
        "Python. program: the words that start it anew, for missions of studies and replays.");
  refuse_copies(m);
}
