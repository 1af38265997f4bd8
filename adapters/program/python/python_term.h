// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adapters/program/python/callback.h"
#include "engine/problem/term.h"

namespace prospect::python {

/// A term written in Python (class Term of the package): its attributes are read once, its methods
/// called by evaluate(), by one thread at a time. Throws std::invalid_argument where an attribute
/// is missing or of another type; the thread that makes it holds the GIL.
///
/// evaluate() throws CallbackError for an exception of a method, std::invalid_argument for a result
/// of another shape.
class PythonTerm final : public Term {
 public:
  explicit PythonTerm(const py::object& object);

  std::string_view name() const override { return name_; }
  TermTraits traits() const override { return traits_; }
  int rows(const Horizon& horizon) const override;
  /// Of every row all stages but the present state, which is given.
  std::vector<JacobianBlock> jacobian_pattern(const Horizon& horizon) const override;
  std::optional<ResidualForm> residual_form(const Horizon& horizon, int sign) const override;
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override;

 private:
  void add_gradient(const TrajectoryBatch& t, const py::object& given, TermOutput& out) const;
  void write_jacobian(const TrajectoryBatch& t, const py::object& given, TermOutput& out) const;

  std::string name_;
  TermTraits traits_;
  std::optional<double> lower_bound_;  // of a cost
  Callback object_;
};

}  // namespace prospect::python
