// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

namespace prospect {

/// What came of looking for a message on a link.
enum class LinkRead { kMessage, kNothing, kEnded };

namespace link_bytes {
LinkRead receive(int link, void* message, std::size_t size) noexcept;
bool send(int link, const void* message, std::size_t size) noexcept;
}  // namespace link_bytes

/// The next message on a link of a RelayProcess, by either side; returns at once. kEnded: who is at
/// the other end has gone, or sends something else. Any thread.
template <class Message>
LinkRead receive_on(int link, Message& message) noexcept {
  static_assert(std::is_trivially_copyable_v<Message>);
  return link_bytes::receive(link, &message, sizeof message);
}
/// False: it was not taken. Returns at once. Any thread.
template <class Message>
bool send_on(int link, const Message& message) noexcept {
  static_assert(std::is_trivially_copyable_v<Message>);
  return link_bytes::send(link, &message, sizeof message);
}

/// A process beside this one that goes on when this one has ended, in whatever way: what a dead-man
/// runs in, of a base that has none of its own. It does not heed Ctrl-C, nor a terminal that
/// closes. A link joins the two, on which messages of one size go whole or not at all.
///
/// It is a copy of the process that starts it (fork), so it is started before threads are.
/// Thread-safety: none; one owner.
class RelayProcess {
 public:
  /// work(link): all that it does; it ends when that returns, and must not throw. Open in it are
  /// the standard files, the link and `kept`. Throws std::runtime_error, `subject` and why, if
  /// there is no process or no link to be had.
  RelayProcess(const std::string& subject, const std::vector<int>& kept,
               const std::function<void(int link)>& work);
  /// Closes the link and waits until it has ended, at most 2 s.
  ~RelayProcess();
  RelayProcess(const RelayProcess&) = delete;
  RelayProcess& operator=(const RelayProcess&) = delete;

  /// Waits until something can be received, at most for that many seconds.
  void wait(double seconds) const noexcept;
  /// At once, whatever it does.
  void kill() noexcept;

  int link() const { return link_; }
  int process() const { return process_; }

 private:
  int process_ = -1;
  int link_ = -1;
};

}  // namespace prospect
