// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace prospect {

/// Another program, run beside this one. It is in a process group of its own, so that Ctrl-C at a
/// terminal reaches this program alone, and it is killed when the thread that started it ends,
/// however that happens. Reads nothing. Movable; killed and waited for when this object goes. Not
/// thread-safe.
class ChildProcess {
 public:
  /// How it ended: by exit(code), or by a signal.
  struct End {
    int code = 0;
    int signal = 0;
  };

  /// Files of this process are descriptors; -1: none.
  struct Options {
    std::string errors = "/dev/null";  ///< path of the file for standard error; empty: this one's
    int output = -1;                   ///< open file for standard output; -1: it goes nowhere
    int kept_open = -1;                ///< a file that it keeps open, too, such as a lock
    std::size_t memory = 0;            ///< [bytes] of addresses at most; 0: as many as this process
  };

  ChildProcess() = default;
  /// words: the path of the program and its arguments. Throws std::runtime_error if it cannot be
  /// started.
  ChildProcess(const std::vector<std::string>& words, const Options& options);
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;

  /// How it ended; none while it runs. Does not wait.
  std::optional<End> ended();
  /// Waits until it has ended, and says how. It must run, or have ended without having said so.
  End wait();
  /// At once, with all that it has started.
  void kill();

 private:
  std::optional<End> collect(int wait_options);

  pid_t pid_ = -1;
};

/// Path of the program that runs.
std::string own_program();

}  // namespace prospect
