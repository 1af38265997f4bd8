// SPDX-License-Identifier: Apache-2.0
#include "engine/problem/problem_registry.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace prospect {

void ProblemRegistry::add(ProblemEntry problem) {
  const auto plain = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' ||
           c == '-' || c == '.';
  };
  const std::string& set = problem.set;
  if (set.empty() || set.size() > 64 || !std::all_of(set.begin(), set.end(), plain)) {
    throw std::invalid_argument("a problem set is named '" + set +
                                "'; expected 1 to 64 letters, digits and _-.");
  }
  if (std::find(reserved_.begin(), reserved_.end(), set) != reserved_.end()) {
    throw std::invalid_argument("there is a problem set named '" + set +
                                "' already; expected another name");
  }
  if (problem.name.empty()) {
    throw std::invalid_argument("a problem of set '" + set + "' has no name; expected one");
  }
  const std::string which = "problem '" + problem.name + "' of set '" + set + "'";
  if (!problem.make) throw std::invalid_argument(which + " has no factory; expected one");
  if (problem.best_known && !std::isfinite(*problem.best_known)) {
    throw std::invalid_argument(which + " has a best cost that is not finite; expected a number");
  }
  for (const ProblemEntry& other : problems_) {
    if (other.set == set && other.name == problem.name) {
      throw std::invalid_argument(which + " is there already; expected another name");
    }
  }
  problems_.push_back(std::move(problem));
}

std::vector<std::string> ProblemRegistry::sets() const {
  std::vector<std::string> names;
  for (const ProblemEntry& p : problems_) {
    if (std::find(names.begin(), names.end(), p.set) == names.end()) names.push_back(p.set);
  }
  return names;
}

std::vector<ProblemEntry> ProblemRegistry::problems(const std::string& set) const {
  std::vector<ProblemEntry> found;
  for (const ProblemEntry& p : problems_) {
    if (p.set == set) found.push_back(p);
  }
  return found;
}

}  // namespace prospect
