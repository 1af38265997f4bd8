// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/program_options.h"

#include <CLI/CLI.hpp>
#include <cmath>

namespace prospect {
namespace {

template <class Value>
CLI::Option* option(CLI::App& app, const std::string& name, Value& value, const std::string& help,
                    const OptionRules& rules) {
  CLI::Option* made = app.add_option(name, value, help);
  if (rules.required) {
    made->required();
  } else {
    made->capture_default_str();
  }
  if (std::isfinite(rules.least) || std::isfinite(rules.most)) {
    made->check(CLI::Range(rules.least, rules.most));
  }
  if (!rules.one_of.empty()) made->check(CLI::IsMember(rules.one_of));
  if (rules.count > 0) made->expected(rules.count);
  // What stands after the commas would else be taken from the arguments by place.
  if (rules.commas) made->delimiter(',');
  return made;
}

}  // namespace

struct ProgramOptions::Impl {
  CLI::App app;
};

ProgramOptions::ProgramOptions(const std::string& description) : impl_(std::make_unique<Impl>()) {
  impl_->app.description(description);
}
ProgramOptions::~ProgramOptions() = default;

void ProgramOptions::add(const std::string& name, bool& flag, const std::string& help) {
  impl_->app.add_flag(name, flag, help);
}
void ProgramOptions::add(const std::string& name, int& value, const std::string& help,
                         const OptionRules& rules) {
  option(impl_->app, name, value, help, rules);
}
void ProgramOptions::add(const std::string& name, double& value, const std::string& help,
                         const OptionRules& rules) {
  option(impl_->app, name, value, help, rules);
}
void ProgramOptions::add(const std::string& name, std::string& value, const std::string& help,
                         const OptionRules& rules) {
  option(impl_->app, name, value, help, rules);
}
void ProgramOptions::add(const std::string& name, std::vector<std::string>& values,
                         const std::string& help, const OptionRules& rules) {
  option(impl_->app, name, values, help, rules);
}
void ProgramOptions::add(const std::string& name, std::vector<double>& values,
                         const std::string& help, const OptionRules& rules) {
  option(impl_->app, name, values, help, rules);
}

std::optional<int> ProgramOptions::parse(int argc, char** argv) {
  try {
    impl_->app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return impl_->app.exit(e) == 0 ? 0 : 2;
  }
  return {};
}

}  // namespace prospect
