#include <pybind11/pybind11.h>

#include "adapters/formats/files/input_error.h"
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
      PyErr_SetString(PyExc_ValueError, e.what());
    }
  });
  prospect::python::bind_problem(m);
  prospect::python::bind_solver(m);
  prospect::python::bind_planner(m);
  prospect::python::refuse_copies(m);
}
