// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace prospect::python {

/// The log of a mission (.mcap) in arrays and texts: a dict of
///   info: dict of str, as it was started; summary: str, JSON, "" of a log that ends early;
///   steps, timing: str, what steps.csv and timing.csv of the run hold;
///   true, estimated: (K, 8), a row a step, as trajectory_true.tum has them;
///   plans: list of K arrays (N+1, 4), predicted x, y, z [m], yaw [rad];
///   ground: (ny, nx) uint8, 0 unknown, 1 free, 2 occupied, row j at y, as the last step knew it;
///   extent: left, right, bottom, top [m] of it; notes: list of str, what the log lacks.
/// Throws as read_logged_run(). Gives up the GIL while it reads.
pybind11::dict logged_run_arrays(const std::string& path);

}  // namespace prospect::python
