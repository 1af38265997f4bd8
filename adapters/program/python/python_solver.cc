// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/python/python_solver.h"

#include "adapters/program/python/arrays.h"

namespace prospect::python {
namespace {

std::string text_of(const py::object& object, const char* key, const std::string& whose) {
  const py::object text = py::getattr(object, key, py::none());
  if (!py::isinstance<py::str>(text) || std::string(py::str(text)).empty()) {
    throw std::invalid_argument(whose + " has no " + key + "; expected an attribute `" + key +
                                "` of type str");
  }
  return py::str(text);
}

}  // namespace

OptionValue option_of(const py::handle& value, const std::string& name) {
  if (py::isinstance<py::str>(value)) return std::string(py::str(value));
  if (PyIndex_Check(value.ptr())) {
    return whole_of(value, "option '" + name + "'");
  }
  if (PyNumber_Check(value.ptr())) {
    return number_of(py::reinterpret_borrow<py::object>(value), "option '" + name + "'");
  }
  throw std::invalid_argument("option '" + name + "' is " + std::string(py::repr(value)) +
                              "; expected a number or a text");
}

void OpenSolve::evaluate(const Eigen::VectorXd& x, Evaluate what) const {
  Evaluator& e = evaluator();
  EvaluationOutcome outcome;
  {
    const py::gil_scoped_release release;
    outcome = e.evaluate(x, what);
  }
  if (outcome == EvaluationOutcome::kStopped) throw SolveStopped();
}

PythonSolver::PythonSolver(const py::object& object)
    : name_(
          text_of(object, "name", "a solver (" + std::string(py::str(py::type::of(object))) + ")")),
      description_(text_of(object, "description", "solver '" + name_ + "'")),
      options_(common_options()),
      object_(object, name_) {
  const py::object given = py::getattr(object, "options", py::dict());
  if (!py::isinstance<py::dict>(given)) {
    throw std::invalid_argument("solver '" + name_ +
                                "': options is no dict; expected NAME: "
                                "(DEFAULT, SENTENCE)");
  }
  for (const auto& [key, value] : py::reinterpret_borrow<py::dict>(given)) {
    const std::string option = py::str(key);
    if (!py::isinstance<py::tuple>(value) || py::len(value) != 2) {
      throw std::invalid_argument("solver '" + name_ + "': option '" + option +
                                  "' is no pair; expected (DEFAULT, SENTENCE)");
    }
    const py::tuple pair = py::reinterpret_borrow<py::tuple>(value);
    options_.push_back({option, option_of(pair[0], option), py::str(pair[1])});
  }
  gradient_ = py::bool_(py::getattr(object, "needs_gradient", py::bool_(true)));
  constraints_ = py::bool_(py::getattr(object, "takes_constraints", py::bool_(true)));
  if (py::getattr(object, "run", py::none()).is_none()) {
    throw std::invalid_argument("solver '" + name_ + "': has no method `run`; expected one");
  }
}

std::string PythonSolver::explain_unsupported(const Problem& problem) const {
  if (!constraints_ && problem.num_constraints() > 0) {
    return "the problem has constraints, which " + name_ + " does not take";
  }
  return gradient_ ? explain_no_gradient(problem) : std::string();
}

Result PythonSolver::run(Evaluator& evaluator, const OptionSet& options, const WarmStart& warm,
                         const Eigen::VectorXd& start) const {
  return object_("run", [&](const py::object& object) -> Result {
    const auto solve = std::make_shared<OpenSolve>(evaluator, start);
    struct Closed {
      OpenSolve& solve;
      ~Closed() { solve.close(); }
    } const closed{*solve};
    py::dict values;
    for (const OptionInfo& info : options_) {
      std::visit([&](const auto& value) { values[info.name.c_str()] = value; },
                 options.value(info.name));
    }
    try {
      const py::object result = object.attr("run")(solve, values, warm);
      if (!py::isinstance<Result>(result)) {
        throw std::runtime_error(name_ +
                                 ".run: gave no Result; expected what evaluator.finish() gives");
      }
      return result.cast<Result>();
    } catch (const py::error_already_set& error) {
      const py::object stopped = py::module_::import("prospect._core").attr("Stopped");
      if (!error.matches(stopped)) throw;
      // What ended the solve goes before what is said here.
      const py::gil_scoped_release release;
      return evaluator.finish(StopReason::kConverged, false, "", {});
    }
  });
}

}  // namespace prospect::python
