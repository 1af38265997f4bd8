// SPDX-License-Identifier: Apache-2.0
#include "engine/support/worker_threads.h"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace prospect {

struct WorkerThreads::Impl {
  // The round of work: written by run() alone, under the mutex, while no worker is busy.
  std::mutex mutex;
  std::condition_variable begin, end;
  std::uint64_t round = 0;
  const std::function<void(int)>* work = nullptr;
  int count = 0;
  std::atomic<int> next{0};
  bool open = false;  // the round may still be joined; who wakes up later is not waited for
  int busy = 0;       // workers in the round
  bool leaving = false;
  int threw = 0;  // the smallest that did, with `error`
  std::exception_ptr error;
  std::vector<std::thread> threads;

  void take() {
    for (int k = next.fetch_add(1); k < count; k = next.fetch_add(1)) {
      try {
        (*work)(k);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!error || k < threw) {
          error = std::current_exception();
          threw = k;
        }
      }
    }
  }

  void serve() {
    std::uint64_t seen = 0;
    std::unique_lock lock(mutex);
    while (true) {
      begin.wait(lock, [&] { return leaving || round != seen; });
      if (leaving) return;
      seen = round;
      if (!open) continue;
      ++busy;
      lock.unlock();
      take();
      lock.lock();
      if (--busy == 0) end.notify_one();
    }
  }
};

WorkerThreads::WorkerThreads(int threads) : impl_(std::make_unique<Impl>()) {
  if (threads < 1) {
    throw std::invalid_argument("worker threads: " + std::to_string(threads) +
                                "; expected 1 or more");
  }
  Impl& impl = *impl_;
  impl.threads.reserve(static_cast<std::size_t>(threads - 1));
  try {
    for (int t = 1; t < threads; ++t) impl.threads.emplace_back([&impl] { impl.serve(); });
  } catch (const std::system_error&) {
    // No more are to be had: fewer, then.
  }
}

WorkerThreads::~WorkerThreads() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->leaving = true;
  }
  impl_->begin.notify_all();
  for (std::thread& thread : impl_->threads) thread.join();
}

int WorkerThreads::size() const { return static_cast<int>(impl_->threads.size()) + 1; }

void WorkerThreads::run(int count, const std::function<void(int)>& work) {
  Impl& impl = *impl_;
  if (impl.threads.empty() || count <= 1) {
    for (int k = 0; k < count; ++k) work(k);
    return;
  }
  {
    const std::lock_guard lock(impl.mutex);
    impl.work = &work;
    impl.count = count;
    impl.next = 0;
    impl.open = true;
    ++impl.round;
  }
  impl.begin.notify_all();
  impl.take();
  std::unique_lock lock(impl.mutex);
  impl.open = false;
  impl.end.wait(lock, [&] { return impl.busy == 0; });
  if (impl.error) std::rethrow_exception(std::exchange(impl.error, nullptr));
}

}  // namespace prospect
