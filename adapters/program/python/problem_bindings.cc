// SPDX-License-Identifier: Apache-2.0
#include <pybind11/functional.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>

#include "adapters/missions/config/registries.h"
#include "adapters/program/python/arrays.h"
#include "adapters/program/python/bindings.h"
#include "adapters/program/python/callback.h"
#include "adapters/program/python/python_problem.h"
#include "adapters/program/python/python_term.h"
#include "adapters/program/python/trajectories.h"
#include "models/make_model.h"
#include "models/nearest_name.h"
#include "problems/function_problem.h"

namespace prospect::python {
namespace {

/// One point of shape (n,), or a candidate a row: (B, n). Where one is not finite, it cannot be
/// evaluated, which its cost says.
struct Points {
  Numbers array;
  bool single;
  Eigen::Map<const Eigen::MatrixXd> columns;  // n x B, of `array`

  Points(const ArrayLike& z, int n)
      : array(numbers_of(z, "z", Entries::kAny)),
        single(array.ndim() == 1),
        columns(array.data(), n, single ? 1 : (array.ndim() == 2 ? array.shape(0) : 0)) {
    if (single) {
      check_shape(array, {n}, "z");
    } else {
      check_shape(array, {-1, n}, "z");
    }
  }
};

Evaluate what_of(const std::string& text) {
  const std::vector<std::string> names = {"score", "value", "gradient", "residuals"};
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (names[n] == text) return static_cast<Evaluate>(n);
  }
  throw std::invalid_argument("what: is '" + text + "'" + expected_one_of(names));
}

Evaluation evaluate(PythonProblem& p, const Points& points, Evaluate what) {
  if (what >= Evaluate::kGradient && points.columns.cols() != 1) {
    throw std::invalid_argument("z: has " + std::to_string(points.columns.cols()) +
                                " candidates; expected one, as derivatives are asked for");
  }
  if (what >= Evaluate::kGradient && !p.problem().has_gradient()) {
    throw std::invalid_argument(
        "problem: a term of it has no gradient; expected one, as "
        "derivatives are asked for");
  }
  if (what == Evaluate::kResiduals && !p.problem().terms_without_residuals().empty()) {
    throw std::invalid_argument("problem: no residuals of " +
                                p.problem().terms_without_residuals() +
                                "; expected costs that are sums of squares or have a lower bound");
  }
  Evaluation out;
  const py::gil_scoped_release release;
  p.evaluate(points.columns, what, out);
  return out;
}

/// A term of a problem with its weight: (term, weight), or the term alone.
ProblemDefinition::WeightedTerm weighted_term(const py::handle& given) {
  if (py::isinstance<py::tuple>(given)) {
    const py::tuple pair = py::reinterpret_borrow<py::tuple>(given);
    if (pair.size() != 2) {
      throw std::invalid_argument("terms: has an entry of " + std::to_string(pair.size()) +
                                  "; expected a term, or (term, weight)");
    }
    return {std::make_shared<PythonTerm>(pair[0]), number_of(pair[1], "weight")};
  }
  return {std::make_shared<PythonTerm>(py::reinterpret_borrow<py::object>(given)), 1.0};
}

std::shared_ptr<PythonProblem> make_own(std::shared_ptr<const MotionModel> model,
                                        const ArrayLike& x0, const py::iterable& terms,
                                        const std::optional<ArrayLike>& u_previous, int N,
                                        double dt, int M, const std::optional<ArrayLike>& start) {
  ProblemDefinition d;
  d.x0 = vector_of(x0, model->nx(), "x0");
  d.u_previous = u_previous ? vector_of(*u_previous, model->nu(), "u_previous")
                            : Eigen::VectorXd::Zero(model->nu()).eval();
  d.model = std::move(model);
  d.N = N;
  d.dt = dt;
  d.M = M;
  for (const py::handle term : terms) d.terms.push_back(weighted_term(term));
  auto problem = std::make_shared<const Problem>(std::move(d));
  WarmStart warm;
  if (start) warm.x = vector_of(*start, problem->num_variables(), "start");
  return std::make_shared<PythonProblem>(std::move(problem), std::move(warm));
}

/// f(u) of Python, as a function of the engine that gives numbers of this shape ({}: one number).
template <typename Result>
std::function<Result(const Eigen::VectorXd&)> function_of(const py::object& f,
                                                          const std::string& name,
                                                          std::vector<py::ssize_t> shape) {
  return [callback = Callback(f, name), name, shape](const Eigen::VectorXd& u) {
    return callback("", [&](const py::object& call) -> Result {
      const py::object given = call(array_of(u));
      if constexpr (std::is_same_v<Result, double>) {
        return number_of(given, name);
      } else {
        const Numbers numbers = numbers_of(ArrayLike{given}, shape, name, Entries::kAny);
        if constexpr (std::is_same_v<Result, Eigen::VectorXd>) {
          return Eigen::Map<const Eigen::VectorXd>(numbers.data(), numbers.size());
        } else {
          return Eigen::Map<const Eigen::MatrixXd>(numbers.data(), shape[1], shape[0]).transpose();
        }
      }
    });
  };
}

std::shared_ptr<PythonProblem> from_functions(const ArrayLike& lower, const ArrayLike& upper,
                                              const py::object& cost, const py::object& gradient,
                                              int rows, const py::object& constraints,
                                              const py::object& jacobian,
                                              const std::optional<ArrayLike>& start,
                                              const std::string& name) {
  FunctionProblem f;
  f.name = name;
  f.lower = vector_of(lower, -1, "lower");
  const py::ssize_t n = f.lower.size();
  if (n == 0) throw std::invalid_argument("lower: has no entries; expected one a variable");
  f.upper = vector_of(upper, n, "upper");
  f.f = function_of<double>(cost, "cost", {});
  if (!gradient.is_none()) f.g = function_of<Eigen::VectorXd>(gradient, "gradient", {n});
  if (rows < 0) throw std::invalid_argument("rows: is negative; expected how many constraints");
  if (rows > 0) {
    if (constraints.is_none() || jacobian.is_none()) {
      throw std::invalid_argument(
          "rows: there are constraints; expected the functions `constraints` and `jacobian`");
    }
    f.rows = rows;
    f.c = function_of<Eigen::VectorXd>(constraints, "constraints", {rows});
    f.J = function_of<Eigen::MatrixXd>(jacobian, "jacobian", {rows, n});
  } else if (!constraints.is_none()) {
    throw std::invalid_argument("rows: is 0, and there are constraints; expected how many");
  }
  WarmStart warm;
  if (start) warm.x = vector_of(*start, n, "start");
  return std::make_shared<PythonProblem>(std::make_shared<const Problem>(f.problem()),
                                         std::move(warm));
}

std::string table(const Explanation& e) {
  std::string text;
  char line[160];
  for (const TermValue& t : e.terms) {
    std::snprintf(line, sizeof line, "%-24s %14.6g [%s]%s\n", t.name.c_str(),
                  t.constraint ? t.raw : t.weighted, t.unit.c_str(), t.constraint ? " >= 0" : "");
    text += line;
  }
  std::snprintf(line, sizeof line, "cost %.6g, violation %.3g", e.cost, e.violation);
  return text + line;
}

void bind_evaluation(py::module_& m) {
  using E = Evaluation;
  const auto vector = [](const py::object& self, const auto& v) {
    return view_of(v.data(), {v.size()}, {1}, self);
  };
  py::class_<E>(m, "Evaluation",
                "What a problem is at B points; n variables, m constraints. The arrays are views "
                "that keep it alive.")
      .def_property_readonly(
          "cost", [=](const py::object& self) { return vector(self, self.cast<const E&>().cost); },
          "(B,): finite; 1e20 where a candidate is not valid.")
      .def_property_readonly(
          "cost_error",
          [=](const py::object& self) { return vector(self, self.cast<const E&>().cost_error); },
          "(B,): bound of the error of a score; 0 of values.")
      .def_property_readonly(
          "valid",
          [](const py::object& self) {
            const E& e = self.cast<const E&>();
            return py::array(py::dtype::of<bool>(), {e.valid.size()}, {1}, e.valid.data(), self);
          },
          "(B,) bool: every term could be evaluated.")
      .def_property_readonly(
          "constraints",
          [](const py::object& self) {
            const auto& c = self.cast<const E&>().constraints;
            return view_of(c.data(), {c.cols(), c.rows()}, {c.rows(), 1}, self);
          },
          "(B, m): feasible where all are >= 0.")
      .def_property_readonly(
          "terms",
          [](const py::object& self) {
            const auto& t = self.cast<const E&>().terms;
            return view_of(t.data(), {t.cols(), t.rows()}, {t.rows(), 1}, self);
          },
          "(B, T): value of each cost, not weighted; 0 of constraints.")
      .def_property_readonly(
          "gradient",
          [=](const py::object& self) { return vector(self, self.cast<const E&>().gradient); },
          "(n,): of the cost; with what='gradient' or more.")
      .def_property_readonly(
          "jacobian",
          [](const py::object& self) {
            const auto& J = self.cast<const E&>().jacobian;
            return view_of(J.data(), {J.rows(), J.cols()}, {1, J.rows()}, self);
          },
          "(m, n): of the constraints; with what='gradient' or more.")
      .def_property_readonly(
          "residuals",
          [=](const py::object& self) { return vector(self, self.cast<const E&>().residuals); },
          "(R,): cost = residual_offset + 1/2 |residuals|^2; with what='residuals'.")
      .def_property_readonly(
          "residual_jacobian",
          [](const py::object& self) {
            const auto& J = self.cast<const E&>().residual_jacobian;
            return view_of(J.data(), {J.rows(), J.cols()}, {J.cols(), 1}, self);
          },
          "(R, n): of the residuals; with what='residuals'.")
      .def_readonly("residual_offset", &E::residual_offset, "With what='residuals'.")
      .def("__repr__", [](const E& e) {
        return "Evaluation(B=" + std::to_string(e.cost.size()) +
               ", m=" + std::to_string(e.constraints.rows()) + ")";
      });

  py::class_<TermValue>(m, "TermValue", "Raw and weighted value of one term at one point.")
      .def_readonly("name", &TermValue::name)
      .def_readonly("unit", &TermValue::unit, "Of the raw value.")
      .def_readonly("raw", &TermValue::raw, "Cost: its value; constraint: its smallest row.")
      .def_readonly("weighted", &TermValue::weighted, "What it adds to the cost.")
      .def_readonly("constraint", &TermValue::constraint)
      .def("__repr__", [](const TermValue& t) {
        return "TermValue(" + t.name + ", raw=" + std::to_string(t.raw) +
               ", weighted=" + std::to_string(t.weighted) + ")";
      });
  py::class_<Explanation>(m, "Explanation", "Every term of a problem at one point.")
      .def_readonly("cost", &Explanation::cost)
      .def_readonly("violation", &Explanation::violation, "max(0, -c) over all constraints c.")
      .def_readonly("terms", &Explanation::terms, "list of TermValue.")
      .def("__str__", &table)
      .def("__repr__", &table);
}

using ProblemClass = py::class_<PythonProblem, std::shared_ptr<PythonProblem>>;

void bind_motion_model(py::module_& m) {
  py::class_<MotionModel, std::shared_ptr<MotionModel>>(
      m, "MotionModel", "Discrete-time motion x' = f(x, u, dt): see prospect.motion_model().")
      .def_property_readonly("name", [](const MotionModel& o) { return std::string(o.name()); })
      .def_property_readonly("nx", &MotionModel::nx, "Entries of a state.")
      .def_property_readonly("nu", &MotionModel::nu, "Entries of an input.")
      .def_property_readonly(
          "lower", [](const MotionModel& o) { return array_of(o.limits().lower); },
          "(nu,): least input.")
      .def_property_readonly(
          "upper", [](const MotionModel& o) { return array_of(o.limits().upper); },
          "(nu,): largest input.")
      .def("__repr__",
           [](const MotionModel& o) { return "MotionModel(" + std::string(o.name()) + ")"; });
  m.def(
      "motion_model",
      [](const std::string& name, const py::kwargs& given) {
        ModelParameters parameters;
        for (const auto& [key, value] : given) {
          const std::string parameter = py::str(key);
          parameters[parameter] = number_of(py::reinterpret_borrow<py::object>(value), parameter);
        }
        return std::const_pointer_cast<MotionModel>(make_model(name, parameters));
      },
      py::arg("name"),
      "A motion model: 'unicycle', 'unicycle_accel', 'holonomic' or 'multirotor', with its limits "
      "as keywords (v_max [m/s], omega_max [rad/s], a_max [m/s^2], ...).");
}

void bind_problem_facts(ProblemClass& problem) {
  problem
      .def_property_readonly(
          "n", [](const PythonProblem& p) { return p.problem().num_variables(); }, "Variables.")
      .def_property_readonly(
          "m", [](const PythonProblem& p) { return p.problem().num_constraints(); }, "Constraints.")
      .def_property_readonly(
          "lower", [](const PythonProblem& p) { return array_of(p.problem().lower()); },
          "(n,): bounds of z.")
      .def_property_readonly(
          "upper", [](const PythonProblem& p) { return array_of(p.problem().upper()); },
          "(n,): bounds of z.")
      .def_property_readonly(
          "N", [](const PythonProblem& p) { return p.problem().definition().N; }, "Stages.")
      .def_property_readonly(
          "M", [](const PythonProblem& p) { return p.problem().definition().M; }, "Knots.")
      .def_property_readonly(
          "dt", [](const PythonProblem& p) { return p.problem().definition().dt; },
          "Duration of a stage [s].")
      .def_property_readonly(
          "x0", [](const PythonProblem& p) { return array_of(p.problem().definition().x0); },
          "(nx,): the present state.")
      .def_property_readonly(
          "terms",
          [](const PythonProblem& p) {
            std::vector<std::pair<std::string, double>> terms;
            for (const auto& [term, weight] : p.problem().definition().terms) {
              terms.emplace_back(term->name(), weight);
            }
            return terms;
          },
          "Name and weight of each term; the weight of a constraint counts for nothing.")
      .def_property_readonly(
          "has_gradient", [](const PythonProblem& p) { return p.problem().has_gradient(); },
          "Whether derivatives can be asked for.")
      .def_property_readonly(
          "jacobian_pattern",
          [](const PythonProblem& p) {
            const auto& pattern = p.problem().jacobian_pattern();
            py::array_t<bool> copy(std::vector<py::ssize_t>{pattern.rows(), pattern.cols()});
            auto out = copy.mutable_unchecked<2>();
            for (py::ssize_t r = 0; r < pattern.rows(); ++r) {
              for (py::ssize_t c = 0; c < pattern.cols(); ++c) out(r, c) = pattern(r, c);
            }
            return copy;
          },
          "(m, n) bool: where the Jacobian of the constraints may differ from 0.")
      .def_property_readonly(
          "start", [](const PythonProblem& p) { return p.start(); },
          "WarmStart of a solve that is given none: of a file the stored one, else its best seed.");
}

void bind_problem_evaluation(ProblemClass& problem) {
  problem
      .def(
          "evaluate",
          [](PythonProblem& p, const ArrayLike& z, const std::string& what) {
            return evaluate(p, Points(z, p.problem().num_variables()), what_of(what));
          },
          py::arg("z"), py::arg("what") = "value",
          "Everything at z, (n,) or (B, n). what: 'score' (for comparing candidates), 'value', "
          "'gradient' (with the Jacobian), 'residuals'; the last two of one point only.")
      .def(
          "cost",
          [](PythonProblem& p, const ArrayLike& z) -> py::object {
            const Points points(z, p.problem().num_variables());
            const Evaluation e = evaluate(p, points, Evaluate::kValue);
            if (points.single) return py::float_(e.cost[0]);
            return array_of(e.cost.data(), {e.cost.size()});
          },
          py::arg("z"), "The cost: a number at (n,), (B,) at (B, n).")
      .def(
          "gradient",
          [](PythonProblem& p, const ArrayLike& z) {
            return array_of(
                evaluate(p, Points(z, p.problem().num_variables()), Evaluate::kGradient).gradient);
          },
          py::arg("z"), "(n,): of the cost, at (n,).")
      .def(
          "constraints",
          [](PythonProblem& p, const ArrayLike& z) -> py::object {
            const Points points(z, p.problem().num_variables());
            const Evaluation e = evaluate(p, points, Evaluate::kValue);
            const auto& c = e.constraints;
            if (points.single) return array_of(c.data(), {c.rows()});
            return array_of(c.data(), {c.cols(), c.rows()});
          },
          py::arg("z"), "(m,) at (n,), (B, m) at (B, n): feasible where all are >= 0.")
      .def(
          "jacobian",
          [](PythonProblem& p, const ArrayLike& z) {
            return array_of(
                evaluate(p, Points(z, p.problem().num_variables()), Evaluate::kGradient).jacobian);
          },
          py::arg("z"), "(m, n): of the constraints, at (n,).")
      .def(
          "residuals",
          [](PythonProblem& p, const ArrayLike& z) {
            return evaluate(p, Points(z, p.problem().num_variables()), Evaluate::kResiduals);
          },
          py::arg("z"), "evaluate(z, 'residuals'), at (n,).")
      .def(
          "explain",
          [](PythonProblem& p, const ArrayLike& z) {
            const Eigen::VectorXd point =
                vector_of(z, p.problem().num_variables(), "z", Entries::kAny);
            const py::gil_scoped_release release;
            return p.problem().explain(point);
          },
          py::arg("z"), "Every term raw and weighted, at (n,).")
      .def(
          "rollout",
          [](PythonProblem& p, const ArrayLike& z) {
            return Trajectories(
                p.problem().rollout(vector_of(z, p.problem().num_variables(), "z")));
          },
          py::arg("z"), "Trajectories with B = 1: where the inputs z, (n,), lead.")
      .def(
          "knots_from_inputs",
          [](PythonProblem& p, const ArrayLike& inputs) {
            const ProblemDefinition& d = p.problem().definition();
            return array_of(p.problem().knots_from_inputs(
                transposed(inputs, d.N, d.model->nu(), "inputs").transpose().eval()));
          },
          py::arg("inputs"), "(n,): the knots for inputs (N, nu) of the stages, within bounds.");
}

void bind_problem_file(py::module_& m, ProblemClass& problem) {
  problem
      .def_property_readonly(
          "origin",
          [](const PythonProblem& p) -> py::object {
            if (!p.saved) return py::none();
            const ProblemOrigin& o = p.saved->origin;
            py::dict d;
            d["program"] = o.program;
            d["world"] = o.world;
            d["seed"] = o.seed;
            d["step"] = o.step;
            d["time"] = o.time;
            return d;
          },
          "Of a file: dict of program, world, seed, step, time [s]; else None.")
      .def(
          "save",
          [](const PythonProblem& p, const std::filesystem::path& path) {
            if (!p.saved) {
              throw std::invalid_argument(path.string() +
                                          ": a problem of functions and terms alone cannot be "
                                          "written; expected one of a planner or a file");
            }
            const py::gil_scoped_release release;
            write_problem(path.string(), *p.saved);
          },
          py::arg("path"),
          "Writes a problem file (HDF5), whole or not at all. Only of what a planner or a file "
          "gave.")
      .def("__repr__", [](const PythonProblem& p) {
        return "Problem(n=" + std::to_string(p.problem().num_variables()) +
               ", m=" + std::to_string(p.problem().num_constraints()) + ")";
      });

  m.def(
      "load_problem",
      [](const std::filesystem::path& path, const std::shared_ptr<Registries>& registries) {
        const TermRegistry terms = registries ? registries->terms : TermRegistry();
        const py::gil_scoped_release release;
        ReadProblem read = read_problem(path.string(), terms);
        return python_problem(std::move(read.problem), std::move(read.saved));
      },
      py::arg("path"), py::arg("registries") = py::none(),
      "The Problem of a problem file (`prospect explore --save-problems N`). registries: of terms "
      "that are not built in. ValueError, one line with the path, for a file that is none.");
}

}  // namespace

