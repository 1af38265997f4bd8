#include "adapters/cli/interrupt.h"

#include <csignal>

namespace prospect {
namespace {

volatile std::sig_atomic_t interrupted = 0, acknowledged = 0;
void acknowledge(int) { acknowledged = 1; }
void interrupt(int) { interrupted = 1; }

}  // namespace

std::function<bool()> catch_interrupts() {
  std::signal(SIGINT, interrupt);  // a shell that starts it in the background ignores this one
  std::signal(SIGTERM, interrupt);
  // Who started the program so that it outlives its terminal (nohup) means it.
  if (std::signal(SIGHUP, interrupt) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  return [] { return interrupted != 0; };
}

std::function<bool()> catch_acknowledgements() {
  std::signal(SIGUSR1, acknowledge);
  return [] {
    if (acknowledged == 0) return false;
    acknowledged = 0;
    return true;
  };
}

}  // namespace prospect
