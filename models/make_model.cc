#include "models/make_model.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "models/holonomic.h"
#include "models/multirotor.h"
#include "models/nearest_name.h"
#include "models/unicycle.h"
#include "models/unicycle_accel.h"

namespace prospect {
namespace {

template <class Model>
using Fields = std::vector<std::pair<std::string_view, double Model::Parameters::*>>;

/// The members of Model::Parameters by name; one table serves making, defaults and writing back.
template <class Model>
Fields<Model> fields();

template <>
Fields<Unicycle> fields<Unicycle>() {
  using P = Unicycle::Parameters;
  return {{"v_min", &P::v_min}, {"v_max", &P::v_max},         {"omega_max", &P::omega_max},
          {"a_max", &P::a_max}, {"alpha_max", &P::alpha_max}, {"fixed_z", &P::fixed_z}};
}

template <>
Fields<UnicycleAccel> fields<UnicycleAccel>() {
  using P = UnicycleAccel::Parameters;
  return {{"v_min", &P::v_min}, {"v_max", &P::v_max},         {"omega_max", &P::omega_max},
          {"a_max", &P::a_max}, {"alpha_max", &P::alpha_max}, {"fixed_z", &P::fixed_z}};
}

template <>
Fields<Holonomic> fields<Holonomic>() {
  using P = Holonomic::Parameters;
  return {{"vx_min", &P::vx_min},       {"vx_max", &P::vx_max}, {"vy_max", &P::vy_max},
          {"omega_max", &P::omega_max}, {"a_max", &P::a_max},   {"alpha_max", &P::alpha_max},
          {"fixed_z", &P::fixed_z}};
}

template <>
Fields<Multirotor> fields<Multirotor>() {
  using P = Multirotor::Parameters;
  return {{"v_max", &P::v_max},   {"vz_max", &P::vz_max},       {"a_max", &P::a_max},
          {"az_max", &P::az_max}, {"omega_max", &P::omega_max}, {"alpha_max", &P::alpha_max}};
}

[[noreturn]] void refuse(std::string_view what, std::string_view given,
                         const std::vector<std::string>& valid) {
  throw std::invalid_argument("unknown " + std::string(what) + " '" + std::string(given) + "'" +
                              did_you_mean(std::string(given), valid) + expected_one_of(valid));
}

template <class Model>
ModelParameters to_map(const typename Model::Parameters& parameters) {
  ModelParameters map;
  for (const auto& [name, member] : fields<Model>()) {
    map.emplace(std::string(name), parameters.*member);
  }
  return map;
}

template <class Model>
std::shared_ptr<const MotionModel> make(const ModelParameters& given) {
  typename Model::Parameters parameters;
  const Fields<Model> known = fields<Model>();
  for (const auto& [name, value] : given) {
    const auto field = std::find_if(known.begin(), known.end(),
                                    [&name = name](const auto& f) { return f.first == name; });
    if (field == known.end()) {
      std::vector<std::string> names;
      for (const auto& f : known) names.emplace_back(f.first);
      refuse("parameter of model " + std::string(Model::kName), name, names);
    }
    parameters.*(field->second) = value;
  }
  return std::make_shared<const Model>(parameters);
}

/// Calls f with a null pointer to the class of that name.
template <class F>
auto dispatch(std::string_view name, F&& f) {
  if (name == Unicycle::kName) return f(static_cast<Unicycle*>(nullptr));
  if (name == UnicycleAccel::kName) return f(static_cast<UnicycleAccel*>(nullptr));
  if (name == Holonomic::kName) return f(static_cast<Holonomic*>(nullptr));
  if (name == Multirotor::kName) return f(static_cast<Multirotor*>(nullptr));
  refuse("motion model", name, model_names());
}

}  // namespace

std::vector<std::string> model_names() {
  return {std::string(Unicycle::kName), std::string(UnicycleAccel::kName),
          std::string(Holonomic::kName), std::string(Multirotor::kName)};
}

ModelParameters default_parameters(std::string_view name) {
  return dispatch(name,
                  []<class Model>(Model*) { return to_map<Model>(typename Model::Parameters()); });
}

std::shared_ptr<const MotionModel> make_model(std::string_view name,
                                              const ModelParameters& parameters) {
  return dispatch(name, [&]<class Model>(Model*) { return make<Model>(parameters); });
}

ModelParameters parameters_of(const MotionModel& model) {
  return dispatch(model.name(), [&]<class Model>(Model*) {
    const Model* known = dynamic_cast<const Model*>(&model);
    if (!known) {
      throw std::invalid_argument("model '" + std::string(model.name()) +
                                  "' is not the built-in one of that name; its parameters are "
                                  "unknown");
    }
    return to_map<Model>(known->parameters());
  });
}

}  // namespace prospect
