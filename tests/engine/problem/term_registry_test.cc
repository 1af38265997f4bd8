// SPDX-License-Identifier: Apache-2.0
#include "engine/problem/term_registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include "engine/terms/problem_specification.h"
#include "models/unicycle.h"

namespace prospect::term_registry_test {
namespace {

using testing::HasSubstr;

class Constant final : public Term {
 public:
  explicit Constant(double value) : value_(value) {}
  std::string_view name() const override { return "whatever it calls itself"; }
  TermTraits traits() const override { return {}; }
  void evaluate(const TrajectoryBatch&, const TermRequest&, TermScratch*,
                TermOutput& out) const override {
    if (value_ > 5.0) throw std::runtime_error("too much");
    out.value.setConstant(value_);
  }

 private:
  double value_;
};

TermEntry constant() {
  TermEntry entry{"constant", "a number"};
  entry.options = {{"value", 1.0, -2.0, 10.0, "m", "the number"},
                   {"other", 0.0, 0.0, 1.0, "1", "for nothing"}};
  entry.make = [](const TermOptions& options, const TermContext&) {
    return std::make_shared<const Constant>(options.at("value"));
  };
  return entry;
}

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "accepted";
}

std::string refused_entry(const std::function<void(TermEntry&)>& change) {
  TermRegistry registry;
  return refusal([&] {
    TermEntry entry = constant();
    change(entry);
    registry.add(entry);
  });
}

TEST(TermRegistry, IsAValue) {
  TermRegistry one;
  one.add(constant());
  TermRegistry other = one;
  TermEntry entry = constant();
  entry.name = "constant_2";
  other.add(entry);
  EXPECT_EQ(one.list().size(), 1U);
  EXPECT_EQ(other.list().size(), 2U);
  EXPECT_EQ(other.find("constant"), one.find("constant"));
}

TEST(TermRegistry, AUseHasEveryOption) {
  TermRegistry registry;
  registry.add(constant());
  const TermUse use = registry.use("constant", 0.5, {{"value", 3.0}});
  EXPECT_EQ(use.weight, 0.5);
  EXPECT_EQ(use.options, (TermOptions{{"value", 3.0}, {"other", 0.0}}));
  EXPECT_EQ(registry.use("constant").weight, 1.0);
}

TEST(TermRegistry, RefusesInOneLineThatNamesTheCulprit) {
  TermRegistry registry;
  registry.add(constant());
  EXPECT_EQ(refusal([&] { registry.use("constatn"); }),
            "unknown term 'constatn' (did you mean 'constant'?); expected one of: constant");
  EXPECT_EQ(refusal([&] {
              registry.use("constant", 1.0, {{"valeu", 1.0}});
            }),
            "term 'constant': unknown option 'valeu' (did you mean 'value'?); expected one of: "
            "value, other");
  EXPECT_EQ(refusal([&] { registry.use("constant", -0.1); }),
            "term 'constant': weight is -0.1; expected 0 to 1e+06");
  EXPECT_THAT(refusal([&] { registry.use("constant", 2e6); }), HasSubstr("weight is 2e+06"));
  EXPECT_THAT(refusal([&] { registry.use("constant", std::nan("")); }), HasSubstr("weight is nan"));
  EXPECT_EQ(refusal([&] {
              registry.use("constant", 1.0, {{"value", 10.5}});
            }),
            "term 'constant': option 'value' is 10.5; expected -2 to 10 [m]");
  EXPECT_THAT(refusal([&] {
                registry.use("constant", 1.0, {{"value", std::nan("")}});
              }),
              HasSubstr("option 'value' is nan"));
  EXPECT_THAT(refusal([&] { registry.add(constant()); }),
              HasSubstr("named 'constant' already; expected another name"));
}

TEST(TermRegistry, RefusesEntriesThatCannotBeUsed) {
  EXPECT_EQ(refused_entry([](TermEntry&) {}), "accepted");
  for (const char* name : {"", "my term", "my.term", "a,b"}) {
    EXPECT_THAT(refused_entry([&](TermEntry& e) { e.name = name; }),
                HasSubstr("a term is named '" + std::string(name) + "'"));
  }
  EXPECT_THAT(refused_entry([](TermEntry& e) { e.make = nullptr; }), HasSubstr("no factory"));
  EXPECT_THAT(refused_entry([](TermEntry& e) { e.version = 0; }), HasSubstr("has version 0"));
  EXPECT_THAT(refused_entry([](TermEntry& e) { e.options[0].name = "weight"; }),
              HasSubstr("option 'weight' of term 'constant' is named so"));
  EXPECT_THAT(refused_entry([](TermEntry& e) { e.options[1].name = "value"; }),
              HasSubstr("is there twice"));
  EXPECT_THAT(refused_entry([](TermEntry& e) { e.options[0].fallback = 11.0; }),
              HasSubstr("has the default 11; expected -2 to 10"));
  EXPECT_THAT(refused_entry([](TermEntry& e) {
                e.options[0].most = std::numeric_limits<double>::infinity();
              }),
              HasSubstr("expected finite ends"));
}

TEST(TermRegistry, AConstraintIsThereOrIsNot) {
  TermRegistry registry;
  TermEntry entry = constant();
  entry.constraint = true;
  registry.add(entry);
  EXPECT_EQ(registry.use("constant", 0.0).weight, 0.0);
  EXPECT_THAT(refusal([&] { registry.use("constant", 0.5); }),
              HasSubstr("weight is 0.5; expected 1, or 0 to leave it out"));
}

TEST(MakeTerm, KeepsExceptionsOfTheTermAway) {
  TermRegistry registry;
  registry.add(constant());
  const ProblemSpecification specification;
  const CachedEvaluators evaluators;
  const TermContext context{specification, evaluators};
  Unicycle model;
  TrajectoryBatch t;
  t.horizon = {&model, 2, 0.1};
  TermOutput out;
  out.value.setZero(1, 3);
  const auto sound = make_term(registry.use("constant", 1.0, {{"value", 2.0}}), context);
  EXPECT_EQ(sound->name(), "constant") << "as it is registered";
  sound->evaluate(t, {}, nullptr, out);
  EXPECT_TRUE((out.value == 2.0).all());
  make_term(registry.use("constant", 1.0, {{"value", 6.0}}), context)
      ->evaluate(t, {}, nullptr, out);
  EXPECT_TRUE(out.value.isNaN().all());
}

TEST(MakeTerm, SaysWhatAFactoryFailsOf) {
  const ProblemSpecification specification;
  const CachedEvaluators evaluators;
  const auto refused = [&](TermEntry::Factory make) {
    TermEntry entry = constant();
    entry.make = std::move(make);
    TermRegistry registry;
    registry.add(entry);
    return refusal([&] { make_term(registry.use("constant"), {specification, evaluators}); });
  };
  using Made = std::shared_ptr<const Term>;
  EXPECT_EQ(refused([](const TermOptions&, const TermContext&) -> Made {
              throw std::runtime_error("no map");
            }),
            "term 'constant': its factory failed: no map");
  EXPECT_THAT(refused([](const TermOptions&, const TermContext&) -> Made { throw 42; }),
              HasSubstr("not a std::exception"));
  EXPECT_EQ(refused([](const TermOptions&, const TermContext&) -> Made { return nullptr; }),
            "term 'constant': its factory made nothing; expected a Term");
}

}  // namespace
}  // namespace prospect::term_registry_test
