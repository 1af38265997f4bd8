#include "adapters/cli/interrupt.h"

#include <csignal>

namespace prospect {
namespace {

volatile std::sig_atomic_t interrupted = 0;
void interrupt(int) { interrupted = 1; }

}  // namespace

std::function<bool()> catch_interrupts() {
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  return [] { return interrupted != 0; };
}

}  // namespace prospect
