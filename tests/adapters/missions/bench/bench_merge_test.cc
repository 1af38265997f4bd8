// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/bench_merge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/bench/bench_files.h"
#include "tests/adapters/bench_example.h"
#include "tests/adapters/bench_folders.h"

namespace prospect::bench_merge_test {
namespace {

using ::testing::HasSubstr;

class BenchMerge : public test::BenchFolders {
 protected:
  static std::string refusal(const std::vector<std::string>& folders) {
    try {
      merge_benches(folders);
    } catch (const InputError& e) {
      return e.what();
    }
    return "accepted";
  }
  /// One back end of the example.
  static BenchTable part(int solver) {
    BenchTable t = test::bench_example();
    std::erase_if(t.rows, [&](const BenchRow& row) { return row.solver != solver; });
    for (BenchRow& row : t.rows) row.solver = 0;
    t.solvers = {t.solvers[static_cast<std::size_t>(solver)]};
    return t;
  }
};

TEST_F(BenchMerge, PartsByBackEndMakeTheWhole) {
  const BenchTable merged = merge_benches({write("a", part(0)), write("b", part(1))});
  EXPECT_EQ(bench_csv(merged), bench_csv(test::bench_example()));
}

TEST_F(BenchMerge, PartsByProblemMakeTheWhole) {
  BenchTable a = test::bench_example(8), b = a;
  std::erase_if(a.rows, [](const BenchRow& row) { return row.problem >= 3; });
  a.sets[0].problems.resize(3);
  std::erase_if(b.rows, [](const BenchRow& row) { return row.problem < 3; });
  for (BenchRow& row : b.rows) row.problem -= 3;
  b.sets[0].problems.erase(b.sets[0].problems.begin(), b.sets[0].problems.begin() + 3);
  const BenchTable merged = merge_benches({write("a", a), write("b", b)});
  EXPECT_EQ(bench_csv(merged), bench_csv(test::bench_example(8)));
}

TEST_F(BenchMerge, RefusesWhatDoesNotBelongTogether) {
  const std::string a = write("a", part(0)), b = write("b", part(1));
  EXPECT_THAT(refusal({a, a}),
              HasSubstr("'fast' on 'p0' of set, no deadline, seed 1 is in another"));
  EXPECT_THAT(refusal({a, folder_ + "/none"}), HasSubstr("no such file; expected"));
  BenchTable other = part(1);
  other.sets[0].problems[2].fingerprint = "feed";
  EXPECT_THAT(refusal({a, write("c", other)}),
              HasSubstr("c: problem 'p2' of 'set' is another one"));
  other = part(1);
  other.repeats = 5;
  EXPECT_THAT(refusal({a, write("d", other)}), HasSubstr("d: repeats 5; expected 1"));
  other = part(1);
  other.rows.pop_back();
  EXPECT_THAT(refusal({a, write("e", other)}), HasSubstr("no row of 'slow' on 'p7'"));
  EXPECT_EQ(refusal({a, b}), "accepted");
}

}  // namespace
}  // namespace prospect::bench_merge_test
