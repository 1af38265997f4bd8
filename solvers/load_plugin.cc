// SPDX-License-Identifier: Apache-2.0
#include "solvers/load_plugin.h"

#include <dlfcn.h>
#include <link.h>

#include <cmath>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "models/one_line.h"
#include "solvers/evaluator.h"
#include "solvers/plugin.h"

namespace prospect {
namespace {

/// Between the program and a solver of a plug-in: keeps exceptions and unusable results out.
class GuardedSolver final : public Solver {
 public:
  GuardedSolver(std::string name, std::unique_ptr<const Solver> solver)
      : name_(std::move(name)), solver_(std::move(solver)), options_(solver_->options()) {}

  std::string name() const override { return name_; }
  std::vector<OptionInfo> options() const override { return options_; }

  std::string explain_unsupported(const Problem& problem) const override {
    try {
      return solver_->explain_unsupported(problem);
    } catch (const std::exception& e) {
      return "the plug-in failed: " + std::string(e.what());
    } catch (...) {
      return "the plug-in failed: an exception that is not a std::exception";
    }
  }

  Result solve(const Problem& problem, const WarmStart& warm_start, const Options& options,
               const StopCondition& stop) const override {
    try {
      Result result = solver_->solve(problem, warm_start, options, stop);
      if (result.x.size() != problem.num_variables()) {
        return failed("a result with " + std::to_string(result.x.size()) + " variables; expected " +
                          std::to_string(problem.num_variables()),
                      problem);
      }
      if (!result.x.allFinite() || !std::isfinite(result.cost) ||
          !std::isfinite(result.violation)) {
        return failed("a result that is not finite; expected finite numbers", problem);
      }
      const bool free = (problem.lower().array() < problem.upper().array()).any();
      if (free && result.quality == Quality::kFeasibleOptimum) {
        const Judgement judgement = judge(problem, result.x, {}, stop);
        if (judgement.verdict != Judgement::Verdict::kOptimum) {
          result.quality = Quality::kFeasible;
          result.detail += ", not proven to be an optimum: " + judgement.why;
        }
      }
      return result;
    } catch (const std::exception& e) {
      return failed(e.what(), problem);
    } catch (...) {
      return failed("an exception that is not a std::exception", problem);
    }
  }

 private:
  Result failed(const std::string& why, const Problem& problem) const {
    return failed_result(problem, name_ + ": the plug-in failed: " + why);
  }

  std::string name_;
  std::unique_ptr<const Solver> solver_;
  std::vector<OptionInfo> options_;
};

/// dlerror() without the path, which the message has already, in one line.
std::string reason_of_loader(const std::string& path) {
  const char* text = dlerror();
  std::string reason = text ? text : "no reason given";
  if (reason.starts_with(path + ": ")) reason.erase(0, path.size() + 2);
  return one_line(reason);
}

/// Whether the file ends before its table of sections, which compilers write last. The loader maps
/// such a library and the program dies at the first missing page.
bool is_cut_off(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  ElfW(Ehdr) header;
  if (!file.read(reinterpret_cast<char*>(&header), sizeof header)) return false;
  // What is no library of this machine is left to the loader.
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) return false;
  if (header.e_ident[EI_CLASS] != (sizeof(void*) == 8 ? ELFCLASS64 : ELFCLASS32)) return false;
  std::error_code ignored;
  return header.e_shoff + std::uintmax_t{header.e_shentsize} * header.e_shnum >
         std::filesystem::file_size(path, ignored);
}

/// "" if equal, else what differs.
std::string difference(const PluginAbi& plugin, const PluginAbi& here) {
  const auto text = [](const char* what, const std::string& theirs, const std::string& ours) {
    return "was built with " + std::string(what) + " " + theirs + "; expected " + ours +
           ", as this program";
  };
  const std::string version = plugin.version ? plugin.version : "unknown";
  if (version != here.version) return text("Prospect", version, here.version);
  const struct {
    const char* what;
    std::int32_t theirs, ours;
  } numbers[] = {
      {"C++ ABI", plugin.compiler, here.compiler},
      {"libstdc++", plugin.standard_library, here.standard_library},
      {"_GLIBCXX_USE_CXX11_ABI", plugin.new_strings, here.new_strings},
      {"_GLIBCXX_DEBUG", plugin.checked_containers, here.checked_containers},
      {"Eigen", plugin.eigen, here.eigen},
      {"Eigen's alignment (-m flags) of", plugin.eigen_alignment, here.eigen_alignment},
      {"Eigen's static alignment (-m flags) of", plugin.eigen_static, here.eigen_static},
      {"EIGEN_DEFAULT_TO_ROW_MAJOR", plugin.eigen_row_major, here.eigen_row_major},
      {"an Eigen::Index of size", plugin.eigen_index, here.eigen_index},
      {"a Problem of size", plugin.problem, here.problem},
      {"an Evaluation of size", plugin.evaluation, here.evaluation},
      {"a TrajectoryBatch of size", plugin.trajectories, here.trajectories},
      {"a TermTraits of size", plugin.term_traits, here.term_traits},
      {"a Result of size", plugin.result, here.result},
      {"a ProblemDefinition of size", plugin.definition, here.definition},
      {"a ProblemSpecification of size", plugin.specification, here.specification},
      {"CachedEvaluators of size", plugin.evaluators, here.evaluators},
  };
  for (const auto& n : numbers) {
    if (n.theirs != n.ours) {
      return text(n.what, std::to_string(n.theirs), std::to_string(n.ours));
    }
  }
  return {};
}

/// The return value of a function of the plug-in; `what` names it in the exception if it throws.
template <class Function>
auto call(const std::string& what, Function&& function) {
  try {
    return function();
  } catch (const std::exception& e) {
    throw std::invalid_argument(what + " failed: " + e.what());
  } catch (...) {
    throw std::invalid_argument(what + " failed: an exception that is not a std::exception");
  }
}

/// Throws std::invalid_argument without the path.
const Plugin& open_plugin(const std::string& path) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  const std::string expected = "; expected a shared library (.so)";
  if (!std::filesystem::exists(status)) throw std::invalid_argument("no such file" + expected);
  if (std::filesystem::is_directory(status)) {
    throw std::invalid_argument("is a directory" + expected);
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw std::invalid_argument("is not a regular file" + expected);
  }
  if (is_cut_off(path)) throw std::invalid_argument("the file is cut off" + expected);

