// SPDX-License-Identifier: Apache-2.0
#include "models/make_model.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "models/holonomic.h"
#include "models/knobs.h"
#include "models/multirotor.h"
#include "models/nearest_name.h"
#include "models/unicycle.h"
#include "models/unicycle_accel.h"

namespace prospect {
namespace {

[[noreturn]] void refuse(std::string_view what, std::string_view given,
                         const std::vector<std::string>& valid) {
  throw std::invalid_argument("unknown " + std::string(what) + " '" + std::string(given) + "'" +
                              did_you_mean(std::string(given), valid) + expected_one_of(valid));
}

/// Refers to each number that is described, by its name.
class Members final : public Knobs {
 public:
  void number(const char* name, double& value, Range, const char*, const char*) override {
    values.emplace_back(name, &value);
  }
  // Parameters of a model are plain numbers.
  void degrees(const char*, double&, Range, const char*) override {}
  void integer(const char*, int&, WholeRange, const char*, const char*) override {}
  void boolean(const char*, bool&, const char*) override {}
  void numbers(const char*, double*, std::size_t, Range, const char*, const char*) override {}
  void require(bool, const char*, const char*) override {}

  std::vector<std::pair<std::string, double*>> values;

 private:
  void word(const char*, std::size_t&, const std::vector<std::string>&, const char*) override {}
  void enter(const char*) override {}
  void leave() override {}
};

template <class Model>
ModelParameters to_map(typename Model::Parameters parameters) {
  Members members;
  describe(members, parameters);
  ModelParameters map;
  for (const auto& [name, value] : members.values) map.emplace(name, *value);
  return map;
}

template <class Model>
typename Model::Parameters from_map(const ModelParameters& given) {
  typename Model::Parameters parameters;
  Members members;
  describe(members, parameters);
  for (const auto& [name, value] : given) {
    const auto member = std::find_if(members.values.begin(), members.values.end(),
                                     [&name = name](const auto& m) { return m.first == name; });
    if (member == members.values.end()) {
      std::vector<std::string> names;
      for (const auto& m : members.values) names.push_back(m.first);
      refuse("parameter of model " + std::string(Model::kName), name, names);
    }
    *member->second = value;
  }
  return parameters;
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

void describe(Knobs& knobs, std::string_view model, ModelParameters& parameters) {
  dispatch(model, [&]<class Model>(Model*) {
    typename Model::Parameters values = from_map<Model>(parameters);
    describe(knobs, values);
    parameters = to_map<Model>(values);
  });
}

std::shared_ptr<const MotionModel> make_model(std::string_view name,
                                              const ModelParameters& parameters) {
  return dispatch(name, [&]<class Model>(Model*) {
    return std::shared_ptr<const MotionModel>(
        std::make_shared<const Model>(from_map<Model>(parameters)));
  });
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
