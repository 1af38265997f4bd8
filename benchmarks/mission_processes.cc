// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/mission_processes.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <map>
#include <stdexcept>

namespace prospect {

void run_in_processes(std::size_t count, int jobs, const std::function<void(std::size_t)>& work,
                      const std::function<void(std::size_t, const ProcessEnd&)>& ended) {
  constexpr int kThrew = 3;
  std::map<pid_t, std::size_t> running;
  std::size_t next = 0;
  while (next < count || !running.empty()) {
    while (next < count && static_cast<int>(running.size()) < jobs) {
      std::fflush(nullptr);
      const pid_t child = ::fork();
      if (child < 0) throw std::runtime_error("cannot start a process");
      if (child == 0) {
        try {
          work(next);
          ::_exit(0);
        } catch (const std::exception& e) {
          std::cerr << e.what() << std::endl;
          ::_exit(kThrew);
        }
      }
      running.emplace(child, next++);
    }
    int status = 0;
    const auto it = running.find(::wait(&status));
    if (it == running.end()) continue;
    const std::size_t index = it->second;
    running.erase(it);
    ProcessEnd end;
    end.threw = WIFEXITED(status) && WEXITSTATUS(status) != 0;
    if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
    ended(index, end);
  }
}

}  // namespace prospect
