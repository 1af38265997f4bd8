// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/python/python_problem.h"

#include <utility>

namespace prospect::python {

void PythonProblem::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& X, Evaluate what,
                             Evaluation& out) {
  std::optional<Workspace> workspace;
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      workspace = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  if (!workspace) workspace = problem_->make_workspace();
  problem_->evaluate(X, what, *workspace, out);
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(*workspace));
}

std::shared_ptr<PythonProblem> python_problem(std::shared_ptr<const Problem> problem,
                                              SavedProblem saved) {
  WarmStart start;
  if (saved.warm_start) start = *saved.warm_start;
  if (!saved.seeds.empty()) {
    if (start.x.size() == 0) start.x = saved.seeds.front().z;
    start.seeds.resize(problem->num_variables(), static_cast<Eigen::Index>(saved.seeds.size()));
    for (std::size_t s = 0; s < saved.seeds.size(); ++s) {
      start.seeds.col(static_cast<Eigen::Index>(s)) = saved.seeds[s].z;
    }
  }
  auto made = std::make_shared<PythonProblem>(std::move(problem), std::move(start));
  made->saved = std::move(saved);
  return made;
}

}  // namespace prospect::python
