// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/problem/problem.h"

namespace prospect {

/// A problem to measure back ends on, as it can be had by name.
struct ProblemEntry {
  std::string set;              ///< it is reported with: 1 to 64 letters, digits and "_-."
  std::string name;             ///< unique within its set
  std::string set_description;  ///< one line, of the set; that of its first problem counts
  std::function<ProblemDefinition()> make;
  std::function<Eigen::VectorXd()> start{};  ///< none: the middle of the bounds
  std::optional<double> best_known{};        ///< cost of the best point known; none: unknown
};

/// Sets of problems by name. A value, as TermRegistry. Thread-safety: likewise.
class ProblemRegistry {
 public:
  /// Throws std::invalid_argument if the set's name is reserved or not well-formed, if the problem
  /// has no name or one that its set has, if it cannot be made, or if its best cost is not finite.
  void add(ProblemEntry problem);
  /// No set may have this name.
  void reserve(std::string set) { reserved_.push_back(std::move(set)); }

  /// Names of the sets, in the order of adding.
  std::vector<std::string> sets() const;
  /// Of a set, in the order of adding; empty for an unknown one.
  std::vector<ProblemEntry> problems(const std::string& set) const;

 private:
  std::vector<ProblemEntry> problems_;
  std::vector<std::string> reserved_;
};

}  // namespace prospect
