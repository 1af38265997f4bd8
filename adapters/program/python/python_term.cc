// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/python/python_term.h"

#include <stdexcept>

#include "adapters/program/python/arrays.h"
#include "adapters/program/python/trajectories.h"
#include "models/nearest_name.h"

namespace prospect::python {
namespace {

std::string name_of(const py::object& object) {
  const py::object name = py::getattr(object, "name", py::none());
  if (!py::isinstance<py::str>(name)) {
    throw std::invalid_argument("a term (" + std::string(py::str(py::type::of(object))) +
                                ") has no name; expected an attribute `name` of type str");
  }
  return py::str(name);
}

Smoothness smoothness_of(const std::string& term, const std::string& text) {
  const std::vector<std::string> names = {"smooth", "C1", "C0", "discontinuous"};
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (names[n] == text) return static_cast<Smoothness>(n);
  }
  throw std::invalid_argument("term '" + term + "': smoothness is '" + text + "'" +
                              expected_one_of(names));
}

bool has(const py::object& object, const char* method) {
  return !py::getattr(object, method, py::none()).is_none();
}

/// What a method gave by name: {"poses": ..., "states": ..., "inputs": ...}, each may be missing.
struct Derivatives {
  std::optional<Numbers> poses, states, inputs;
};

Derivatives derivatives(const py::object& given, const std::string& where,
                        std::vector<py::ssize_t> rows, const Horizon& h) {
  if (!py::isinstance<py::dict>(given)) {
    throw std::invalid_argument(where +
                                ": gave no dict; expected one with 'poses', 'states' or 'inputs'");
  }
  Derivatives d;
  for (const auto& [key, value] : py::reinterpret_borrow<py::dict>(given)) {
    const std::string name = py::str(key);
    const bool poses = name == "poses", states = name == "states";
    if (!poses && !states && name != "inputs") {
      throw std::invalid_argument(where + ": gave '" + name +
                                  "'; expected 'poses', 'states' or 'inputs'");
    }
    std::vector<py::ssize_t> shape = rows;
    shape.push_back(poses || states ? h.N + 1 : h.N);
    shape.push_back(poses ? 4 : (states ? h.nx() : h.nu()));
    const Numbers array = numbers_of(ArrayLike{py::reinterpret_borrow<py::object>(value)}, shape,
                                     where + ": '" + name + "'", Entries::kAny);
    (poses ? d.poses : (states ? d.states : d.inputs)) = array;
  }
  return d;
}

}  // namespace

PythonTerm::PythonTerm(const py::object& object) : name_(name_of(object)), object_(object, name_) {
  const auto text = [&](const char* key, const char* fallback) {
    return std::string(py::str(py::getattr(object, key, py::str(fallback))));
  };
  if (!has(object, "value")) {
    throw std::invalid_argument("term '" + name_ + "': has no method `value`; expected one");
  }
  const bool constraint = has(object, "rows");
  traits_.kind = constraint ? TermKind::kConstraint : TermKind::kCost;
  traits_.smoothness = smoothness_of(name_, text("smoothness", "smooth"));
  traits_.has_gradient = has(object, constraint ? "jacobian" : "gradient");
  traits_.unit = text("unit", "-");
  traits_.normalisation = text("normalisation", "");
  const py::object bound = py::getattr(object, "lower_bound", py::none());
  if (!bound.is_none()) {
    lower_bound_ = number_of(bound, "term '" + name_ + "'.lower_bound");
  }
}

int PythonTerm::rows(const Horizon& h) const {
  if (traits_.kind == TermKind::kCost) return 1;
  return object_(
      "rows", [&](const py::object& o) { return whole_of(o.attr("rows")(h.N), name_ + ".rows"); });
}

std::vector<JacobianBlock> PythonTerm::jacobian_pattern(const Horizon& h) const {
  std::vector<JacobianBlock> blocks;
  if (traits_.kind == TermKind::kCost) return blocks;
  const int count = rows(h);
  for (int row = 0; row < count; ++row) {
    for (int k = 1; k <= h.N; ++k) blocks.push_back({row, k, false});
    for (int k = 0; k < h.N; ++k) blocks.push_back({row, k, true});
  }
  return blocks;
}

std::optional<ResidualForm> PythonTerm::residual_form(const Horizon&, int sign) const {
  if (traits_.kind != TermKind::kCost || !lower_bound_ || sign < 0) return std::nullopt;
  return ResidualForm{*lower_bound_, 0, {}};
}

void PythonTerm::evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                          TermOutput& out) const {
  const bool cost = traits_.kind == TermKind::kCost;
  object_(request.gradient ? "value or derivative" : "value", [&](const py::object& o) {
    const py::object trajectories = py::cast(Trajectories(t));
    const py::ssize_t B = t.batch(), rows = out.value.rows();
    const std::vector<py::ssize_t> shape =
        cost ? std::vector<py::ssize_t>{B} : std::vector<py::ssize_t>{B, rows};
    const Numbers value = numbers_of(ArrayLike{o.attr("value")(trajectories)}, shape,
                                     name_ + ".value", Entries::kAny);
    out.value = Eigen::Map<const Eigen::ArrayXXd>(value.data(), rows, B);
    if (!request.gradient) return;
    if (cost) {
      add_gradient(t, o.attr("gradient")(trajectories), out);
    } else {
      write_jacobian(t, o.attr("jacobian")(trajectories), out);
    }
  });
}

void PythonTerm::add_gradient(const TrajectoryBatch& t, const py::object& given,
                              TermOutput& out) const {
  const Horizon& h = t.horizon;
  const Derivatives d = derivatives(given, name_ + ".gradient", {}, h);
  if (d.states) {
    out.state_gradient.col(0) +=
        Eigen::Map<const Eigen::ArrayXd>(d.states->data(), d.states->size());
  }
  if (d.inputs) {
    out.input_gradient.col(0) +=
        Eigen::Map<const Eigen::ArrayXd>(d.inputs->data(), d.inputs->size());
  }
  if (d.poses) {
    const auto g = d.poses->unchecked<2>();
    for (int k = 0; k <= h.N; ++k) {
      out.add_pose_gradient(t, k, 0, g(k, 0), g(k, 1), g(k, 2), g(k, 3));
    }
  }
}

void PythonTerm::write_jacobian(const TrajectoryBatch& t, const py::object& given,
                                TermOutput& out) const {
  const Horizon& h = t.horizon;
  const py::ssize_t rows = out.value.rows();
  const Derivatives d = derivatives(given, name_ + ".jacobian", {rows}, h);
  Eigen::Index block = 0;
  // In the order of jacobian_pattern().
  for (py::ssize_t row = 0; row < rows; ++row) {
    for (int k = 1; k <= h.N; ++k, ++block) {
      if (d.poses) {
        const auto g = d.poses->unchecked<3>();
        out.set_pose_block(t, block, g(row, k, 0), g(row, k, 1), g(row, k, 2), g(row, k, 3));
      } else {
        out.jacobian.col(block).setZero();
      }
      if (d.states) {
        out.jacobian.col(block).head(h.nx()) +=
            Eigen::Map<const Eigen::VectorXd>(d.states->data(row, k, 0), h.nx());
      }
    }
    for (int k = 0; k < h.N; ++k, ++block) {
      out.jacobian.col(block).setZero();
      if (d.inputs) {
        out.jacobian.col(block).head(h.nu()) =
            Eigen::Map<const Eigen::VectorXd>(d.inputs->data(row, k, 0), h.nu());
      }
    }
  }
}

}  // namespace prospect::python
