// SPDX-License-Identifier: Apache-2.0
#include "solvers/load_plugin.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "models/version.h"
#include "solvers/options.h"
#include "solvers/plugin.h"
#include "tests/solvers/problem_zoo.h"

namespace prospect::load_plugin_test {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::vector<std::string> names(const SolverRegistry& registry) {
  std::vector<std::string> all;
  for (const SolverInfo& info : registry.list()) all.push_back(info.name);
  return all;
}

/// What load_plugin() says of the file, which must leave the registry as it was.
std::string refusal(const std::string& path) {
  SolverRegistry registry;
  std::string message = "accepted";
  try {
    load_plugin(path, registry);
  } catch (const std::invalid_argument& e) {
    message = e.what();
    EXPECT_EQ(names(registry), names(SolverRegistry()));
    EXPECT_THAT(message, AllOf(StartsWith("plug-in '" + path + "': "), Not(HasSubstr("\n"))));
  }
  return message;
}

class FaultyPlugin : public testing::Test {
 protected:
  ~FaultyPlugin() override { unsetenv("PROSPECT_TEST_FAULT"); }
  static void set_fault(const std::string& fault) {
    setenv("PROSPECT_TEST_FAULT", fault.c_str(), 1);
  }
  static std::string refusal_of(const std::string& fault) {
    set_fault(fault);
    return refusal(PROSPECT_PLUGIN_FAULTY);
  }
  static std::shared_ptr<const Solver> misfit(const std::string& fault) {
    set_fault(fault);
    SolverRegistry registry;
    load_plugin(PROSPECT_PLUGIN_FAULTY, registry);
    return registry.make("misfit");
  }
};

TEST(LoadPlugin, AddsItsBackEndToOneRegistryAlone) {
  SolverRegistry registry;
  load_plugin(PROSPECT_PLUGIN_EXAMPLE, registry);
  std::vector<std::string> expected = names(SolverRegistry());
  expected.push_back("differential_evolution");
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(names(registry), expected);
  for (const SolverInfo& info : registry.list()) {
    if (info.name != "differential_evolution") continue;
    EXPECT_TRUE(info.available);
    EXPECT_THAT(info.description, HasSubstr("population"));
    ASSERT_EQ(info.options.size(), common_options().size() + 3U);
    EXPECT_EQ(info.options[common_options().size()].name, "population");
  }
  EXPECT_THROW(make_solver("differential_evolution"), std::invalid_argument);
  try {
    registry.make("differential_evolutoin");
    ADD_FAILURE() << "made";
  } catch (const std::invalid_argument& e) {
    EXPECT_THAT(e.what(), HasSubstr("did you mean 'differential_evolution'?"));
  }
}

TEST(LoadPlugin, RefusesTheSameNameTwice) {
  SolverRegistry registry;
  load_plugin(PROSPECT_PLUGIN_EXAMPLE, registry);
  try {
    load_plugin(PROSPECT_PLUGIN_EXAMPLE, registry);
    ADD_FAILURE() << "accepted";
  } catch (const std::invalid_argument& e) {
    EXPECT_THAT(e.what(),
                HasSubstr("named 'differential_evolution' already; expected another name"));
  }
}

TEST(LoadPlugin, ItsSolverOutlivesEveryRegistry) {
  std::shared_ptr<const Solver> solver;
  {
    SolverRegistry registry;
    load_plugin(PROSPECT_PLUGIN_EXAMPLE, registry);
    solver = registry.make("differential_evolution");
  }
  const zoo::Case c = zoo::camel();
  const Result r = solver->solve(c.problem(), {}, {}, {});
  EXPECT_NEAR(r.cost, c.optimum, 1e-4);
}

TEST(LoadPlugin, TakesAPathInTheWorkingFolderForWhatItIs) {
  const std::filesystem::path file = PROSPECT_PLUGIN_EXAMPLE;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(file.parent_path());
  SolverRegistry registry;
  EXPECT_NO_THROW(load_plugin(file.filename().string(), registry));
  std::filesystem::current_path(before);
  EXPECT_EQ(refusal("libm.so.6"),
            "plug-in 'libm.so.6': no such file; expected a shared library (.so)");
}

TEST(LoadPlugin, RefusesWhatIsNoSharedLibrary) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "prospect plug-ins";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const std::string expected = "; expected a shared library (.so)";
  const auto path = [&](const char* name) { return (folder / name).string(); };
  EXPECT_THAT(refusal(""), EndsWith("no such file" + expected));
  EXPECT_THAT(refusal(path("missing.so")), EndsWith("no such file" + expected));
  EXPECT_THAT(refusal(folder.string()), EndsWith("is a directory" + expected));
  ASSERT_EQ(mkfifo(path("pipe.so").c_str(), 0600), 0);
  EXPECT_THAT(refusal(path("pipe.so")), EndsWith("is not a regular file" + expected));
  std::ofstream(path("empty.so"));
  EXPECT_THAT(refusal(path("empty.so")), EndsWith(expected));
  std::ofstream(path("text.so")) << std::string(10000, 'x');
  EXPECT_THAT(refusal(path("text.so")), AllOf(HasSubstr("ELF"), EndsWith(expected)));
  EXPECT_THAT(refusal("/proc/self/exe"), EndsWith(expected));  // a program, not a library
  // A copy that was cut off anywhere.
  const std::uintmax_t size = std::filesystem::file_size(PROSPECT_PLUGIN_EXAMPLE);
  for (const std::uintmax_t length : {std::uintmax_t{20}, std::uintmax_t{64}, std::uintmax_t{5000},
                                      size / 4, size / 2, size - 1}) {
    const std::string cut = path(("cut_" + std::to_string(length) + ".so").c_str());
    std::filesystem::copy_file(PROSPECT_PLUGIN_EXAMPLE, cut);
    std::filesystem::resize_file(cut, length);
    EXPECT_THAT(refusal(cut), EndsWith(expected)) << length;
  }
  std::filesystem::remove_all(folder);
}

