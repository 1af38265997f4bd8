// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/bounded_child.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "adapters/formats/files/input_error.h"

namespace prospect {
namespace {

// Sanitizers reserve terabytes of addresses, so that a limit of them stops everything.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitAddresses = false;
#else
constexpr bool kLimitAddresses = true;
#endif

/// How an answer begins; its length follows, eight bytes, then its bytes.
enum class Answer : char { kResult = 'r', kRefusal = 'i', kFailure = 'f', kMemory = 'm' };
constexpr std::size_t kHead = 1 + sizeof(std::uint64_t);

/// Field of /proc/PID/statm [bytes]: 0 addresses, 1 resident.
std::size_t memory_of(pid_t process, int field) {
  std::ifstream in("/proc/" + std::to_string(process) + "/statm");
  std::size_t pages = 0;
  for (int n = 0; n <= field; ++n) in >> pages;
  return in ? pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) : 0;
}

/// [s] that a process has computed so far.
double processor_time_of(pid_t process) {
  clockid_t clock{};
  timespec time{};
  if (::clock_getcpuclockid(process, &clock) != 0 || ::clock_gettime(clock, &time) != 0) return 0.0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Whether a process sleeps: it neither computes nor waits for a processor, a disk or SIGCONT.
bool sleeps(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string line;
  std::getline(in, line);
  const std::size_t name_end = line.rfind(')');
  return name_end != std::string::npos && line.compare(name_end, 3, ") S") == 0;
}

void limit(int resource, rlim_t value) {
  rlimit now{};
  ::getrlimit(static_cast<__rlimit_resource>(resource), &now);
  const rlim_t at_most = now.rlim_max == RLIM_INFINITY ? value : std::min(value, now.rlim_max);
  const rlimit wanted{at_most, at_most};
  ::setrlimit(static_cast<__rlimit_resource>(resource), &wanted);
}

void write_all(int file, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t n = ::write(file, data, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) ::_exit(1);
    data += n;
    size -= static_cast<std::size_t>(n);
  }
}

void answer(int file, Answer kind, const std::string& text) {
  char head[kHead];
  head[0] = static_cast<char>(kind);
  const std::uint64_t size = text.size();
  std::memcpy(head + 1, &size, sizeof size);
  write_all(file, head, sizeof head);
  write_all(file, text.data(), text.size());
}

[[noreturn]] void child(int file, const std::function<std::string()>& work,
                        const ChildLimits& limits, std::size_t addresses) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal :
       {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGTERM, SIGINT, SIGHUP, SIGPIPE}) {
    std::signal(signal, SIG_DFL);
  }
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int standard : {0, 1, 2}) ::dup2(nowhere, standard);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, static_cast<rlim_t>(limits.seconds) + 1);
  if (kLimitAddresses) limit(RLIMIT_AS, addresses + limits.memory + (limits.memory >> 2));
  try {
    answer(file, Answer::kResult, work());
  } catch (const InputError& error) {
    answer(file, Answer::kRefusal, error.what());
  } catch (const std::bad_alloc&) {
    answer(file, Answer::kMemory, "");
  } catch (const std::exception& error) {
    answer(file, Answer::kFailure, error.what());
  } catch (...) {
    answer(file, Answer::kFailure, "for no reason that is given");
  }
  ::_exit(0);  // nothing of the parent's is tidied up twice
}

std::string decimal(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  if (lines.empty()) lines.emplace_back("refused");
  return lines;
}

}  // namespace

std::string run_in_child(const std::string& subject, const std::function<std::string()>& work,
                         const ChildLimits& limits, const std::function<void(double)>& waiting) {
  using Clock = std::chrono::steady_clock;
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(std::string("no pipe to a child process: ") + std::strerror(errno));
  }
  const std::size_t own = memory_of(::getpid(), 1), addresses = memory_of(::getpid(), 0);
  std::fflush(nullptr);
  const pid_t process = ::fork();
  if (process == 0) {
    ::close(pipe[0]);
    child(pipe[1], work, limits, addresses);
  }
  const int fork_error = errno;
  ::close(pipe[1]);
  if (process < 0) {
    ::close(pipe[0]);
    throw std::runtime_error(std::string("no child process: ") + std::strerror(fork_error));
  }

  const auto begin = Clock::now();
  auto last = begin;
  double slept = 0.0;  // [s]
  std::string text;
  enum { kRead, kLate, kGreedy, kLong } how = kRead;
  std::vector<char> buffer(std::size_t{1} << 16);
  while (how == kRead) {
    constexpr int kLook = 20;  // [ms] between looks at the child's memory
    pollfd wait{pipe[0], POLLIN, 0};
    if (::poll(&wait, 1, kLook) > 0) {
      const ssize_t n = ::read(pipe[0], buffer.data(), buffer.size());
      if (n < 0 && (errno == EINTR || errno == EAGAIN)) continue;
      if (n <= 0) break;
      text.append(buffer.data(), static_cast<std::size_t>(n));
      if (text.size() > limits.result + kHead) how = kLong;
    } else {
      // A gap in these looks is a time in which this process was stopped, too.
      constexpr double kLongest = 0.1;  // [s] that one look may count
      const double passed = std::chrono::duration<double>(Clock::now() - last).count();
      if (sleeps(process)) slept += std::min(passed, kLongest);
      if (memory_of(process, 1) > own + limits.memory) how = kGreedy;
    }
    last = Clock::now();
    if (std::max(slept, processor_time_of(process)) > limits.seconds) how = kLate;
    if (waiting) waiting(std::chrono::duration<double>(last - begin).count());
  }
  if (how != kRead) ::kill(process, SIGKILL);
  ::close(pipe[0]);
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }

  const auto greedy = [&] {
    fail(subject, "reading it takes more than " + std::to_string(limits.memory >> 20) +
                      " MB; expected a sound file");
  };
  const auto late = [&] {
    fail(subject, "reading it takes more than " + decimal(limits.seconds) +
                      " s of processor time; expected a sound file");
  };
  if (how == kGreedy || how == kLong) greedy();
  if (how == kLate || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)) late();
  std::uint64_t size = 0;
  if (text.size() >= kHead) std::memcpy(&size, text.data() + 1, sizeof size);
  if (text.size() < kHead || size != text.size() - kHead) {
    fail(subject, "cannot be read (the reader crashed); expected a sound file");
  }
  const auto kind = static_cast<Answer>(text.front());
  text.erase(0, kHead);
  switch (kind) {
    case Answer::kResult:
      return text;
    case Answer::kRefusal:
      throw InputError(lines_of(text));
    case Answer::kMemory:
      greedy();
      break;
    case Answer::kFailure:
      break;
  }
  std::replace(text.begin(), text.end(), '\n', ' ');
  fail(subject, "cannot be read (" + text + "); expected a sound file");
}

}  // namespace prospect
