// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

/// The parts of the module: each adds its classes and functions. Order matters: docstrings name
/// types by what is bound before.
namespace prospect::python {

void bind_problem(pybind11::module_& m);
void bind_solver(pybind11::module_& m);
void bind_planner(pybind11::module_& m);

/// Of each class of the module that pybind11 made: to pickle or copy an object is refused in words.
void refuse_copies(pybind11::module_& m);

}  // namespace prospect::python
