// SPDX-License-Identifier: Apache-2.0
#include <pybind11/pybind11.h>

#include <stdexcept>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/printable_text.h"
#include "adapters/program/python/bindings.h"
#include "models/version.h"

PYBIND11_MODULE(_core, m) {
  m.doc() = "Problems, solvers and planners of Prospect.";
  m.attr("__version__") = prospect::kVersion;
  // All bad input is a ValueError; a line each says what, where, and what was expected.
  pybind11::register_exception_translator([](std::exception_ptr p) {
    try {
      if (p) std::rethrow_exception(p);
    } catch (const prospect::InputError& e) {
      PyErr_SetString(PyExc_ValueError, prospect::printable(e.what()).c_str());
    } catch (const std::invalid_argument& e) {
      // What it names may be no text of Python's, such as a path of any bytes.
      PyErr_SetString(PyExc_ValueError, prospect::printable(e.what()).c_str());
    }
  });
  prospect::python::bind_problem(m);
  prospect::python::bind_solver(m);
  prospect::python::bind_planner(m);
  prospect::python::refuse_copies(m);
}
