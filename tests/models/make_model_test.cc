// SPDX-License-Identifier: Apache-2.0
#include "models/make_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include "models/numeric_difference.h"
#include "models/unicycle.h"

namespace prospect::make_model_test {
namespace {

using testing::HasSubstr;

std::string error_of(const std::string& name, const ModelParameters& parameters = {}) {
  try {
    make_model(name, parameters);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST(MakeModel, MakesEveryModelItNames) {
  EXPECT_EQ(model_names(),
            (std::vector<std::string>{"unicycle", "unicycle_accel", "holonomic", "multirotor"}));
  for (const std::string& name : model_names()) EXPECT_EQ(make_model(name)->name(), name);
}

TEST(MakeModel, TakesParametersByName) {
  const auto model = make_model("unicycle", {{"v_max", 0.9}, {"omega_max", 0.7}});
  EXPECT_EQ(model->limits().upper, Eigen::VectorXd(Eigen::Vector2d(0.9, 0.7)));
  EXPECT_EQ(model->limits().rate[0], Unicycle::Parameters().a_max);
}

TEST(MakeModel, NamesTheNearestModelOrParameter) {
  EXPECT_THAT(error_of("unicicle"), HasSubstr("did you mean 'unicycle'?"));
  EXPECT_THAT(error_of("unicycle_acc"), HasSubstr("did you mean 'unicycle_accel'?"));
  EXPECT_THAT(error_of("quadrotor"), HasSubstr("; expected one of: unicycle, "));
  EXPECT_THAT(error_of(""), HasSubstr("unknown motion model ''"));
  EXPECT_THAT(error_of("unicycle", {{"vmax", 1.0}}),
              HasSubstr("unknown parameter of model unicycle 'vmax'"));
  EXPECT_THAT(error_of("unicycle", {{"vmax", 1.0}}), HasSubstr("did you mean 'v_max'?"));
  EXPECT_THAT(error_of("multirotor", {{"fixed_z", 1.0}}), HasSubstr("unknown parameter"));
}

TEST(MakeModel, RefusesEveryParameterOutOfRangeByNameAndValue) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const std::string& name : model_names()) {
    for (const auto& [parameter, value] : default_parameters(name)) {
      for (double bad : {nan, infinity, -infinity}) {
        EXPECT_THAT(error_of(name, {{parameter, bad}}),
                    HasSubstr(name + ": " + parameter + " is "));
      }
      if (parameter == "fixed_z") continue;  // any finite height is good
      const bool lower = parameter == "v_min" || parameter == "vx_min";
      EXPECT_THAT(error_of(name, {{parameter, lower ? 0.25 : -0.25}}),
                  HasSubstr(parameter + " is "));
      EXPECT_THAT(error_of(name, {{parameter, lower ? 0.25 : -0.25}}),
                  HasSubstr("expected a number"));
      if (!lower) {
        EXPECT_THAT(error_of(name, {{parameter, 0.0}}), HasSubstr(parameter + " is 0"));
      }
    }
  }
}

TEST(MakeModel, ParametersRoundTrip) {
  for (const std::string& name : model_names()) {
    ModelParameters parameters = default_parameters(name);
    EXPECT_EQ(parameters_of(*make_model(name)), parameters);
    double scale = 1.01;
    for (auto& [parameter, value] : parameters) value *= scale += 0.01;
    EXPECT_EQ(parameters_of(*make_model(name, parameters)), parameters);
  }
}

TEST(MakeModel, DoesNotInventParametersOfOtherModels) {
  const NumericDifference twin(make_model("unicycle"));
  EXPECT_THROW(parameters_of(twin), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::make_model_test
