// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/bench_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <variant>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/bench/bench_files.h"
#include "adapters/missions/bench/bench_rows.h"
#include "adapters/missions/bench/bench_run.h"
#include "adapters/missions/bench/bench_summary.h"
#include "adapters/missions/config/registries.h"

namespace prospect::bench_settings_test {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(BenchSettings, LaterOnesStandAboveAndDefaultsAreInEffect) {
  const SolverRegistry solvers = Registries().solvers;
  const BenchSettings read = read_bench_settings(
      {"deadline=0.5", "solver=hybrid", "options.candidates=20", "deadline=0.1"}, solvers);
  EXPECT_EQ(read.solver, "hybrid");
  EXPECT_EQ(std::get<int>(read.options.at("candidates")), 20);
  EXPECT_EQ(read.deadline, 0.1);
  EXPECT_EQ(read.max_evaluations, 10000);
  EXPECT_EQ(read.repeats, 1);
  std::vector<std::string> paths;
  for (const ConfigEntry& entry : read.entries) paths.push_back(entry.path);
  EXPECT_THAT(
      paths, ElementsAre("solver", "options.candidates", "deadline", "max_evaluations", "repeats"));
  EXPECT_THAT(bench_words(read, "zoo", 7, "out"),
              ElementsAre("bench", "zoo", "--solver", "hybrid,candidates=20", "--deadline", "0.1",
                          "--max-evaluations", "10000", "--repeat", "1", "--seed", "7", "--out",
                          "out", "--resume", "--quiet"));
}

TEST(BenchSettings, SaysAllThatIsWrong) {
  try {
    read_bench_settings(
        {"solver=hybrid", "options.candidats=20", "deadline=-1", "repeats=0", "planner.N=12"},
        Registries().solvers);
    FAIL() << "expected a refusal";
  } catch (const InputError& error) {
    EXPECT_THAT(error.lines(),
                ElementsAre(HasSubstr("--set options.candidats=20: options.candidats: hybrid: "
                                      "unknown option 'candidats' (did you mean 'candidates'?)"),
                            HasSubstr("--set deadline=-1: deadline: "),
                            HasSubstr("--set repeats=0: repeats: "),
                            HasSubstr("--set planner.N=12: unknown key 'planner'")));
  }
  try {
    read_bench_settings({"solver=hybird", "options.candidates=20"}, Registries().solvers);
    FAIL() << "expected a refusal";
  } catch (const InputError& error) {
    EXPECT_THAT(error.lines(), ElementsAre(HasSubstr("did you mean 'hybrid'?")));
  }
}

TEST(LacksOfBench, IsNothingOnceAllRowsAndTheLastFileAreThere) {
  const std::string folder = ::testing::TempDir() + "lacks_of_bench";
  fs::remove_all(folder);
  EXPECT_EQ(lacks_of_bench(folder), "no bench.json");
  const Registries registries;
  std::vector<ProblemSet> sets = {make_problem_set("zoo", {}, registries, false)};
  sets[0].problems.resize(2);
  const std::vector<SolverChoice> solvers = choose_solvers({"nlopt"}, registries.solvers);
  BenchTable table = run_bench(sets, solvers, {});
  OutputFolder output = open_bench_folder(folder, EarlierRows::kRefused);
  begin_bench_folder(output);
  { const BenchRowFile rows(folder, table); }
  EXPECT_EQ(lacks_of_bench(folder), "no bench.json");
  write_bench_folder(output, table, summarize(table));
  EXPECT_EQ(lacks_of_bench(folder), "");
  table.rows.pop_back();
  { const BenchRowFile rows(folder, table); }
  EXPECT_EQ(lacks_of_bench(folder), "rows.jsonl has 1 of 2 rows");
  table.cancelled = true;
  write_bench_folder(output, table, summarize(table));
  EXPECT_EQ(lacks_of_bench(folder), "the bench was cancelled");
  std::ofstream(folder + "/bench.json") << "{";
  EXPECT_EQ(lacks_of_bench(folder), "bench.json is damaged");
  fs::remove_all(folder);
}

TEST(BenchFolder, RowsAreNeverLostUnasked) {
  const std::string folder = ::testing::TempDir() + "bench_rows_kept";
  fs::remove_all(folder);
  const Registries registries;
  std::vector<ProblemSet> sets = {make_problem_set("zoo", {}, registries, false)};
  sets[0].problems.resize(2);
  BenchTable table = run_bench(sets, choose_solvers({"nlopt"}, registries.solvers), {});
  const auto rows = [&] { return read_bench_rows(folder).rows.size(); };
  const auto refusal = [&]() -> std::string {
    try {
      open_bench_folder(folder, EarlierRows::kRefused);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  // Broken off by a signal it writes all files, too: what is on disk is no sign of its end.
  for (const bool cancelled : {true, false}) {
    table.cancelled = cancelled;
    {
      OutputFolder output = open_bench_folder(folder, EarlierRows::kKept);
      begin_bench_folder(output);
      const BenchRowFile file(folder, table);
      EXPECT_THAT(refusal(), HasSubstr("another run writes to it"));
      write_bench_folder(output, table, summarize(table));
    }
    EXPECT_THAT(refusal(),
                HasSubstr(cancelled ? "that was broken off; expected --resume, or another"
                                    : "holds a bench; expected --resume, or another"));
    EXPECT_EQ(rows(), 2U);
    EXPECT_TRUE(fs::exists(folder + "/bench.json"));
  }
  {
    OutputFolder output = open_bench_folder(folder, EarlierRows::kReplaced);
    begin_bench_folder(output);
    EXPECT_EQ(rows(), 2U) << "until there are others";
    EXPECT_FALSE(fs::exists(folder + "/bench.json"));
  }
  EXPECT_THAT(refusal(), HasSubstr("broken off")) << "killed before its first row";
  fs::remove_all(folder);
}

}  // namespace
}  // namespace prospect::bench_settings_test
