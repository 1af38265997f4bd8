// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/external/prospect_external.h"

#include <dlfcn.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/problem_file/problem_file.h"
#include "engine/problem/lifted_problem.h"

namespace prospect {
namespace {

/// A problem that was read, and what evaluates it.
class ReadFile {
 public:
  explicit ReadFile(const std::string& path)
      : problem_(read_problem(path).problem),
        pattern_(column_pattern(*problem_)),
        lifted_(problem_) {}

  bool has_sizes(const prospect_external_problem& as) const {
    const ColumnPattern& pattern = as.by_stages != 0 ? lifted_.pattern() : pattern_;
    return as.n == pattern.width() && as.m == pattern.height && as.nonzeros == pattern.nonzeros();
  }

  bool evaluate(const Eigen::Ref<const Eigen::VectorXd>& x,
                const prospect_external_values& values) const {
    const bool derivatives = values.gradient != nullptr || values.jacobian != nullptr;
    Workspace workspace = borrow();
    Evaluation e;
    const bool valid =
        problem_->evaluate(x, derivatives ? Evaluate::kGradient : Evaluate::kValue, workspace, e);
    give_back(std::move(workspace));
    if (!valid) return false;
    if (values.f) *values.f = e.cost[0];
    if (values.gradient) Eigen::VectorXd::Map(values.gradient, e.gradient.size()) = e.gradient;
    if (values.g) Eigen::VectorXd::Map(values.g, e.constraints.rows()) = e.constraints.col(0);
    for (int j = 0; values.jacobian && j < pattern_.width(); ++j) {
      const auto column = static_cast<std::size_t>(j);
      for (int k = pattern_.starts[column]; k < pattern_.starts[column + 1]; ++k) {
        values.jacobian[k] = e.jacobian(pattern_.rows[static_cast<std::size_t>(k)], j);
      }
    }
    return true;
  }

  bool evaluate_by_stages(const Eigen::Ref<const Eigen::VectorXd>& w,
                          const prospect_external_values& values) const {
    LiftedProblem::Value value;
    if (!lifted_.evaluate(w, value)) return false;
    const auto put = [](const Eigen::VectorXd& from, double* to) {
      if (to) Eigen::VectorXd::Map(to, from.size()) = from;
    };
    if (values.f) *values.f = value.cost;
    put(value.gradient, values.gradient);
    put(value.constraints, values.g);
    put(value.jacobian, values.jacobian);
    return true;
  }

 private:
  Workspace borrow() const {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) return problem_->make_workspace();
    Workspace workspace = std::move(idle_.back());
    idle_.pop_back();
    return workspace;
  }
  void give_back(Workspace workspace) const {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(workspace));
  }

  std::shared_ptr<const Problem> problem_;
  ColumnPattern pattern_;
  LiftedProblem lifted_;
  mutable std::mutex mutex_;
  mutable std::vector<Workspace> idle_;
};

std::string found_path(const std::string& file, const void* beside) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::is_regular_file(file, error)) return file;
  Dl_info object;
  if (beside != nullptr && dladdr(beside, &object) != 0 && object.dli_fname != nullptr) {
    const fs::path there = fs::path(object.dli_fname).parent_path() / fs::path(file).filename();
    if (fs::is_regular_file(there, error)) return there.string();
  }
  return file;
}

/// The file, read at most once; null if that failed, which it says once.
const ReadFile* read_file(const std::string& file, const void* beside) {
  static std::mutex mutex;
  static std::map<std::string, std::unique_ptr<const ReadFile>> files;
  const std::lock_guard lock(mutex);
  const auto [found, is_new] = files.try_emplace(file);
  if (is_new) {
    try {
      found->second = std::make_unique<const ReadFile>(found_path(file, beside));
    } catch (const std::exception& e) {
      std::fprintf(stderr, "prospect_external: %s\n", e.what());
    }
  }
  return found->second.get();
}

int evaluate(const prospect_external_problem& problem, const double* x,
             const prospect_external_values& values) {
  constexpr int kNotEvaluable = 1, kNoFile = 2;
  const ReadFile* read = read_file(problem.file, problem.beside);
  if (read == nullptr) return kNoFile;
  if (!read->has_sizes(problem)) {
    static std::once_flag told;
    std::call_once(told, [&] {
      std::fprintf(stderr,
                   "prospect_external: %s: another problem than the one that was exported; "
                   "expected %lld variables, %lld rows, %lld entries\n",
                   problem.file, problem.n, problem.m, problem.nonzeros);
    });
    return kNoFile;
  }
  const auto point = Eigen::VectorXd::Map(x, static_cast<Eigen::Index>(problem.n));
  try {
    const bool valid = problem.by_stages != 0 ? read->evaluate_by_stages(point, values)
                                              : read->evaluate(point, values);
    return valid ? 0 : kNotEvaluable;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "prospect_external: %s: %s\n", problem.file, e.what());
    return kNotEvaluable;
  }
}

}  // namespace
}  // namespace prospect

int prospect_external_evaluate(const prospect_external_problem* problem, const double* x,
                               const prospect_external_values* values) {
  return prospect::evaluate(*problem, x, *values);
}
