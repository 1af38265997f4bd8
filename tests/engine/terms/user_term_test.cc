// SPDX-License-Identifier: Apache-2.0
// The term of docs/examples/user_term.
#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "docs/examples/user_term/keep_distance.h"
#include "models/make_model.h"
#include "tests/engine/term_derivatives.h"

namespace prospect::user_term_test {
namespace {

TEST(UserTerm, ItsGradientIsThatOfFiniteDifferences) {
  std::mt19937_64 random(5);
  for (const std::string& name : model_names()) {
    SCOPED_TRACE(name);
    const auto model = make_model(name);
    for (int trial = 0; trial < 5; ++trial) {
      const KeepDistance term({0.2, -0.1}, 0.6);
      const TrajectoryBatch t = test::random_trajectories(*model, 6, 0.25, 1, 0.8, random);
      test::expect_derivative_matches_differences(term, t, 1, 1e-5, 1e-7);
    }
  }
}

TEST(UserTerm, IsOneOnThePointAndVanishesFarAway) {
  const auto model = make_model("unicycle");
  const KeepDistance term({1.0, 2.0}, 0.5);
  TrajectoryBatch t;
  t.horizon = {model.get(), 3, 0.25};
  t.layout = model->pose_layout();
  t.states.setZero(4 * model->nx(), 2);
  t.inputs.setZero(3 * model->nu(), 2);
  for (int k = 0; k <= 3; ++k) {
    t.states(k * model->nx() + t.layout.px, 0) = 1.0;
    t.states(k * model->nx() + t.layout.py, 0) = 2.0;
    t.states(k * model->nx() + t.layout.px, 1) = 9.0;
  }
  const TermOutput out = test::evaluate(term, t, false);
  EXPECT_NEAR(out.value(0, 0), 1.0, 1e-12);
  EXPECT_LT(out.value(0, 1), 1e-12);
}

TEST(UserTerm, HasOptionsThatARegistryTakes) {
  TermEntry entry{"keep_distance", "closeness to a point"};
  entry.options.assign(std::begin(kKeepDistanceOptions), std::end(kKeepDistanceOptions));
  entry.make = [](const TermOptions& options, const TermContext& context) {
    return std::shared_ptr<const Term>(make_keep_distance(options, context));
  };
  TermRegistry registry;
  registry.add(entry);
  EXPECT_EQ(registry.use("keep_distance").options.at("radius"), 0.5);
}

}  // namespace
}  // namespace prospect::user_term_test
