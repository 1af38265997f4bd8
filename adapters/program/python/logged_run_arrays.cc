// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/python/logged_run_arrays.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/mission_topics.h"
#include "adapters/missions/log/logged_run.h"
#include "adapters/missions/run/step_row.h"
#include "adapters/missions/run/summary.h"
#include "adapters/program/python/arrays.h"
#include "adapters/program/python/ground_arrays.h"

namespace prospect::python {
namespace {

Numbers trajectory(const std::vector<StepRecord>& steps, Pose StepRecord::*pose) {
  Numbers array(std::vector<py::ssize_t>{static_cast<py::ssize_t>(steps.size()), 8});
  double* to = array.mutable_data();
  for (const StepRecord& step : steps) {
    const Eigen::Vector3d& p = (step.*pose).position;
    const double half = 0.5 * (step.*pose).yaw;
    for (const double value :
         {step.time, p.x(), p.y(), p.z(), 0.0, 0.0, std::sin(half), std::cos(half)}) {
      *to++ = value;
    }
  }
  return array;
}

py::list plans_of(const std::vector<StepRecord>& steps) {
  py::list plans;
  for (const StepRecord& step : steps) {
    Numbers plan(std::vector<py::ssize_t>{static_cast<py::ssize_t>(step.horizon.size()), 4});
    double* to = plan.mutable_data();
    for (const Pose& x : step.horizon) {
      to = std::copy_n(x.position.data(), 3, to);
      *to++ = x.yaw;
    }
    plans.append(plan);
  }
  return plans;
}

/// The ground map after the last step.
GroundMap last_ground(const RunRecord& record) {
  GroundMap ground(GridFrame{record.resolution, 0, 0, 0, 0});
  for (const StepRecord& step : record.steps) {
    for (const auto& [cell, state] : step.map_changes) ground.set(cell, state);
  }
  return ground;
}

}  // namespace

py::dict logged_run_arrays(const std::string& path) {
  LoggedRun run;
  BagFile::Fields info;
  bool ended = false;
  {
    const py::gil_scoped_release release;
    run = read_logged_run(path);
    const BagFile bag = BagFile::open(path);
    if (const BagFile::Fields* fields = bag.metadata(topic::kRun)) info = *fields;
    ended = bag.metadata(topic::kSummary) != nullptr;
  }
  const std::vector<StepRecord>& steps = run.record.steps;
  const StepColumns columns = step_columns(steps);
  std::string rows = step_header(columns), timing = timing_header();
  for (const StepRecord& step : steps) {
    rows += step_row(step, columns);
    timing += timing_row(step);
  }
  const py::tuple ground = ground_arrays(last_ground(run.record));
  py::dict arrays;
  arrays["info"] = info;
  arrays["summary"] = ended ? summary_json(run.record.summary) : "";
  arrays["steps"] = rows;
  arrays["timing"] = timing;
  arrays["true"] = trajectory(steps, &StepRecord::true_pose);
  arrays["estimated"] = trajectory(steps, &StepRecord::estimated_pose);
  arrays["plans"] = plans_of(steps);
  arrays["ground"] = ground[0];
  arrays["extent"] = ground[1];
  arrays["notes"] = run.notes;
  return arrays;
}

}  // namespace prospect::python
