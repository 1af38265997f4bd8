#include "adapters/cli/interrupt.h"

#include <csignal>

namespace prospect {
namespace {

volatile std::sig_atomic_t interrupted = 0;
void interrupt(int) { interrupted = 1; }

}  // namespace

std::function<bool()> catch_interrupts() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    // Who started the program so that a signal is ignored (nohup, say) means it.
    if (std::signal(signal, interrupt) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
  return [] { return interrupted != 0; };
}

}  // namespace prospect
