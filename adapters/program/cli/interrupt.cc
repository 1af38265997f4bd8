#include "adapters/program/cli/interrupt.h"

#include <atomic>
#include <csignal>

namespace prospect {
namespace {

volatile std::sig_atomic_t interrupted = 0;
std::atomic<DriveRequests*> asked = nullptr;
static_assert(std::atomic<DriveRequests*>::is_always_lock_free);
void acknowledge(int) {
  if (DriveRequests* const requests = asked) requests->acknowledge();
}
void interrupt(int) { interrupted = 1; }

}  // namespace

std::function<bool()> catch_interrupts() {
  std::signal(SIGINT, interrupt);  // a shell that starts it in the background ignores this one
  std::signal(SIGTERM, interrupt);
  // Who started the program so that it outlives its terminal (nohup) means it.
  if (std::signal(SIGHUP, interrupt) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  return [] { return interrupted != 0; };
}

AcknowledgementBySignal::AcknowledgementBySignal(DriveRequests& requests) {
  asked = &requests;
  std::signal(SIGUSR1, acknowledge);
}

AcknowledgementBySignal::~AcknowledgementBySignal() { asked = nullptr; }

}  // namespace prospect
