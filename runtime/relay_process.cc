// SPDX-License-Identifier: Apache-2.0
#include "runtime/relay_process.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace prospect {
namespace {

/// Nothing of its owner's stays open through it: not a file, not a port.
void close_all_but(std::vector<int> kept) {
  std::sort(kept.begin(), kept.end());
  unsigned from = 3;
  for (const int descriptor : kept) {
    const auto open = static_cast<unsigned>(descriptor);
    if (open > from) ::close_range(from, open - 1, 0);
    from = std::max(from, open + 1);
  }
  ::close_range(from, ~0U, 0);
}

[[noreturn]] void run(std::vector<int> kept, int link,
                      const std::function<void(int)>& work) noexcept {
  for (const int signal : {SIGINT, SIGHUP, SIGTERM, SIGPIPE}) std::signal(signal, SIG_IGN);
  ::setsid();
  kept.push_back(link);
  close_all_but(std::move(kept));
  work(link);
  ::_exit(0);
}

}  // namespace

LinkRead link_bytes::receive(int link, void* message, std::size_t size) noexcept {
  ssize_t came = 0;
  do {
    came = ::recv(link, message, size, MSG_DONTWAIT);
  } while (came < 0 && errno == EINTR);
  if (came == static_cast<ssize_t>(size)) return LinkRead::kMessage;
  const bool waits = came < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
  return waits ? LinkRead::kNothing : LinkRead::kEnded;
}

bool link_bytes::send(int link, const void* message, std::size_t size) noexcept {
  return ::send(link, message, size, MSG_DONTWAIT | MSG_NOSIGNAL) == static_cast<ssize_t>(size);
}

RelayProcess::RelayProcess(const std::string& subject, const std::vector<int>& kept,
                           const std::function<void(int link)>& work) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::runtime_error(subject + ": no link to a relay: " + std::strerror(errno));
  }
  process_ = ::fork();
  if (process_ == 0) run(kept, ends[1], work);
  const int error = errno;
  ::close(ends[1]);
  link_ = ends[0];
  if (process_ < 0) {
    ::close(link_);
    throw std::runtime_error(subject + ": no process for the relay: " + std::strerror(error));
  }
}

RelayProcess::~RelayProcess() {
  using Clock = std::chrono::steady_clock;
  ::close(link_);
  const Clock::time_point end = Clock::now() + std::chrono::seconds(2);
  int gone = 0;
  while ((gone = ::waitpid(process_, nullptr, WNOHANG)) == 0 && Clock::now() < end) ::usleep(2000);
  if (gone == 0) {
    kill();
    ::waitpid(process_, nullptr, 0);
  }
}

void RelayProcess::wait(double seconds) const noexcept {
  pollfd waits{link_, POLLIN, 0};
  ::poll(&waits, 1, static_cast<int>(1e3 * seconds) + 1);
}

void RelayProcess::kill() noexcept { ::kill(process_, SIGKILL); }

}  // namespace prospect
