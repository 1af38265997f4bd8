// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

namespace prospect {

/// Threads that wait for work. run() shares out calls that do not depend on each other; what they
/// write must not depend on which thread makes which, so that the bits are the same for any number
/// of threads.
///
/// With one thread everything happens in the caller's, and nothing is started. If the system has no
/// more threads, fewer do the work. Thread-safety: one caller at a time. The constructor throws
/// std::invalid_argument for fewer than one thread.
class WorkerThreads {
 public:
  /// threads: the caller's included.
  explicit WorkerThreads(int threads);
  ~WorkerThreads();
  /// That share the work, the caller's included.
  int size() const;
  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;

  /// Calls work(k) once for each k of 0..count-1 and returns when all are done. What `work` throws
  /// is thrown then: of several exceptions that of the smallest k, the same for any number of
  /// threads (calls of a larger k may have been made or not).
  void run(int count, const std::function<void(int)>& work);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