TEST(LoadPlugin, RefusesALibraryWithoutEntryPoint) {
  EXPECT_THAT(refusal(PROSPECT_PLUGIN_EMPTY),
              HasSubstr("has no entry point; expected a function 'prospect_plugin'"));
}

TEST_F(FaultyPlugin, IsGoodWithoutAFault) {
  EXPECT_EQ(refusal_of(""), "accepted");
  EXPECT_EQ(refusal_of("no description"), "accepted");
  set_fault("two");
  SolverRegistry registry;
  load_plugin(PROSPECT_PLUGIN_FAULTY, registry);
  EXPECT_EQ(registry.make("misfit")->name(), "misfit");
  // Named as it was offered, whatever it calls itself.
  EXPECT_EQ(registry.make("another")->name(), "another");
}

TEST_F(FaultyPlugin, OfAnotherInterfaceIsRefused) {
  EXPECT_THAT(
      refusal_of("interface"),
      HasSubstr("has plug-in interface " + std::to_string(kPluginInterface + 1) + "; expected " +
                std::to_string(kPluginInterface) + ", that of Prospect " + kVersion));
}

TEST_F(FaultyPlugin, OfAnotherBinaryInterfaceIsRefused) {
  EXPECT_THAT(refusal_of("version"),
              HasSubstr(std::string("was built with Prospect 0.0.9; expected ") + kVersion +
                        ", as this program"));
  EXPECT_THAT(refusal_of("no version"), HasSubstr("built with Prospect unknown; expected"));
  EXPECT_THAT(
      refusal_of("alignment"),
      HasSubstr("Eigen's alignment (-m flags) of " + std::to_string(2 * EIGEN_MAX_ALIGN_BYTES) +
                "; expected " + std::to_string(EIGEN_MAX_ALIGN_BYTES)));
  for (const auto& [fault, what] : std::vector<std::pair<std::string, std::string>>{
           {"compiler", "C++ ABI "},
           {"standard library", "libstdc++ "},
           {"strings", "_GLIBCXX_USE_CXX11_ABI "},
           {"containers", "_GLIBCXX_DEBUG "},
           {"eigen", "Eigen 304"},
           {"static alignment", "static alignment"},
           {"row major", "EIGEN_DEFAULT_TO_ROW_MAJOR "},
           {"index", "Eigen::Index of size "},
           {"problem", "a Problem of size "},
           {"evaluation", "an Evaluation of size "},
           {"trajectories", "a TrajectoryBatch of size "},
           {"traits", "a TermTraits of size "},
           {"result", "a Result of size "},
           {"definition", "a ProblemDefinition of size "},
           {"specification", "a ProblemSpecification of size "},
           {"evaluators", "CachedEvaluators of size "},
       }) {
    EXPECT_THAT(refusal_of(fault), AllOf(HasSubstr("was built with "), HasSubstr(what),
                                         HasSubstr("; expected "), EndsWith(", as this program")));
  }
}

