// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/environment.h"

#include <sched.h>
#include <stdlib.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "adapters/missions/run/run_start.h"
#include "adapters/program/cli/build_info.h"

namespace prospect {
namespace {

using Json = nlohmann::ordered_json;

Json cores() {
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) != 0) return nullptr;
  return CPU_COUNT(&set);
}

Json memory_mb() {
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGE_SIZE);
  if (pages <= 0 || size <= 0) return nullptr;
  return static_cast<long>(static_cast<double>(pages) * static_cast<double>(size) / 1e6);
}

/// PRETTY_NAME="Debian GNU/Linux 12 (bookworm)".
Json operating_system() {
  std::ifstream file("/etc/os-release");
  const std::string key = "PRETTY_NAME=";
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key)) continue;
    std::string name = line.substr(key.size());
    if (name.size() >= 2 && name.front() == '"' && name.back() == '"') {
      name = name.substr(1, name.size() - 2);
    }
    return name;
  }
  return nullptr;
}

Json kernel() {
  utsname names;
  if (uname(&names) != 0) return nullptr;
  return std::string(names.sysname) + " " + names.release + " " + names.machine;
}

Json load() {
  double means[3];
  if (getloadavg(means, 3) != 3) return nullptr;
  return {means[0], means[1], means[2]};
}

}  // namespace

Json environment() {
  Json threads = Json::object();
  for (const char* name : {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"}) {
    const char* value = getenv(name);
    threads[name] = value == nullptr ? Json(nullptr) : Json(value);
  }
  const std::string processor = processor_name();
  return {{"build", to_json(build_info())},
          {"processor", processor.empty() ? Json(nullptr) : Json(processor)},
          {"cores", cores()},
          {"memory_mb", memory_mb()},
          {"system", operating_system()},
          {"kernel", kernel()},
          {"threads", threads},
          {"started", utc_now()},
          {"load", load()}};
}

}  // namespace prospect
