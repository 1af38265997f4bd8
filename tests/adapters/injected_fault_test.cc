#include "adapters/simulator/injected_fault.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

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

TEST(InjectedFault, AllThatAreImplementedCanBeAskedFor) {
  for (const ImplementedFault& one : implemented_faults()) {
    const std::string text =
        std::string(to_string(one.source)) + ':' + std::string(to_string(one.verb));
    EXPECT_EQ(parse_fault(text).source, one.source) << text;
    EXPECT_EQ(parse_fault(text).verb, one.verb) << text;
  }
}

TEST(InjectedFault, WhatNobodyImplementsIsRefusedByName) {
  const std::string message = refusal("depth:garbage");
  EXPECT_EQ(message.find("'depth:garbage'; expected a fault that is implemented: "), 0u) << message;
  EXPECT_NE(message.find("depth:off"), std::string::npos);
  for (const char* text : {"wheels:off", "left-camera:off", "sonar:off", "depth:broken", ":", ""}) {
    EXPECT_NE(refusal(text), "") << text;
  }
  for (const char* text : {"depth:off@", "depth:off@x", "depth:off@-1", "depth:off@1+",
                           "depth:off@1+0", "depth:off@nan", "depth:off@1+2+3", "depth@3:off"}) {
    EXPECT_NE(refusal(text), "") << text;
  }
}

TEST(InjectedFault, IsFoundByItsTime) {
  const std::vector<InjectedFault> faults = {parse_fault("depth:off@5+1"),
                                             parse_fault("depth:off@8")};
  EXPECT_FALSE(fault_at(faults, FaultSource::kDepth, FaultVerb::kOff, 4.0));
  EXPECT_TRUE(fault_at(faults, FaultSource::kDepth, FaultVerb::kOff, 5.5));
  EXPECT_FALSE(fault_at(faults, FaultSource::kDepth, FaultVerb::kOff, 7.0));
  EXPECT_TRUE(fault_at(faults, FaultSource::kDepth, FaultVerb::kOff, 9.0));
  EXPECT_FALSE(fault_at(faults, FaultSource::kCameras, FaultVerb::kOff, 9.0));
}

}  // namespace
}  // namespace prospect::injected_fault_test
