// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/problem_file/problem_file.h"
#include "engine/problem/problem.h"
#include "engine/problem/solver.h"
#include "engine/terms/problem_specification.h"

namespace prospect::python {

/// A problem with what Python needs beside it: scratch for whoever evaluates, where back ends
/// start, and where it comes from. Thread-safety: all methods from any thread.
class PythonProblem {
 public:
  explicit PythonProblem(std::shared_ptr<const Problem> problem, WarmStart start = {})
      : problem_(std::move(problem)), start_(std::move(start)) {}

  const Problem& problem() const { return *problem_; }
  std::shared_ptr<const Problem> share() const { return problem_; }
  /// Of a solve that is given no other start.
  const WarmStart& start() const { return start_; }

  /// As Problem::evaluate, with a workspace of this problem.
  void evaluate(const Eigen::Ref<const Eigen::MatrixXd>& X, Evaluate what, Evaluation& out);

  /// What it was made from, where that is known: of a file or a planner.
  std::optional<SavedProblem> saved;

 private:
  std::shared_ptr<const Problem> problem_;
  WarmStart start_;
  std::mutex mutex_;
  std::vector<Workspace> idle_;
};

/// Of a problem as a planner met it or a file holds it: its start is the stored warm start, else
/// the best seed; all seeds are with it.
std::shared_ptr<PythonProblem> python_problem(std::shared_ptr<const Problem> problem,
                                              SavedProblem saved);

}  // namespace prospect::python
