// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "models/motion_model.h"

namespace prospect {

class Knobs;

/// Parameters by name, as configuration and problem files hold them: "v_max" -> 0.6, ... The names
/// are those of the members of each model's Parameters, in the same SI units.
using ModelParameters = std::map<std::string, double>;

/// unicycle, unicycle_accel, holonomic, multirotor.
std::vector<std::string> model_names();

/// All parameters of a model with their defaults. Throws like make_model for an unknown name.
ModelParameters default_parameters(std::string_view name);

/// The knobs (models/knobs.h) of a model, for values by name; those not given begin at their
/// defaults. Throws like make_model for an unknown name.
void describe(Knobs& knobs, std::string_view model, ModelParameters& parameters);

/// The model of that name; parameters not given keep their defaults.
/// Throws std::invalid_argument for an unknown model or parameter (with the nearest valid name) and
/// for a value out of range.
std::shared_ptr<const MotionModel> make_model(std::string_view name,
                                              const ModelParameters& parameters = {});

/// All parameters of a model, such that make_model(model.name(), parameters_of(model)) behaves the
/// same to the bit. Throws std::invalid_argument for a model that make_model does not know.
ModelParameters parameters_of(const MotionModel& model);

}  // namespace prospect
