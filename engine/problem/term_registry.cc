// SPDX-License-Identifier: Apache-2.0
#include "engine/problem/term_registry.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "models/nearest_name.h"

namespace prospect {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument(what); }

std::string brief(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

bool is_plain(char c, std::string_view besides) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
         besides.find(c) != std::string_view::npos;
}

bool is_name(const std::string& name, std::string_view besides) {
  return !name.empty() && name.size() <= 64 &&
         std::all_of(name.begin(), name.end(), [&](char c) { return is_plain(c, besides); });
}

std::string range(double least, double most) { return brief(least) + " to " + brief(most); }

void check_options(const TermEntry& entry) {
  for (auto o = entry.options.begin(); o != entry.options.end(); ++o) {
    const std::string which = "option '" + o->name + "' of term '" + entry.name + "'";
    if (!is_name(o->name, "_") || o->name == "weight") {
      refuse(which + " is named so; expected 1 to 64 letters, digits and _ other than 'weight'");
    }
    if (std::any_of(entry.options.begin(), o,
                    [&](const TermOption& other) { return other.name == o->name; })) {
      refuse(which + " is there twice; expected another name");
    }
    if (!std::isfinite(o->least) || !std::isfinite(o->most) || !(o->least <= o->most)) {
      refuse(which + " has the range " + range(o->least, o->most) + "; expected finite ends");
    }
    if (!(o->fallback >= o->least && o->fallback <= o->most)) {
      refuse(which + " has the default " + brief(o->fallback) + "; expected " +
             range(o->least, o->most));
    }
  }
}

/// Between the planner and a term from outside: keeps its exceptions out of evaluations.
class GuardedTerm final : public Term {
 public:
  GuardedTerm(std::string name, std::shared_ptr<const Term> term)
      : name_(std::move(name)), term_(std::move(term)), traits_(term_->traits()) {}

  std::string_view name() const override { return name_; }
  TermTraits traits() const override { return traits_; }
  int rows(const Horizon& horizon) const override { return term_->rows(horizon); }
  std::vector<JacobianBlock> jacobian_pattern(const Horizon& horizon) const override {
    return term_->jacobian_pattern(horizon);
  }
  std::optional<ResidualForm> residual_form(const Horizon& horizon, int sign) const override {
    return term_->residual_form(horizon, sign);
  }
  std::unique_ptr<TermScratch> make_scratch(const Horizon& horizon, int max_batch) const override {
    return term_->make_scratch(horizon, max_batch);
  }
  void evaluate(const TrajectoryBatch& trajectories, const TermRequest& request,
                TermScratch* scratch, TermOutput& out) const override {
    try {
      term_->evaluate(trajectories, request, scratch, out);
    } catch (...) {
      out.value.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }

 private:
  std::string name_;
  std::shared_ptr<const Term> term_;
  TermTraits traits_;
};

}  // namespace

void TermRegistry::add(TermEntry entry) {
  if (!is_name(entry.name, "_-")) {
    refuse("a term is named '" + entry.name + "'; expected 1 to 64 letters, digits and _-");
  }
  if (!entry.make) refuse("term '" + entry.name + "' has no factory; expected one");
  if (entry.version < 1) {
    refuse("term '" + entry.name + "' has version " + std::to_string(entry.version) +
           " of its options; expected 1 or more");
  }
  for (const auto& other : entries_) {
    if (other->name == entry.name) {
      refuse("there is a term named '" + entry.name + "' already; expected another name");
    }
  }
  check_options(entry);
  entries_.push_back(std::make_shared<const TermEntry>(std::move(entry)));
}

std::shared_ptr<const TermEntry> TermRegistry::find(std::string_view name) const {
  std::vector<std::string> names;
  for (const auto& entry : entries_) {
    if (entry->name == name) return entry;
    names.push_back(entry->name);
  }
  const std::string given(name);
  refuse("unknown term '" + given + "'" + did_you_mean(given, names) + expected_one_of(names));
}

TermUse TermRegistry::use(std::string_view name, double weight, const TermOptions& given) const {
  TermUse use{find(name), weight, {}};
  const std::string term = "term '" + use.entry->name + "': ";
  if (use.entry->constraint && weight != 0.0 && weight != 1.0) {
    refuse(term + "weight is " + brief(weight) +
           "; expected 1, or 0 to leave it out: it is a constraint");
  }
  if (!(weight >= 0.0 && weight <= TermEntry::kMostWeight)) {
    refuse(term + "weight is " + brief(weight) + "; expected " +
           range(0.0, TermEntry::kMostWeight));
  }
  std::vector<std::string> names;
  for (const TermOption& o : use.entry->options) {
    names.push_back(o.name);
    const auto at = given.find(o.name);
    const double value = at == given.end() ? o.fallback : at->second;
    if (!(value >= o.least && value <= o.most)) {
      refuse(term + "option '" + o.name + "' is " + brief(value) + "; expected " +
             range(o.least, o.most) + " [" + o.unit + "]");
    }
    use.options[o.name] = value;
  }
  for (const auto& [option, value] : given) {
    if (use.options.contains(option)) continue;
    refuse(term + "unknown option '" + option + "'" + did_you_mean(option, names) +
           (names.empty() ? "; expected none" : expected_one_of(names)));
  }
  return use;
}

std::shared_ptr<const Term> make_term(const TermUse& use, const TermContext& context) {
  const std::string& name = use.entry->name;
  const std::string failed = "term '" + name + "': its factory failed: ";
  try {
    std::shared_ptr<const Term> term = use.entry->make(use.options, context);
    if (term) return std::make_shared<const GuardedTerm>(name, std::move(term));
  } catch (const std::exception& e) {
    refuse(failed + e.what());
  } catch (...) {
    refuse(failed + "an exception that is not a std::exception");
  }
  refuse("term '" + name + "': its factory made nothing; expected a Term");
}

}  // namespace prospect
