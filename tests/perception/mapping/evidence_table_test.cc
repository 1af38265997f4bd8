// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/evidence_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace prospect::evidence_table_test {
namespace {

constexpr EvidenceTable::Model kModel{0.84730F, -0.40547F, -2.00003F, 2.19722F};

float applied(float l, bool hit) {
  return std::min(std::max(l + (hit ? kModel.hit : kModel.miss), kModel.lowest), kModel.highest);
}

// Of 40 scans at most: each of the table rounds by 2^-17.
constexpr float kRounding = 5e-4F;

TEST(EvidenceTable, SaysWhatTheScansWouldHaveMade) {
  std::mt19937 generator(1);
  EvidenceTable table(kModel);
  for (int n = 0; n < 3000; ++n) {
    const int scans = 1 + n % 40;
    const double share = 0.1 * static_cast<double>(n % 11);
    std::bernoulli_distribution hits(share);
    EvidenceTable::State s = EvidenceTable::kNothing;
    const std::vector<float> before = {-2.0F, -0.7F, 0.0F, 0.3F, 2.19F};
    std::vector<float> after = before;
    for (int k = 0; k < scans; ++k) {
      const bool hit = hits(generator);
      s = hit ? table.after_hit(s) : table.after_miss(s);
      for (float& l : after) l = applied(l, hit);
    }
    for (std::size_t k = 0; k < before.size(); ++k) {
      EXPECT_NEAR(table.of_known(s, before[k]), after[k], kRounding);
    }
    EXPECT_NEAR(table.of_unknown(s), after[2], kRounding);
    EXPECT_EQ(table.is_surface(s), table.of_unknown(s) >= 0.0F);
  }
  EXPECT_LT(table.size(), 6000U);
}

TEST(EvidenceTable, TwoSequencesAreAsOne) {
  std::mt19937 generator(2);
  EvidenceTable table(kModel);
  std::bernoulli_distribution hits(0.4);
  for (int n = 0; n < 2000; ++n) {
    EvidenceTable::State whole = EvidenceTable::kNothing, parts[2] = {};
    for (int k = 0; k < 16; ++k) {
      const bool hit = hits(generator);
      whole = hit ? table.after_hit(whole) : table.after_miss(whole);
      EvidenceTable::State& part = parts[k >= n % 16];
      part = hit ? table.after_hit(part) : table.after_miss(part);
    }
    EXPECT_EQ(table.sequence(parts[0], parts[1]), whole);
  }
}

TEST(EvidenceTable, AGrazeSaysSomethingOnlyWhereNothingIsKnown) {
  EvidenceTable table(kModel);
  const EvidenceTable::State graze = table.after_graze(EvidenceTable::kNothing);
  EXPECT_EQ(table.of_known(graze, 1.25F), 1.25F);
  EXPECT_NEAR(table.of_unknown(graze), kModel.miss, kRounding);
  EXPECT_EQ(table.after_graze(graze), graze);
  const EvidenceTable::State hit = table.after_hit(EvidenceTable::kNothing);
  EXPECT_EQ(table.after_graze(hit), hit);
  EXPECT_EQ(table.sequence(hit, graze), hit);
  EXPECT_NEAR(table.of_unknown(table.sequence(graze, hit)), kModel.miss + kModel.hit, kRounding);
}

TEST(EvidenceTable, WhatIsToldHoldsWhateverWasKnown) {
  EvidenceTable table(kModel);
  const EvidenceTable::State told = table.told(-2.0F);
  EXPECT_EQ(table.of_known(told, 2.0F), -2.0F);
  EXPECT_EQ(table.of_unknown(told), -2.0F);
  EXPECT_EQ(table.sequence(table.after_hit(EvidenceTable::kNothing), told), told);
}

TEST(EvidenceTable, ManyMissesAreOneState) {
  EvidenceTable table(kModel);
  EvidenceTable::State s = EvidenceTable::kNothing;
  for (int k = 0; k < 1000; ++k) s = table.after_miss(s);
  EXPECT_EQ(table.after_miss(s), s);
  EXPECT_LT(table.size(), 30U);
}

}  // namespace
}  // namespace prospect::evidence_table_test
