#include <iostream>
#include <nlohmann/json.hpp>

#include "adapters/cli/build_info.h"
#include "adapters/cli/commands.h"

namespace prospect {

int print_version(bool json) {
  const BuildInfo info = build_info();
  std::cout << (json ? to_json(info).dump(2) + '\n' : to_text(info));
  return kDone;
}

}  // namespace prospect
