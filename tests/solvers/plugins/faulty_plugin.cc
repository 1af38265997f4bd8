// SPDX-License-Identifier: Apache-2.0
// A plug-in with one fault, which the environment variable PROSPECT_TEST_FAULT names at the moment
// when its entry point is called.
#include <chrono>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>

#include "solvers/options.h"
#include "solvers/plugin.h"

namespace {

using prospect::Solver;

class Misfit final : public Solver {
 public:
  explicit Misfit(std::string fault) : fault_(std::move(fault)) {}
  std::string name() const override { return "misfit"; }
  std::vector<prospect::OptionInfo> options() const override {
    if (fault_ == "options throw") throw std::runtime_error("no options today");
    return prospect::common_options();
  }
  std::string explain_unsupported(const prospect::Problem&) const override {
    if (fault_ == "explain throws") throw std::runtime_error("no explanation today");
    return {};
  }
  prospect::Result solve(const prospect::Problem& problem, const prospect::WarmStart&,
                         const prospect::Options&, const prospect::StopCondition&) const override {
    if (fault_ == "solve throws") throw std::runtime_error("no solution today");
    if (fault_ == "solve throws a number") throw 42;
    prospect::Result result;
    result.quality = prospect::Quality::kFeasible;
    result.x = problem.lower();
    result.cost = 0.0;
    if (fault_ == "wrong size") result.x.conservativeResize(problem.num_variables() + 1);
    if (fault_ == "x not finite") result.x[0] = std::numeric_limits<double>::quiet_NaN();
    if (fault_ == "cost not finite") result.cost = -std::numeric_limits<double>::infinity();
    return result;
  }

 private:
  std::string fault_;
};

std::string fault() {
  const char* text = std::getenv("PROSPECT_TEST_FAULT");
  return text ? text : "";
}

Solver* make() {
  if (fault() == "factory throws") throw std::runtime_error("two\nlines");
  if (fault() == "factory throws a number") throw 42;
  return fault() == "factory returns nothing" ? nullptr : new Misfit(fault());
}
Solver* make_another() { return new Misfit("another"); }

/// A value that is not a number, or an exception.
class OddTerm final : public prospect::Term {
 public:
  std::string_view name() const override { return "odd_term"; }
  prospect::TermTraits traits() const override { return {}; }
  void evaluate(const prospect::TrajectoryBatch&, const prospect::TermRequest&,
                prospect::TermScratch*, prospect::TermOutput& out) const override {
    if (fault() == "term: evaluate throws") throw std::runtime_error("no value today");
    out.value.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
};
prospect::Term* make_term(const prospect::TermOptions&, const prospect::TermContext&) {
  if (fault() == "term: factory throws") throw std::runtime_error("no term today");
  return new OddTerm;
}
prospect::ProblemDefinition make_problem() { throw std::runtime_error("no problem today"); }

}  // namespace

const prospect::Plugin* prospect_plugin() {
  // Not const: each call gives another one. The tests load from one thread.
  static prospect::PluginSolver solvers[2];
  static prospect::PluginTerm term;
  static prospect::TermOption option;
  static prospect::PluginProblem problem;
  static prospect::Plugin plugin;
  solvers[0] = {"misfit", "one with a fault", &make};
  solvers[1] = {"another", "one more", &make_another};
  plugin = {prospect::kPluginInterface, prospect::kPluginAbi, solvers, 1};
  option = {"size", 1.0, 0.5, 2.0, "m", "of something"};
  term = {"odd_term", "one with a fault", 1, &option, 1, &make_term};
  problem = {"odd_set", "a set with a fault", "one", &make_problem};

  const std::string f = fault();
  if (f == "entry throws") throw std::runtime_error("no licence");
  if (f == "entry throws a number") throw 42;
  if (f == "entry takes long") std::this_thread::sleep_for(std::chrono::seconds(30));
  if (f == "entry returns nothing") return nullptr;
  if (f == "interface") {
    // Of another version, whose struct is another one: nothing after the number may be read.
    static const struct {
      std::uint32_t interface_version;
      unsigned char rest[4];
    } future = {prospect::kPluginInterface + 1, {255, 255, 255, 255}};
    return reinterpret_cast<const prospect::Plugin*>(&future);
  }
  if (f == "version") plugin.abi.version = "0.0.9";
  if (f == "no version") plugin.abi.version = nullptr;
  if (f == "compiler") ++plugin.abi.compiler;
  if (f == "standard library") ++plugin.abi.standard_library;
  if (f == "strings") ++plugin.abi.new_strings;
  if (f == "containers") ++plugin.abi.checked_containers;
  if (f == "eigen") ++plugin.abi.eigen;
  if (f == "alignment") plugin.abi.eigen_alignment *= 2;
  if (f == "static alignment") plugin.abi.eigen_static *= 2;
  if (f == "row major") ++plugin.abi.eigen_row_major;
  if (f == "index") --plugin.abi.eigen_index;
  if (f == "problem") ++plugin.abi.problem;
  if (f == "evaluation") ++plugin.abi.evaluation;
  if (f == "trajectories") ++plugin.abi.trajectories;
  if (f == "traits") ++plugin.abi.term_traits;
  if (f == "result") ++plugin.abi.result;
  if (f == "definition") ++plugin.abi.definition;
  if (f == "specification") ++plugin.abi.specification;
  if (f == "evaluators") ++plugin.abi.evaluators;
  if (f == "not optimised") plugin.abi.optimized = 0;
  if (f.starts_with("term: ")) plugin.terms = &term, plugin.num_terms = 1;
  if (f == "term: no name") term.name = nullptr;
  if (f == "term: name") term.name = "odd term";
  if (f == "term: no factory") term.make = nullptr;
  if (f == "term: no options") term.options = nullptr;
  if (f == "term: range") option.least = 2.0, option.most = 1.0;
  if (f == "term: version") term.version = 0;
  if (f.starts_with("problem: ")) plugin.problems = &problem, plugin.num_problems = 1;
  if (f == "problem: no set") problem.set = nullptr;
  if (f == "problem: no factory") problem.make = nullptr;
  if (f == "problem: best") problem.best_known = std::numeric_limits<double>::infinity();
  if (f == "no solvers") plugin.solvers = nullptr;
  if (f == "zero solvers") plugin.num_solvers = 0;
  if (f == "no name") solvers[0].name = nullptr;
  if (f == "empty name") solvers[0].name = "";
  if (f == "spaces") solvers[0].name = "my solver";
  if (f == "comma") solvers[0].name = "my,solver";
  if (f == "newline") solvers[0].name = "my\nsolver";
  if (f == "long name") {
    static const std::string name(65, 'x');
    solvers[0].name = name.c_str();
  }
  if (f == "unknown") solvers[0].name = "unknown";
  if (f == "built in") solvers[0].name = "nlopt:LD_SLSQP";
  if (f == "no factory") solvers[0].make = nullptr;
  if (f == "no description") solvers[0].description = nullptr;
  if (f == "two") plugin.num_solvers = 2;
  if (f == "twice" || f == "second is bad") plugin.num_solvers = 2;
  if (f == "twice") solvers[1].name = "misfit";
  if (f == "second is bad") solvers[1].make = nullptr;
  return &plugin;
}