TEST_F(FaultyPlugin, WithNothingToOfferIsRefused) {
  EXPECT_THAT(refusal_of("no solvers"), EndsWith("has no list of its 1 back ends; expected one"));
  EXPECT_THAT(refusal_of("zero solvers"),
              EndsWith("offers nothing; expected a back end, a term, a problem or a robot"));
  EXPECT_THAT(refusal_of("entry returns nothing"), HasSubstr("the entry point returned nothing; "));
  EXPECT_THAT(refusal_of("no factory"), EndsWith("'misfit' has no factory; expected one"));
  EXPECT_THAT(refusal_of("factory returns nothing"),
              EndsWith("the factory of 'misfit' made nothing; expected a Solver"));
  EXPECT_THAT(refusal_of("second is bad"), EndsWith("'another' has no factory; expected one"));
}

TEST_F(FaultyPlugin, WithAWrongNameIsRefused) {
  EXPECT_THAT(refusal_of("no name"), EndsWith("a back end has no name; expected one"));
  const std::string expected = "'; expected 1 to 64 letters, digits and _-.: other than 'unknown'";
  EXPECT_THAT(refusal_of("empty name"), HasSubstr("named '" + expected));
  EXPECT_THAT(refusal_of("spaces"), HasSubstr("named 'my solver" + expected));
  EXPECT_THAT(refusal_of("comma"), HasSubstr("named 'my,solver" + expected));
  EXPECT_THAT(refusal_of("newline"), HasSubstr("named 'my solver" + expected));
  EXPECT_THAT(refusal_of("long name"), HasSubstr("xxx" + expected));
  EXPECT_THAT(refusal_of("unknown"), HasSubstr("named 'unknown" + expected));
  EXPECT_THAT(
      refusal_of("built in"),
      EndsWith("there is a back end named 'nlopt:LD_SLSQP' already; expected another name"));
  EXPECT_THAT(refusal_of("twice"), HasSubstr("named 'misfit' already"));
}

TEST_F(FaultyPlugin, ThatThrowsWhileItIsLoadedIsRefused) {
  EXPECT_THAT(refusal_of("entry throws"), EndsWith("the entry point failed: no licence"));
  EXPECT_THAT(refusal_of("entry throws a number"),
              EndsWith("the entry point failed: an exception that is not a std::exception"));
  EXPECT_THAT(refusal_of("factory throws"), EndsWith("the factory of 'misfit' failed: two lines"));
  EXPECT_THAT(refusal_of("factory throws a number"), HasSubstr("not a std::exception"));
  EXPECT_THAT(refusal_of("options throw"),
              EndsWith("options() of 'misfit' failed: no options today"));
}

TEST_F(FaultyPlugin, ThatFailsToSolveGivesATypedFailure) {
  const zoo::Case c = zoo::hs43();
  const Problem problem = c.problem();
  EXPECT_EQ(misfit("")->solve(problem, {}, {}, {}).quality, Quality::kFeasible);
  for (const auto& [fault, why] : std::vector<std::pair<std::string, std::string>>{
           {"solve throws", "no solution today"},
           {"solve throws a number", "not a std::exception"},
           {"wrong size", "a result with 5 variables; expected 4"},
           {"x not finite", "not finite"},
           {"cost not finite", "not finite"},
       }) {
    const Result r = misfit(fault)->solve(problem, {}, {}, {});
    EXPECT_EQ(r.stop, StopReason::kError) << fault;
    EXPECT_EQ(r.quality, Quality::kNone) << fault;
    EXPECT_THAT(r.detail, AllOf(StartsWith("misfit: the plug-in failed: "), HasSubstr(why)));
    EXPECT_EQ(r.x.size(), problem.num_variables()) << fault;
    EXPECT_TRUE(r.x.allFinite()) << fault;
  }
  EXPECT_EQ(misfit("explain throws")->explain_unsupported(problem),
            "the plug-in failed: no explanation today");
}

