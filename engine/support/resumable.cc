// SPDX-License-Identifier: Apache-2.0
#include "engine/support/resumable.h"

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace prospect {
namespace {

/// Thrown at a pause by work that is given up, caught by its thread.
struct GivenUp {};

}  // namespace

struct Resumable::Impl {
  enum class Turn { kCaller, kWork, kEnd };

  std::mutex mutex;
  std::condition_variable handed_over;
  Turn turn = Turn::kCaller;

  // Of whoever's turn it is.
  std::function<void(const PausePoint&)> work;  // empty: nothing is begun
  std::function<void()> pause = [this] { pause_if_due(); };
  Clock::time_point until{};
  bool give_up = false;
  std::exception_ptr error;
  std::optional<std::thread> thread;

  void hand_over(Turn to, Turn back) {
    std::unique_lock lock(mutex);
    turn = to;
    handed_over.notify_all();
    handed_over.wait(lock, [&] { return turn == back || turn == Turn::kEnd; });
  }

  void pause_if_due() {
    if (!give_up && Clock::now() < until) return;
    if (!give_up) hand_over(Turn::kCaller, Turn::kWork);
    if (give_up) throw GivenUp{};
  }

  void serve() {
    {
      std::unique_lock lock(mutex);
      handed_over.wait(lock, [&] { return turn != Turn::kCaller; });
    }
    while (turn != Turn::kEnd) {
      try {
        work(PausePoint(&pause));
      } catch (const GivenUp&) {
      } catch (...) {
        error = std::current_exception();
      }
      work = nullptr;
      hand_over(Turn::kCaller, Turn::kWork);
    }
  }
};

Resumable::Resumable() : impl_(std::make_unique<Impl>()) {}

Resumable::~Resumable() {
  give_up();
  if (!impl_->thread) return;
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->turn = Impl::Turn::kEnd;
  }
  impl_->handed_over.notify_all();
  impl_->thread->join();
}

void Resumable::begin(std::function<void(const PausePoint&)> work) {
  Impl& impl = *impl_;
  impl.work = std::move(work);
  impl.give_up = false;
  if (impl.thread) return;
  try {
    impl.thread.emplace([&impl] { impl.serve(); });
  } catch (...) {
    impl.work = nullptr;
    throw;
  }
}

bool Resumable::run_until(Clock::time_point time) {
  Impl& impl = *impl_;
  if (!impl.work) return true;
  impl.until = time;
  impl.hand_over(Impl::Turn::kWork, Impl::Turn::kCaller);
  if (impl.error) std::rethrow_exception(std::exchange(impl.error, nullptr));
  return !impl.work;
}

bool Resumable::busy() const { return static_cast<bool>(impl_->work); }

void Resumable::give_up() {
  Impl& impl = *impl_;
  if (!impl.work) return;
  impl.give_up = true;
  impl.hand_over(Impl::Turn::kWork, Impl::Turn::kCaller);
  impl.error = nullptr;
}

}  // namespace prospect
