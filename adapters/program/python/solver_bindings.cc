// SPDX-License-Identifier: Apache-2.0
#include <pybind11/functional.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "adapters/missions/config/registries.h"
#include "adapters/program/python/arrays.h"
#include "adapters/program/python/bindings.h"
#include "adapters/program/python/callback.h"
#include "adapters/program/python/python_problem.h"
#include "adapters/program/python/python_solver.h"
#include "adapters/program/python/python_term.h"
#include "solvers/load_plugin.h"

namespace prospect::python {
namespace {

Eigen::VectorXd point_of(const OpenSolve& solve, const ArrayLike& x) {
  return vector_of(x, solve.evaluator().num_variables(), "x", Entries::kAny);
}

/// The stop condition of a solve that Python waits for: its deadline, what `cancelled` says, and
/// Ctrl-C. Asked by the thread that solves, or by one of its threads at a time.
class Interrupts {
 public:
  explicit Interrupts(const py::object& cancelled)
      : cancelled_(cancelled.is_none() ? nullptr : shared_object(cancelled)) {}

  StopRequest operator()() {
    const auto now = std::chrono::steady_clock::now();
    // Python is asked seldom: an evaluation takes microseconds.
    if (now < next_) return StopRequest::kNone;
    next_ = now + std::chrono::milliseconds(20);
    const py::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() != 0) {
      error_ = std::make_exception_ptr(py::error_already_set());
      return StopRequest::kCancelled;
    }
    try {
      if (cancelled_ && py::bool_((*cancelled_)())) return StopRequest::kCancelled;
    } catch (...) {
      error_ = std::current_exception();
      return StopRequest::kCancelled;
    }
    return StopRequest::kNone;
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::shared_ptr<py::object> cancelled_;
  std::chrono::steady_clock::time_point next_;
  std::exception_ptr error_;
};

std::shared_ptr<const Solver> solver_of(const py::object& solver,
                                        const std::shared_ptr<Registries>& registries) {
  if (py::isinstance<py::str>(solver)) {
    const std::string name = py::str(solver);
    return registries ? registries->solvers.make(name) : make_solver(name);
  }
  return std::make_shared<const PythonSolver>(solver);
}

WarmStart start_of(const py::object& start, const PythonProblem& problem) {
  if (start.is_none()) return problem.start();
  if (py::isinstance<WarmStart>(start)) return start.cast<WarmStart>();
  WarmStart warm = problem.start();
  warm.x = vector_of(ArrayLike{start}, problem.problem().num_variables(), "start");
  return warm;
}

/// The message of an exception SolveError.
struct SolveError : std::runtime_error {
  SolveError(const std::string& text, Result r) : std::runtime_error(text), result(std::move(r)) {}
  Result result;
};

Result solve(const PythonProblem& problem, const py::object& solver, const py::object& start,
             const std::optional<double>& seconds, const std::shared_ptr<Registries>& registries,
             const py::object& cancelled, const py::kwargs& given) {
  const std::shared_ptr<const Solver> back_end = solver_of(solver, registries);
  Options options;
  for (const auto& [key, value] : given) {
    const std::string name = py::str(key);
    options[name] = option_of(value, name);
  }
  // Without those that a back end takes and does not list, which it checks itself.
  const OptionSet listed(back_end->options(), options);
  const WarmStart warm = start_of(start, problem);
  auto interrupts = std::make_shared<Interrupts>(cancelled);
  Result result;
  {
    const py::gil_scoped_release release;
    const std::string reason = back_end->explain_unsupported(problem.problem());
    if (!reason.empty()) throw std::invalid_argument(back_end->name() + ": " + reason);
    const StopCondition stop = (seconds ? deadline(checked_deadline(*seconds)) : StopCondition()) ||
                               StopCondition([interrupts] { return (*interrupts)(); });
    result = back_end->solve(problem.problem(), warm, options, stop);
  }
  interrupts->rethrow();
  if (result.stop == StopReason::kError) {
    if (!listed.error().empty() && result.detail.find(listed.error()) != std::string::npos) {
      throw std::invalid_argument(result.detail);
    }
    throw SolveError(result.detail, result);
  }
  return result;
}

py::object option_value(const OptionValue& value) {
  return std::visit([](const auto& v) -> py::object { return py::cast(v); }, value);
}

std::vector<TermOption> term_options(const py::dict& given, const std::string& term) {
  std::vector<TermOption> options;
  for (const auto& [key, value] : given) {
    const std::string name = py::str(key);
    if (!py::isinstance<py::tuple>(value) || py::len(value) != 5) {
      throw std::invalid_argument("term '" + term + "': option '" + name +
                                  "' is no tuple of five; expected (DEFAULT, LEAST, MOST, UNIT, "
                                  "SENTENCE)");
    }
    const auto t = py::reinterpret_borrow<py::tuple>(value);
    const auto number = [&](int n) {
      return number_of(t[static_cast<std::size_t>(n)],
                       "term '" + term + "': option '" + name + "'");
    };
    options.push_back({name, number(0), number(1), number(2), py::str(t[3]), py::str(t[4])});
  }
  return options;
}

void add_term(Registries& r, const std::string& name, const py::object& make,
              const py::dict& options, const std::string& description, int version) {
  TermEntry entry{name, description};
  entry.options = term_options(options, name);
  entry.version = version;
  entry.make = [callback = Callback(make, name)](const TermOptions& values,
                                                 const TermContext& context) {
    return callback("", [&](const py::object& factory) -> std::shared_ptr<const Term> {
      // A copy: the term may keep it longer than the step lasts. Its maps are shared.
      return std::make_shared<const PythonTerm>(
          factory(values, std::make_shared<ProblemSpecification>(context.specification)));
    });
  };
  r.terms.add(std::move(entry));
}

void add_problem(Registries& r, const std::string& set, const std::string& name,
                 const std::shared_ptr<PythonProblem>& problem, const std::optional<double>& best,
                 const std::string& description) {
  ProblemEntry entry;
  entry.set = set;
  entry.name = name;
  entry.set_description = description;
  entry.make = [problem] { return problem->problem().definition(); };
  if (problem->start().x.size() > 0) entry.start = [problem] { return problem->start().x; };
  entry.best_known = best;
  r.problems.add(std::move(entry));
}

py::list list_solvers_of(const Registries& r) {
  py::list list;
  for (const SolverInfo& info : r.solvers.list()) {
    py::dict d, options;
    for (const OptionInfo& o : info.options) {
      options[o.name.c_str()] = py::make_tuple(option_value(o.fallback), o.description);
    }
    d["name"] = info.name;
    d["description"] = info.description;
    d["available"] = info.available;
    d["options"] = options;
    list.append(d);
  }
  return list;
}

py::list list_terms_of(const Registries& r) {
  py::list list;
  for (const auto& entry : r.terms.list()) {
    py::dict d, options;
    for (const TermOption& o : entry->options) {
      options[o.name.c_str()] = py::make_tuple(o.fallback, o.least, o.most, o.unit, o.description);
    }
    d["name"] = entry->name;
    d["description"] = entry->description;
    d["built_in"] = entry->built_in;
    d["options"] = options;
    list.append(d);
  }
  return list;
}

void bind_results(py::module_& m) {
  py::enum_<StopReason>(m, "StopReason", "Why a solve ended; says nothing of how good x is.")
      .value("CONVERGED", StopReason::kConverged)
      .value("DEADLINE", StopReason::kDeadline)
      .value("ITERATION_LIMIT", StopReason::kIterationLimit)
      .value("CANCELLED", StopReason::kCancelled)
      .value("NUMERICAL_TROUBLE", StopReason::kNumericalTrouble)
      .value("INFEASIBLE", StopReason::kInfeasible)
      .value("UNBOUNDED", StopReason::kUnbounded)
      .value("ERROR", StopReason::kError);
  py::enum_<Quality>(m, "Quality", "How good x is; says nothing of why the solve ended.")
      .value("FEASIBLE_OPTIMUM", Quality::kFeasibleOptimum)
      .value("FEASIBLE", Quality::kFeasible)
      .value("INFEASIBLE", Quality::kInfeasible)
      .value("NONE", Quality::kNone);

  py::class_<WarmStart> start(m, "WarmStart",
                              "Where a solve begins, and what one hands to the next: copies come "
                              "out, assigned arrays are copied. Empty arrays: none.");
  start.def(py::init<>());
  const auto vector = [&](const char* name, Eigen::VectorXd WarmStart::*member, const char* text) {
    start.def_property(
        name, [member](const WarmStart& w) { return array_of(w.*member); },
        [member, name](WarmStart& w, const ArrayLike& v) { w.*member = vector_of(v, -1, name); },
        text);
  };
  vector("x", &WarmStart::x, "(n,): the point.");
  vector("multipliers", &WarmStart::lambda, "(m,): of the constraints, >= 0.");
  vector("z_lower", &WarmStart::z_lower, "(n,): multipliers of the lower bounds, >= 0.");
  vector("z_upper", &WarmStart::z_upper, "(n,): multipliers of the upper bounds, >= 0.");
  start
      .def_property(
          "seeds",
          [](const WarmStart& w) { return array_of(Eigen::MatrixXd(w.seeds.transpose())); },
          [](WarmStart& w, const ArrayLike& v) { w.seeds = transposed(v, -1, -1, "seeds"); },
          "(S, n): further points, the likely best first, for back ends that compare starts.")
      .def_readwrite("mu", &WarmStart::mu, "Barrier parameter; 0: unknown.")
      .def_readwrite("time", &WarmStart::time, "[s], start of the horizon that x belongs to.")
      .def("__repr__", [](const WarmStart& w) {
        return "WarmStart(n=" + std::to_string(w.x.size()) +
               ", seeds=" + std::to_string(w.seeds.cols()) + ")";
      });

  py::class_<Result>(m, "Result", "What a solve came to. Arrays are copies.")
      .def_readonly("stop", &Result::stop, "StopReason.")
      .def_readonly("quality", &Result::quality, "Quality.")
      .def_property_readonly(
          "x", [](const Result& r) { return array_of(r.x); },
          "(n,): the best of all points evaluated.")
      .def_readonly("cost", &Result::cost)
      .def_readonly("violation", &Result::violation, "max(0, -c) over all constraints c.")
      .def_readonly("explanation", &Result::explanation, "Explanation of x.")
      .def_property_readonly(
          "next", [](const Result& r) { return r.next; }, "WarmStart for the next solve.")
      .def_property_readonly("cost_evaluations",
                             [](const Result& r) { return r.counters.cost_evaluations; })
      .def_property_readonly("gradient_evaluations",
                             [](const Result& r) { return r.counters.gradient_evaluations; })
      .def_property_readonly("iterations", [](const Result& r) { return r.counters.iterations; })
      .def_readonly("seconds", &Result::seconds, "Of the wall clock.")
      .def_readonly("detail", &Result::detail, "One sentence.")
      .def_property_readonly(
          "trace",
          [](const Result& r) {
            Numbers trace(std::vector<py::ssize_t>{static_cast<py::ssize_t>(r.trace.size()), 4});
            auto out = trace.mutable_unchecked<2>();
            py::ssize_t row = 0;
            for (const Improvement& i : r.trace) {
              out(row, 0) = i.seconds;
              out(row, 1) = i.evaluations;
              out(row, 2) = i.cost;
              out(row++, 3) = i.violation;
            }
            return trace;
          },
          "(K, 4): seconds, cost evaluations, cost, violation of each improvement; with the option "
          "trace=1.")
      .def("__repr__", [](const Result& r) {
        char text[160];
        std::snprintf(text, sizeof text, "Result(cost=%.6g, violation=%.2g, %s, %s)", r.cost,
                      r.violation, std::string(to_string(r.stop)).c_str(),
                      std::string(to_string(r.quality)).c_str());
        return std::string(text);
      });
}

void bind_evaluator(py::module_& m) {
  using E = OpenSolve;
  py::class_<E, std::shared_ptr<E>>(
      m, "Evaluator",
      "What a solver written in Python sees of its solve, valid within run() only. Points x have "
      "the shape (n,): the variables that are not fixed, clamped into the bounds. It keeps the "
      "best of all points, counts, and raises Stopped once the solve must end. A point that was "
      "asked for last costs nothing again.")
      .def_property_readonly("n", [](const E& s) { return s.evaluator().num_variables(); })
      .def_property_readonly("m", [](const E& s) { return s.evaluator().num_constraints(); })
      .def_property_readonly(
          "lower", [](const E& s) { return array_of(s.evaluator().lower()); }, "(n,)")
      .def_property_readonly(
          "upper", [](const E& s) { return array_of(s.evaluator().upper()); }, "(n,)")
      .def_property_readonly(
          "start", [](const E& s) { return array_of(s.start()); },
          "(n,): where to begin; evaluated already.")
      .def_property_readonly("evaluations_left",
                             [](const E& s) { return s.evaluator().evaluations_left(); })
      .def(
          "cost",
          [](const E& s, const ArrayLike& x) {
            s.evaluate(point_of(s, x), Evaluate::kValue);
            return s.evaluator().cost();
          },
          py::arg("x"), "The cost; at a point that cannot be evaluated a smooth, high stand-in.")
      .def(
          "cost_and_gradient",
          [](const E& s, const ArrayLike& x) {
            s.evaluate(point_of(s, x), Evaluate::kGradient);
            return py::make_tuple(s.evaluator().cost(), array_of(s.evaluator().gradient()));
          },
          py::arg("x"), "The cost and its gradient (n,).")
      .def(
          "constraints",
          [](const E& s, const ArrayLike& x) {
            s.evaluate(point_of(s, x), Evaluate::kValue);
            return array_of(s.evaluator().constraints());
          },
          py::arg("x"), "(m,): feasible where all are >= 0.")
      .def(
          "jacobian",
          [](const E& s, const ArrayLike& x) {
            s.evaluate(point_of(s, x), Evaluate::kGradient);
            return array_of(s.evaluator().jacobian());
          },
          py::arg("x"), "(m, n): of the constraints.")
      .def(
          "evaluate_batch",
          [](const E& s, const ArrayLike& X) {
            Evaluator& e = s.evaluator();
            const Eigen::MatrixXd points = transposed(X, -1, e.num_variables(), "X", Entries::kAny);
            Eigen::ArrayXd cost, violation;
            int done;
            {
              const py::gil_scoped_release release;
              done = e.evaluate_batch(points, cost, violation);
            }
            if (done < points.cols()) throw SolveStopped();
            return py::make_tuple(array_of(cost.data(), {cost.size()}),
                                  array_of(violation.data(), {violation.size()}));
          },
          py::arg("X"), "Cost (B,) and violation (B,) of a batch (B, n), a candidate a row.")
      .def(
          "should_stop",
          [](const E& s) {
            Evaluator& e = s.evaluator();
            const py::gil_scoped_release release;
            return e.should_stop();
          },
          "Whether the solve must end, without an evaluation.")
      .def("count_iteration", [](const E& s) { s.evaluator().count_iteration(); })
      .def_property_readonly(
          "incumbent",
          [](const E& s) -> py::object {
            if (!s.evaluator().has_incumbent()) return py::none();
            return array_of(s.evaluator().incumbent());
          },
          "(n,): the best point so far; None before there is one.")
      .def_property_readonly("incumbent_cost",
                             [](const E& s) { return s.evaluator().incumbent_cost(); })
      .def(
          "finish",
          [](const E& s, StopReason stop, bool optimum, const std::string& detail,
             const std::optional<WarmStart>& next) {
            Evaluator& e = s.evaluator();
            const py::gil_scoped_release release;
            return e.finish(stop, optimum, detail, next.value_or(WarmStart{}));
          },
          py::arg("stop") = StopReason::kConverged, py::arg("optimum") = false,
          py::arg("detail") = "", py::arg("next") = py::none(),
          "The Result, which run() must return. optimum: the method's own test of optimality holds "
          "at the best point.");
}

}  // namespace

void bind_solver(py::module_& m) {
  bind_results(m);
  bind_evaluator(m);

  py::class_<Registries, std::shared_ptr<Registries>>(
      m, "Registries",
      "The back ends, terms and problems that can be had by name: the built-in ones, and those "
      "that are added. Not to be changed while it is in use.")
      .def(py::init<>())
      .def(
          "add_solver",
          [](Registries& r, const py::object& solver) {
            const auto made = std::make_shared<const PythonSolver>(solver);
            r.solvers.add(made, made->description());
          },
          py::arg("solver"), "A Solver written in Python, by its name.")
      .def("add_term", &add_term, py::arg("name"), py::arg("make"), py::kw_only(),
           py::arg("options") = py::dict(), py::arg("description") = "", py::arg("version") = 1,
           "A term by name. make(options, context) is called at each planning step and gives a "
           "Term; options: dict of numbers, context: PlanningContext. options here: NAME: "
           "(DEFAULT, LEAST, MOST, UNIT, SENTENCE). version: of the options.")
      .def("add_problem", &add_problem, py::arg("set"), py::arg("name"), py::arg("problem"),
           py::kw_only(), py::arg("best_known") = py::none(), py::arg("description") = "",
           "A Problem of a set, to measure back ends on; they begin at its start.")
      .def(
          "load_plugin",
          [](Registries& r, const std::filesystem::path& path) {
            return load_plugin(path.string(), {r.solvers, r.terms, r.problems});
          },
          py::arg("path"), "Adds those of a shared library; gives '' or a warning in one line.")
      .def("solvers", &list_solvers_of,
           "list of dict: name, description, available, options (NAME: (default, sentence)).")
      .def("terms", &list_terms_of,
           "list of dict: name, description, built_in, options (NAME: (default, least, most, unit, "
           "sentence)).")
      .def(
          "sets", [](const Registries& r) { return r.problems.sets(); },
          "Names of the sets of problems that were added.");

  m.def("solve", &solve, py::arg("problem"), py::arg("solver") = "nlopt", py::kw_only(),
        py::arg("start") = py::none(), py::arg("deadline") = py::none(),
        py::arg("registries") = py::none(), py::arg("cancelled") = py::none(),
        "Solves a Problem by a back end: a name ('nlopt:LD_SLSQP', 'ipopt', 'ceres', 'hybrid', "
        "'sampling', or one of registries) or a Solver written in Python. start: (n,) or WarmStart "
        "[problem.start]. deadline: [s] of the wall clock [none]. cancelled: a function, asked now "
        "and then; True ends the solve. Further keywords are options of the back end "
        "(max_evaluations, tolerance, seed, ...). Ctrl-C ends it with KeyboardInterrupt.\n\n"
        "Gives a Result also where the deadline struck: see its stop and quality. ValueError for "
        "an argument, an option or a problem that the back end does not take; SolveError, with "
        "the Result as `result`, where a term or the back end failed.");

  for (const char* name : {"SolveError", "Stopped", "CallbackError"}) {
    m.attr(name) = py::reinterpret_steal<py::object>(PyErr_NewException(
        (std::string("prospect._core.") + name).c_str(), PyExc_RuntimeError, nullptr));
  }
  py::register_exception_translator([](std::exception_ptr p) {
    const auto type = [](const char* name) {
      return py::module_::import("prospect._core").attr(name);
    };
    try {
      if (p) std::rethrow_exception(p);
    } catch (const SolveError& e) {
      py::object error = type("SolveError")(e.what());
      error.attr("result") = e.result;
      PyErr_SetObject(type("SolveError").ptr(), error.ptr());
    } catch (const SolveStopped& e) {
      PyErr_SetString(type("Stopped").ptr(), e.what());
    } catch (const CallbackError& e) {
      py::object error = type("CallbackError")(e.what());
      error.attr("__cause__") = e.exception();
      PyErr_SetObject(type("CallbackError").ptr(), error.ptr());
    }
  });
}

}  // namespace prospect::python
