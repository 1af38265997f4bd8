// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/child_process.h"

#include <fcntl.h>
#include <sys/auxv.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace prospect {

ChildProcess::ChildProcess(const std::vector<std::string>& words, const Options& options) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t parent = ::getpid();
  std::fflush(nullptr);
  pid_ = ::fork();
  if (pid_ < 0) {
    throw std::runtime_error(words.front() + ": cannot be started (" + std::strerror(errno) + ")");
  }
  if (pid_ > 0) {
    ::setpgid(pid_, pid_);  // here, too: kill() may come before it does so itself
    return;
  }
  // Only what is safe between fork and exec.
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);  // it ended before that was said
  const int in = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  const int err = options.errors.empty() ? ::fcntl(2, F_DUPFD_CLOEXEC, 3)
                                         : ::open(options.errors.c_str(),
                                                  O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (in < 0 || ::dup2(in, 0) < 0 || ::dup2(options.output < 0 ? in : options.output, 1) < 0 ||
      ::dup2(err < 0 ? in : err, 2) < 0) {
    ::_exit(127);
  }
  if (options.kept_open >= 0) ::fcntl(options.kept_open, F_SETFD, 0);
  if (options.memory > 0) {
    const rlimit limit{options.memory, options.memory};
    ::setrlimit(RLIMIT_AS, &limit);
  }
  ::execv(arguments[0], arguments.data());
  ::_exit(127);
}

ChildProcess::~ChildProcess() { kill(); }

ChildProcess::ChildProcess(ChildProcess&& other) noexcept : pid_(std::exchange(other.pid_, -1)) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  std::swap(pid_, other.pid_);
  return *this;
}

std::optional<ChildProcess::End> ChildProcess::ended() { return collect(WNOHANG); }

ChildProcess::End ChildProcess::wait() {
  std::optional<End> end;
  while (pid_ >= 0 && !end) end = collect(0);
  return end.value_or(End{127, 0});
}

std::optional<ChildProcess::End> ChildProcess::collect(int wait_options) {
  if (pid_ < 0) return std::nullopt;
  int status = 0;
  const pid_t waited = ::waitpid(pid_, &status, wait_options);
  if (waited == 0 || (waited < 0 && errno == EINTR)) return std::nullopt;
  pid_ = -1;
  End end;
  if (waited < 0) {
    end.code = 127;
  } else if (WIFSIGNALED(status)) {
    end.signal = WTERMSIG(status);
  } else {
    end.code = WEXITSTATUS(status);
  }
  return end;
}

void ChildProcess::kill() {
  if (pid_ < 0) return;
  ::kill(-pid_, SIGKILL);
  ::kill(pid_, SIGKILL);
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
}

std::string own_program() {
  std::error_code error;
  const std::filesystem::path told = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) return told.string();
  // A machine in a folder may lack /proc: as the kernel was asked for it.
  // NOLINTNEXTLINE(performance-no-int-to-ptr): that is how the kernel tells it
  const auto* asked = reinterpret_cast<const char*>(::getauxval(AT_EXECFN));
  const std::filesystem::path program = asked != nullptr ? asked : "";
  const std::filesystem::path whole = std::filesystem::absolute(program, error);
  return error ? program.string() : whole.string();
}

}  // namespace prospect
