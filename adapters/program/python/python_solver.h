// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "adapters/program/python/callback.h"
#include "solvers/solver_frame.h"

namespace prospect::python {

/// What a solver written in Python sees of its solve: the evaluator while run() lasts, and nothing
/// afterwards, whoever keeps it. Points are those of the free variables, (n,).
class OpenSolve {
 public:
  OpenSolve(Evaluator& evaluator, const Eigen::VectorXd& start)
      : evaluator_(&evaluator), start_(start) {}
  void close() { evaluator_ = nullptr; }

  /// Throws std::runtime_error once the solve is over.
  Evaluator& evaluator() const {
    if (!evaluator_)
      throw std::runtime_error("evaluator: the solve is over; expected its use in run() only");
    return *evaluator_;
  }
  const Eigen::VectorXd& start() const { return start_; }

  /// Evaluates x, unless it is the last point; throws SolveStopped once the solve is over.
  void evaluate(const Eigen::VectorXd& x, Evaluate what) const;

 private:
  Evaluator* evaluator_;
  Eigen::VectorXd start_;
};

/// The solve is over (deadline, evaluations used up, cancelled): run() must return. In Python the
/// exception Stopped, which run() may let pass.
struct SolveStopped : std::runtime_error {
  SolveStopped() : std::runtime_error("the solve is over: run() must return") {}
};

/// A back end written in Python (class Solver of the package): its attributes are read once, run()
/// is called by one thread at a time. Throws std::invalid_argument where an attribute is missing or
/// of another type; the thread that makes it holds the GIL.
class PythonSolver final : public SolverFrame {
 public:
  explicit PythonSolver(const py::object& object);

  std::string name() const override { return name_; }
  const std::string& description() const { return description_; }
  std::vector<OptionInfo> options() const override { return options_; }
  std::string explain_unsupported(const Problem& problem) const override;

 protected:
  Evaluate start_evaluation() const override {
    return gradient_ ? Evaluate::kGradient : Evaluate::kValue;
  }
  Result run(Evaluator& evaluator, const OptionSet& options, const WarmStart& warm_start,
             const Eigen::VectorXd& start) const override;

 private:
  std::string name_, description_;
  std::vector<OptionInfo> options_;
  bool gradient_ = true, constraints_ = true;  // what it needs; what it takes
  Callback object_;
};

/// A value of Python as an option: int, float, bool (0 or 1) or str.
OptionValue option_of(const py::handle& value, const std::string& name);

}  // namespace prospect::python
