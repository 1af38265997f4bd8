// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/user/foreign_thread.h"

#include <chrono>
#include <utility>

namespace prospect {

ForeignThread::ForeignThread(std::function<void(const std::stop_token&)> work) {
  std::packaged_task<void()> task(
      [work = std::move(work), stop = stop_.get_token()] { work(stop); });
  over_ = task.get_future();
  thread_ = std::thread(std::move(task));
}

ForeignThread::~ForeignThread() {
  stop_.request_stop();
  if (over_.wait_for(std::chrono::duration<double>(kPatience)) == std::future_status::ready) {
    thread_.join();
  } else {
    thread_.detach();
  }
}

}  // namespace prospect
