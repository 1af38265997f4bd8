// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/faults/injected_fault.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace prospect::injected_fault_test {
namespace {

std::string refusal(const std::string& text) {
  try {
    parse_fault(text);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

TEST(InjectedFault, IsReadWithItsTimes) {
  const InjectedFault always = parse_fault("depth:off");
  EXPECT_EQ(always.source, FaultSource::kDepth);
  EXPECT_EQ(always.verb, FaultVerb::kOff);
  EXPECT_TRUE(always.holds(0.0) && always.holds(1e6));
  const InjectedFault later = parse_fault("planner:stuck@10");
  EXPECT_FALSE(later.holds(9.9));
  EXPECT_TRUE(later.holds(1e6));
  const InjectedFault for_a_while = parse_fault("link:delayed@10.5+2");
  EXPECT_FALSE(for_a_while.holds(10.4));
  EXPECT_TRUE(for_a_while.holds(12.4));
  EXPECT_FALSE(for_a_while.holds(12.5));
}

TEST(InjectedFault, EachSourceAndVerbHasAMeaningOrAReason) {
  std::size_t found = 0;
  for (int s = 0; s < kFaultSources; ++s) {
    for (int v = 0; v < kFaultVerbs; ++v) {
      const auto source = static_cast<FaultSource>(s);
      const auto verb = static_cast<FaultVerb>(v);
      const FaultKind* kind = fault_kind(source, verb);
      const std::string text = name_of({source, verb});
      // What moves has verbs of its own, what tells something the others.
      EXPECT_EQ(kind != nullptr, (source == FaultSource::kBase) == (verb >= FaultVerb::kInverted));
      if (!kind) {
        EXPECT_NE(refusal(text).find("expected a verb of " + std::string(to_string(source)) + ": "),
                  std::string::npos);
        continue;
      }
      ++found;
      EXPECT_EQ(kind->source, source);
      EXPECT_EQ(kind->verb, verb);
      EXPECT_FALSE(kind->text.empty());
      if (kind->implemented) {
        EXPECT_EQ(name_of(parse_fault(text)), text);
      } else {
        EXPECT_EQ(refusal(text), "'" + text + "'; expected a fault that has a meaning; " +
                                     std::string(kind->text));
      }
    }
  }
  EXPECT_EQ(found, fault_kinds().size());
}

TEST(InjectedFault, WhatNobodyKnowsIsRefusedByName) {
  EXPECT_EQ(refusal("sonar:off").find("'sonar:off'; expected a source: left-camera, "), 0u);
  EXPECT_EQ(refusal("depth:broken").find("'depth:broken'; expected a verb: off, stuck, "), 0u);
  for (const char* text :
       {":", "", "depth", "depth:", ":off", "depth:off@", "depth:off@x", "depth:off@-1",
        "depth:off@1+", "depth:off@1+0", "depth:off@nan", "depth:off@1+2+3", "depth@3:off"}) {
    EXPECT_NE(refusal(text), "") << text;
  }
}

// The page of the runtime is that text.
TEST(InjectedFault, TheDocumentationHasTheTable) {
  std::ifstream file(std::string(PROSPECT_SOURCE_DIR) + "/docs/reference/runtime.md");
  std::stringstream page;
  page << file.rdbuf();
  EXPECT_NE(page.str().find(fault_table()), std::string::npos) << fault_table();
}

TEST(InjectedFault, IsFoundByItsTime) {
  const std::vector<InjectedFault> faults = {parse_fault("depth:off@5+1"),
                                             parse_fault("depth:off@8")};
  EXPECT_FALSE(fault_at(faults, FaultSource::kDepth, FaultVerb::kOff, 4.0));
  EXPECT_TRUE(fault_at(faults, FaultSource::kDepth, FaultVerb::kOff, 5.5));
  EXPECT_FALSE(fault_at(faults, FaultSource::kDepth, FaultVerb::kOff, 7.0));
  EXPECT_TRUE(fault_at(faults, FaultSource::kDepth, FaultVerb::kOff, 9.0));
  EXPECT_FALSE(fault_at(faults, FaultSource::kCameras, FaultVerb::kOff, 9.0));
  const std::vector<InjectedFault> at_times = {parse_fault("link:intermittent@1+3")};
  for (const auto& [time, off] :
       {std::pair{0.9, false}, {1.1, true}, {1.6, false}, {2.1, true}, {3.1, true}, {4.1, false}}) {
    EXPECT_EQ(off_at_times(at_times, FaultSource::kLink, 0.5, time), off) << time;
  }
}

}  // namespace
}  // namespace prospect::injected_fault_test
