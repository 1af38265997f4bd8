// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "engine/terms/control_effort.h"
#include "engine/terms/input_rate.h"
#include "keep_distance.h"
#include "models/unicycle.h"

/// A problem of one's own: drive ahead, and keep away from a person on the way.
inline prospect::ProblemDefinition past_a_person() {
  const auto model = std::make_shared<prospect::Unicycle>();
  const Eigen::Vector2d ahead(model->max_speed(), 0.0);  // (v, omega)
  prospect::ProblemDefinition definition;
  definition.model = model;
  definition.x0 = Eigen::Vector3d::Zero();  // (x, y, heading)
  definition.u_previous = Eigen::Vector2d::Zero();
  definition.terms = {
      {std::make_shared<prospect::ControlEffort>(ahead, model->limits()), 0.3},
      {std::make_shared<prospect::InputRate>(model->limits()), 0.03},
      {std::make_shared<KeepDistance>(Eigen::Vector2d(1.2, 0.1), 0.5), 1.0},
  };
  return definition;
}

/// Where back ends start.
inline Eigen::VectorXd straight_ahead() {
  const prospect::ProblemDefinition definition = past_a_person();
  const Eigen::Vector2d ahead(definition.model->max_speed(), 0.0);
  return ahead.replicate(definition.M, 1);
}
