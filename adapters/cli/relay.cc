#include <iostream>
#include <string>

#include "adapters/cli/commands.h"
#include "adapters/cli/interrupt.h"
#include "adapters/dds/dds_relay.h"

namespace prospect {

int relay(const std::string& ros) {
  DdsRelay relay(read_dds_options(ros));
  relay.run(catch_interrupts(),
            [](const std::string& line) { std::cerr << "prospect relay: " << line << '\n'; });
  return kDone;
}

}  // namespace prospect