  // Without a slash the loader would search its own folders.
  const std::string absolute = std::filesystem::absolute(path).string();
  void* library = dlopen(absolute.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw std::invalid_argument(reason_of_loader(absolute) + expected);
  const auto entry =
      reinterpret_cast<decltype(&prospect_plugin)>(dlsym(library, "prospect_plugin"));
  if (!entry) {
    throw std::invalid_argument(
        "has no entry point; expected a function 'prospect_plugin' (solvers/plugin.h)");
  }
  const Plugin* plugin = call("the entry point", [&] { return entry(); });
  if (!plugin) {
    throw std::invalid_argument("the entry point returned nothing; expected a prospect::Plugin");
  }
  // First of all: what follows it in the struct may be anything in another version.
  if (plugin->interface_version != kPluginInterface) {
    throw std::invalid_argument(
        "has plug-in interface " + std::to_string(plugin->interface_version) + "; expected " +
        std::to_string(kPluginInterface) + ", that of Prospect " + kVersion);
  }
  const std::string wrong = difference(plugin->abi, kPluginAbi);
  if (!wrong.empty()) throw std::invalid_argument(wrong);
  const auto count = [](const char* what, const void* list, std::size_t number) {
    if (!list && number > 0) {
      throw std::invalid_argument("has no list of its " + std::to_string(number) + " " + what +
                                  "; expected one");
    }
    return number;
  };
  if (count("back ends", plugin->solvers, plugin->num_solvers) +
              count("terms", plugin->terms, plugin->num_terms) +
              count("problems", plugin->problems, plugin->num_problems) ==
          0 &&
      !plugin->robot) {
    throw std::invalid_argument(
        "offers nothing; expected a back end, a term, a problem or a robot");
  }
  return *plugin;
}

void add(const PluginSolver& offer, SolverRegistry& registry) {
  if (!offer.name) throw std::invalid_argument("a back end has no name; expected one");
  const std::string name = offer.name;
  if (!offer.make) throw std::invalid_argument("'" + name + "' has no factory; expected one");
  auto solver = call("the factory of '" + name + "'",
                     [&] { return std::unique_ptr<const Solver>(offer.make()); });
  if (!solver) {
    throw std::invalid_argument("the factory of '" + name + "' made nothing; expected a Solver");
  }
  auto guarded = call("options() of '" + name + "'", [&] {
    return std::make_shared<const GuardedSolver>(name, std::move(solver));
  });
  registry.add(std::move(guarded), offer.description ? offer.description : "");
}

std::string text(const char* given) { return given ? given : ""; }

void add(const PluginTerm& offer, TermRegistry& registry) {
  if (!offer.name) throw std::invalid_argument("a term has no name; expected one");
  TermEntry entry{offer.name, text(offer.description)};
  entry.version = offer.version;
  if (!offer.options && offer.num_options > 0) {
    throw std::invalid_argument("term '" + entry.name + "' has no list of its " +
                                std::to_string(offer.num_options) + " options; expected one");
  }
  entry.options.assign(offer.options, offer.options + offer.num_options);
  if (offer.make) {
    entry.make = [make = offer.make](const TermOptions& options, const TermContext& context) {
      return std::shared_ptr<const Term>(make(options, context));
    };
  }
  registry.add(std::move(entry));
}

void add(const PluginProblem& offer, ProblemRegistry& registry) {
  if (!offer.set || !offer.name) {
    throw std::invalid_argument("a problem has no set or no name; expected both");
  }
  ProblemEntry entry;
  entry.set = offer.set;
  entry.name = offer.name;
  entry.set_description = text(offer.description);
  if (offer.make) entry.make = offer.make;
  if (offer.start) entry.start = offer.start;
  if (!std::isnan(offer.best_known)) entry.best_known = offer.best_known;
  registry.add(std::move(entry));
}

}  // namespace

std::string load_plugin(const std::string& path, const PluginTargets& targets) {
  try {
    const Plugin& plugin = open_plugin(path);
    // All that it offers, or nothing.
    SolverRegistry solvers = targets.solvers;
    TermRegistry terms = targets.terms;
    ProblemRegistry problems = targets.problems;
    for (std::size_t i = 0; i < plugin.num_solvers; ++i) add(plugin.solvers[i], solvers);
    for (std::size_t i = 0; i < plugin.num_terms; ++i) add(plugin.terms[i], terms);
    for (std::size_t i = 0; i < plugin.num_problems; ++i) add(plugin.problems[i], problems);
    targets.solvers = std::move(solvers);
    targets.terms = std::move(terms);
    targets.problems = std::move(problems);
    if (targets.robot) *targets.robot = plugin.robot;
    return plugin.abi.optimized != 0
               ? ""
               : one_line("plug-in '" + path +
                          "': was compiled without optimisation and is slow; expected a build "
                          "of type Release");
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(one_line("plug-in '" + path + "': " + e.what()));
  }
}

std::string load_plugin(const std::string& path, SolverRegistry& registry) {
  TermRegistry terms;
  ProblemRegistry problems;
  return load_plugin(path, {registry, terms, problems});
}

}  // namespace prospect