void bind_problem(py::module_& m) {
  bind_trajectories(m);
  bind_evaluation(m);
  bind_motion_model(m);
  ProblemClass problem(
      m, "Problem",
      "min cost(z) subject to constraints(z) >= 0 and lower <= z <= upper. z, of shape (n,), holds "
      "the inputs at M knots, one after another; the states follow from them. Points may be given "
      "as one, (n,), or as a batch of B, (B, n). May be evaluated from several threads.");
  problem
      .def(py::init(&make_own), py::arg("model"), py::arg("x0"), py::arg("terms"), py::kw_only(),
           py::arg("u_previous") = py::none(), py::arg("N") = 20, py::arg("dt") = 0.25,
           py::arg("M") = 10, py::arg("start") = py::none(),
           "A problem of terms written in Python. x0: (nx,), the present state. terms: of each a "
           "Term, or (Term, weight). u_previous: (nu,), the input in force [0]. N: stages of dt "
           "[s]; M: knots. start: (n,), where solves begin [the middle of the bounds].")
      .def_static("from_functions", &from_functions, py::arg("lower"), py::arg("upper"),
                  py::arg("cost"), py::arg("gradient") = py::none(), py::kw_only(),
                  py::arg("rows") = 0, py::arg("constraints") = py::none(),
                  py::arg("jacobian") = py::none(), py::arg("start") = py::none(),
                  py::arg("name") = "function",
                  "A plain nonlinear programme in n variables. lower, upper, start: (n,), finite. "
                  "cost(z) gives a number, gradient(z) (n,); of `rows` constraints c(z) >= 0, "
                  "constraints(z) gives (rows,), jacobian(z) (rows, n).");
  bind_problem_facts(problem);
  bind_problem_evaluation(problem);
  bind_problem_file(m, problem);
}

}  // namespace prospect::python