/// What can be had of a plug-in.
struct Targets {
  SolverRegistry solvers;
  TermRegistry terms;
  ProblemRegistry problems;
  std::string load(const char* path) { return load_plugin(path, {solvers, terms, problems}); }
};

TEST(LoadPlugin, AddsTermsAndProblems) {
  Targets targets;
  EXPECT_EQ(targets.load(PROSPECT_PLUGIN_USER_TERM), "") << "no warning: it is optimised";
  EXPECT_EQ(names(targets.solvers), names(SolverRegistry()));
  const TermUse use = targets.terms.use("keep_distance", 1.0, {{"x", 2.0}});
  EXPECT_EQ(use.options.at("radius"), 0.5);
  EXPECT_EQ(use.entry->version, 1);
  EXPECT_FALSE(use.entry->built_in);
  ASSERT_EQ(targets.problems.sets(), std::vector<std::string>{"person"});
  const ProblemEntry entry = targets.problems.problems("person").front();
  EXPECT_FALSE(entry.best_known.has_value());
  const Problem problem(entry.make());
  ASSERT_EQ(entry.start().size(), problem.num_variables());
  const Result r = make_solver("sampling")->solve(problem, {}, {}, {});
  EXPECT_EQ(r.quality, Quality::kFeasible);
  EXPECT_THROW(targets.load(PROSPECT_PLUGIN_USER_TERM), std::invalid_argument) << "taken";
  EXPECT_EQ(targets.terms.list().size(), 1U);
}

TEST(LoadPlugin, BackEndsAloneWhereNothingElseIsWanted) {
  SolverRegistry registry;
  EXPECT_EQ(load_plugin(PROSPECT_PLUGIN_USER_TERM, registry), "");
  EXPECT_EQ(names(registry), names(SolverRegistry()));
}

TEST_F(FaultyPlugin, WithATermOrAProblemThatCannotBeUsedIsRefusedAsAWhole) {
  for (const auto& [fault, what] : std::vector<std::pair<std::string, std::string>>{
           {"term: no name", "a term has no name; expected one"},
           {"term: no factory", "term 'odd_term' has no factory; expected one"},
           {"term: no options", "term 'odd_term' has no list of its 1 options; expected one"},
           {"term: range", "option 'size' of term 'odd_term' has the range 2 to 1; expected"},
           {"term: version", "term 'odd_term' has version 0 of its options; expected 1 or more"},
           {"term: name", "a term is named 'odd term'; expected"},
           {"problem: no set", "a problem has no set or no name; expected both"},
           {"problem: no factory", "problem 'one' of set 'odd_set' has no factory; expected one"},
           {"problem: best", "has a best cost that is not finite"},
       }) {
    set_fault(fault);
    Targets targets;
    try {
      targets.load(PROSPECT_PLUGIN_FAULTY);
      ADD_FAILURE() << fault << ": accepted";
    } catch (const std::invalid_argument& e) {
      EXPECT_THAT(e.what(), AllOf(StartsWith("plug-in '"), HasSubstr(what), Not(HasSubstr("\n"))));
    }
    EXPECT_EQ(names(targets.solvers), names(SolverRegistry())) << "its back end neither";
    EXPECT_TRUE(targets.terms.list().empty());
    EXPECT_TRUE(targets.problems.sets().empty());
  }
}

TEST_F(FaultyPlugin, ThatIsNotOptimisedIsToldOf) {
  set_fault("not optimised");
  Targets targets;
  EXPECT_THAT(targets.load(PROSPECT_PLUGIN_FAULTY),
              AllOf(StartsWith("plug-in '"), HasSubstr("without optimisation"),
                    HasSubstr("expected a build of type Release")));
  EXPECT_EQ(targets.solvers.make("misfit")->name(), "misfit") << "it is loaded all the same";
}

}  // namespace
}  // namespace prospect::load_plugin_test
