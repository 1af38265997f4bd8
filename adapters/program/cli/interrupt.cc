// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/interrupt.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <string_view>

#include "adapters/formats/files/exit_code.h"
#include "adapters/formats/files/temporary_file.h"

namespace prospect {
namespace {

constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};
// What handlers of signals may touch.
std::array<struct sigaction, kSignals.size()> before;
std::atomic<bool> only_noted = false, noted = false, on_terminal = false;
std::atomic<DriveRequests*> asked = nullptr;
static_assert(std::atomic<bool>::is_always_lock_free);
static_assert(std::atomic<DriveRequests*>::is_always_lock_free);

void acknowledge(int) {
  if (DriveRequests* const requests = asked) requests->acknowledge();
}

void interrupt(int) {
  if (only_noted) {
    noted = true;
    return;
  }
  remove_temporary_files();
  // A line of progress that is there is replaced.
  constexpr std::string_view kText = "\r\033[Kprospect: cancelled\n";
  const std::string_view text = on_terminal ? kText : kText.substr(4);
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
  ::_exit(kCancelled);
}

}  // namespace

SignalGuard::SignalGuard() {
  only_noted = noted = false;
  const char* const terminal = std::getenv("TERM");
  on_terminal = ::isatty(STDERR_FILENO) == 1 && terminal && std::string_view(terminal) != "dumb";
  struct sigaction now {};
  now.sa_handler = interrupt;
  now.sa_flags = SA_RESTART;
  ::sigemptyset(&now.sa_mask);
  for (std::size_t n = 0; n < kSignals.size(); ++n) {
    ::sigaction(kSignals[n], nullptr, &before[n]);
    // A shell that starts a program in the background lets it ignore SIGINT; who started it so that
    // it outlives its terminal (nohup) means it.
    if (kSignals[n] == SIGHUP && before[n].sa_handler == SIG_IGN) continue;
    ::sigaction(kSignals[n], &now, nullptr);
  }
}

SignalGuard::~SignalGuard() {
  for (std::size_t n = 0; n < kSignals.size(); ++n) ::sigaction(kSignals[n], &before[n], nullptr);
}

void SignalGuard::note() { only_noted = true; }

std::function<bool()> SignalGuard::came() const {
  return [] { return noted.load(); };
}

AcknowledgementBySignal::AcknowledgementBySignal(DriveRequests& requests) {
  asked = &requests;
  std::signal(SIGUSR1, acknowledge);
}

AcknowledgementBySignal::~AcknowledgementBySignal() { asked = nullptr; }

}  // namespace prospect
