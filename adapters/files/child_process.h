#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace prospect {

/// Another program, run beside this one. It is in a process group of its own, so that Ctrl-C at a
/// terminal reaches this program alone, and it is killed when the thread that started it ends,
/// however that happens. Reads nothing; what it says goes to a file. Movable; killed and waited for
/// when this object goes. Not thread-safe.
class ChildProcess {
 public:
  /// How it ended: by exit(code), or by a signal.
  struct End {
    int code = 0;
    int signal = 0;
  };

  ChildProcess() = default;
  /// words: the path of the program and its arguments. `errors`: file for standard error; standard
  /// output goes nowhere. `kept_open`: a file of this process that it keeps open, too, such as a
  /// lock; -1: none. Throws std::runtime_error if it cannot be started.
  ChildProcess(const std::vector<std::string>& words, const std::string& errors,
               int kept_open = -1);
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;

  /// How it ended; none while it runs. Does not wait.
  std::optional<End> ended();
  /// At once, with all that it has started.
  void kill();

 private:
  pid_t pid_ = -1;
};

/// Path of the program that runs.
std::string own_program();

}  // namespace prospect
