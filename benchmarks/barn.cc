// SPDX-License-Identifier: Apache-2.0
// barn [--config FILE] [--real-time] WORLD...: BARN's task (barn_case.h) in each of its Gazebo
// worlds, world_N.world with path_N.npy beside it; a row of CSV each, and their mean:
//   end, contacts, time [s] (nan: not reached), reference [m], driven [m], metric, longest step [s]

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/barn_case.h"
#include "benchmarks/program_options.h"

namespace prospect {
namespace {

std::string path_of(const std::string& world) {
  const std::filesystem::path file(world);
  std::string number = file.stem().string();
  number = number.substr(number.rfind('_') + 1);
  return (file.parent_path() / ("path_" + number + ".npy")).string();
}

int measure(const std::vector<std::string>& worlds, const std::string& file, bool real_time) {
  const Configuration configuration = read_configuration(file);
  std::printf("world,end,contacts,time_s,reference_m,driven_m,metric,longest_step_s\n");
  int reached = 0, contacts = 0;
  double sum = 0.0;
  for (const std::string& world : worlds) {
    const BarnOutcome o = drive_barn(world, path_of(world), configuration, real_time);
    std::printf("%s,%s,%d,%.2f,%.2f,%.2f,%.3f,%.2f\n",
                std::filesystem::path(world).stem().string().c_str(),
                std::string(to_string(o.end)).c_str(), o.contacts, o.time.value_or(std::nan("")),
                o.length, o.driven, o.metric, o.longest_step);
    std::fflush(stdout);
    reached += o.time.has_value();
    contacts += o.contacts;
    sum += o.metric;
  }
  std::printf("reached %d of %zu, contacts %d, metric %.3f\n", reached, worlds.size(), contacts,
              sum / static_cast<double>(worlds.size()));
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  prospect::ProgramOptions options("BARN's task in its worlds");
  std::string file = "benchmarks/barn.yaml";
  bool real_time = false;
  std::vector<std::string> worlds;
  options.add("--config", file, "robot and task");
  options.add("--real-time", real_time, "by threads, as `prospect drive`, instead of in lockstep");
  options.add("worlds", worlds, "world_N.world of BARN, with path_N.npy beside",
              {.required = true});
  if (const std::optional<int> end = options.parse(argc, argv)) return *end;
  try {
    return prospect::measure(worlds, file, real_time);
  } catch (const std::exception& e) {
    std::cerr << "barn: " << e.what() << '\n';
    return 2;
  }
}
