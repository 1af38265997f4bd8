// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/run_start.h"

#include <ctime>
#include <nlohmann/json.hpp>

namespace prospect {

std::string start_json(const RunStart& s) {
  const nlohmann::ordered_json json = {{"world", s.world},
                                       {"world_source", s.world_source},
                                       {"world_hash", s.world_hash},
                                       {"solver", s.solver},
                                       {"seed", s.seed},
                                       {"real_time", s.real_time},
                                       {"command_line", s.command_line},
                                       {"version", s.version},
                                       {"commit", s.commit},
                                       {"commit_changed", s.commit_changed},
                                       {"started", s.started}};
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  const std::size_t size = std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return std::string(text, size);
}

}  // namespace prospect
