// SPDX-License-Identifier: Apache-2.0
// Each fault of the simulated robot, or each pair, one drive each, as a table (Markdown).
//   fault_matrix [WORLD] [--fault SOURCE:VERB[,SOURCE:VERB]...] [--from S] [--for S] [--length S]
//   [--seed N] [--by cameras|wheels|pose] [--jobs N] [--events]
// Without --fault: all of them. Drives are of threads on a simulated clock (fault_case.h). "Drives
// again" counts from the end of the fault. Exit code 1: a contact.
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "benchmarks/fault_case.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/program_options.h"

namespace prospect {
namespace {

std::string number(const std::optional<double>& value) {
  if (!value) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", *value);
  return text;
}

void print_row(const FaultCase& one, const FaultOutcome& o) {
  std::string name;
  for (const InjectedFault& fault : one.faults) {
    if (!name.empty()) name += ',';
    name += name_of(fault);
  }
  std::printf("| `%s` | %.2f | %s | %s | %s | %s | %s | %s | %s | %d |\n", name.c_str(), o.speed,
              o.stop_time ? o.cause.c_str() : "drives on", number(o.stop_time).c_str(),
              number(o.stop_distance).c_str(), number(o.named_time).c_str(),
              number(o.named_distance).c_str(), number(o.recovery).c_str(),
              o.acknowledged ? "acknowledged" : (o.drives_at_end ? "by itself" : "stands"),
              o.contacts);
}

/// Of several threads, each takes the next one.
std::vector<FaultOutcome> drive_all(const std::shared_ptr<const World>& world,
                                    const Configuration& configuration,
                                    const std::vector<FaultCase>& cases, int jobs) {
  std::vector<FaultOutcome> outcomes(cases.size());
  std::atomic<std::size_t> next{0};
  std::vector<std::jthread> threads;
  for (int k = 0; k < jobs; ++k) {
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < cases.size(); i = next++) {
        outcomes[i] = drive_with_fault(world, configuration, cases[i]);
      }
    });
  }
  threads.clear();
  return outcomes;
}

int fault_matrix(int argc, char** argv) {
  std::string world_name = "corridor";
  std::vector<std::string> faults;
  bool events = false;
  int jobs = 2, seed = 1;
  double from = 5.0, duration = 3.0, length = 13.0;
  std::string by_name = "cameras";
  ProgramOptions program("Faults of the simulated robot, one drive each, as a table");
  program.add("world", world_name, "Built-in name or file");
  program.add("--fault", faults, "SOURCE:VERB, several at once by commas; without it each alone");
  program.add("--from", from, "When a fault begins [s]", {.least = 0.0});
  program.add("--for", duration, "How long it holds [s]", {.least = 0.05});
  program.add("--length", length, "Of a drive [s]", {.least = 1.0});
  program.add("--seed", seed, "Of the simulator", {.least = 0});
  program.add("--by", by_name, "What tells the robot where it is: cameras, wheels or pose");
  program.add("--jobs", jobs, "Drives at a time", {.least = 1});
  program.add("--events", events, "Print what the robot said");
  if (const std::optional<int> code = program.parse(argc, argv)) return *code;
  const LocalizedBy by = localized_by(by_name);
  std::vector<FaultCase> cases;
  const auto add = [&](std::vector<InjectedFault> together) {
    for (InjectedFault& fault : together) {
      fault.from = from;
      fault.duration = duration;
    }
    cases.push_back({std::move(together), length});
    cases.back().seed = static_cast<std::uint64_t>(seed);
    cases.back().by = by;
  };
  for (const std::string& text : faults) {
    try {
      std::vector<InjectedFault> together;
      std::istringstream names(text);
      for (std::string name; std::getline(names, name, ',');) together.push_back(parse_fault(name));
      if (together.empty()) throw std::invalid_argument("'': no fault; expected SOURCE:VERB");
      add(std::move(together));
    } catch (const std::invalid_argument& e) {
      throw InputError(std::string("--fault: ") + e.what());
    }
  }
  for (const FaultKind& kind : fault_kinds()) {
    if (faults.empty() && kind.implemented) add({{kind.source, kind.verb}});
  }
  const Configuration configuration = fault_drive_configuration(world_name, by);
  const auto world =
      std::make_shared<const World>(load_world(world_name, world_options_for(configuration)));
  const std::vector<FaultOutcome> outcomes = drive_all(world, configuration, cases, jobs);
  std::printf(
      "| fault | speed [m/s] | stopped by | after [s] | after [m] | named [s] | "
      "named [m] | drives again [s] | how | contacts "
      "|\n|---|---|---|---|---|---|---|---|---|---|\n");
  int contacts = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    print_row(cases[i], outcomes[i]);
    contacts += outcomes[i].contacts;
    for (const std::string& event : outcomes[i].events) {
      if (events) std::printf("    %s\n", event.c_str());
    }
  }
  return contacts > 0 ? 1 : 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("fault_matrix", prospect::fault_matrix, argc, argv);
}
