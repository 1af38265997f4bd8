#pragma once

#include <atomic>
#include <thread>
#include <vector>

namespace prospect {

/// Calls work(k) once for each k of 0..count-1, on `threads` threads of which the caller's is one,
/// and returns when all are done. Which thread takes which k is left open, so calls must neither
/// depend on each other nor throw.
template <typename Work>
void parallel_bands(int threads, int count, const Work& work) {
  std::atomic<int> next{0};
  const auto take = [&] {
    for (int k = next.fetch_add(1); k < count; k = next.fetch_add(1)) work(k);
  };
  std::vector<std::jthread> others;
  for (int t = 1; t < threads && t < count; ++t) others.emplace_back(take);
  take();
}

}  // namespace prospect
