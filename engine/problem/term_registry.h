// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/problem/term.h"

namespace prospect {

struct ProblemSpecification;  // engine/terms/problem_specification.h
struct CachedEvaluators;      // there, too

/// A number that a term can be given.
struct TermOption {
  std::string name;  ///< letters, digits and _; not "weight"
  double fallback = 0.0;
  double least = 0.0, most = 0.0;  ///< the range, both ends included
  std::string unit;                ///< "m", "1" for a pure number
  std::string description;
};

/// Option by name; complete where a factory gets them.
using TermOptions = std::map<std::string, double>;

/// What a term may be made of, at one planning step: the specification holds robot, present state,
/// horizon, maps, landmarks, exploration targets, zones and the cost-to-go. All of it is stored in
/// problem files, so a term that looks at nothing else is the same when its problem is read back.
/// Valid during the call only; maps are shared pointers that a term may keep.
struct TermContext {
  const ProblemSpecification& specification;
  /// What the built-in terms share: clearance fields, occlusion tables, feature prediction.
  const CachedEvaluators& evaluators;
};

/// A term as it can be had by name.
struct TermEntry {
  using Factory =
      std::function<std::shared_ptr<const Term>(const TermOptions&, const TermContext&)>;

  std::string name;  ///< 1 to 64 letters, digits and "_-"
  std::string description;
  std::vector<TermOption> options{};
  int version = 1;  ///< of the options; raised when they change their meaning
  Factory make{};   ///< called at each planning step; null for one that does not apply
  /// Of a built-in term: the configuration's key of its weight ("planner.weights.w_o"), "" for a
  /// constraint.
  std::string weight_key{};
  bool built_in = false;
  bool constraint = false;  ///< its weight is 1, or 0 to leave it out

  /// Largest weight of a cost.
  static constexpr double kMostWeight = 1e6;
};

/// A term that a planner is to have: which, how much it counts, and its options.
struct TermUse {
  std::shared_ptr<const TermEntry> entry;
  double weight = 1.0;    ///< 0 to TermEntry::kMostWeight; 0: the term is left out
  TermOptions options{};  ///< every one of the entry
};

/// The terms that can be had by name. A value: there is no list of the process; who adds terms
/// hands the registry on. builtin_terms() (engine/terms/builtin_terms.h) is one with the built-in
/// terms.
///
/// Thread-safety: const functions may be called from any thread, add() only while none is.
class TermRegistry {
 public:
  /// Throws std::invalid_argument if the name is taken or not well-formed, if there is no factory,
  /// or if an option has no name, a name twice, a range that is none or a default outside of it.
  void add(TermEntry entry);

  /// Throws std::invalid_argument, with the nearest name, if there is no such term.
  std::shared_ptr<const TermEntry> find(std::string_view name) const;

  /// The term of that name with these options; those that are not given have their defaults.
  /// Throws std::invalid_argument as find(), and for an unknown option, with the nearest name, and
  /// an option or a weight that is out of its range.
  TermUse use(std::string_view name, double weight = 1.0, const TermOptions& given = {}) const;

  /// In the order of adding.
  std::vector<std::shared_ptr<const TermEntry>> list() const { return entries_; }

 private:
  std::vector<std::shared_ptr<const TermEntry>> entries_;
};

/// Makes the term of a use that is not built in. Exceptions of the term's evaluate() become a value
/// that is not finite, which rejects the candidate. Throws std::invalid_argument "term 'NAME': its
/// factory failed: ..." for what the factory throws, and if it makes nothing.
std::shared_ptr<const Term> make_term(const TermUse& use, const TermContext& context);

}  // namespace prospect
