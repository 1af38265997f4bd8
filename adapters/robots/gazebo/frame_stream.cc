// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/frame_stream.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include "adapters/formats/files/input_error.h"

namespace prospect {
namespace {

constexpr std::size_t kHeader = 8;
constexpr std::size_t kChunk = std::size_t{1} << 18;  // [bytes] read at once

/// The length that a header tells; none: it tells none.
bool read_length(std::string_view header, std::size_t& length) {
  const std::size_t first = header.find_first_not_of(' ');
  if (first == std::string_view::npos) return false;
  const char* const end = header.data() + header.size();
  const auto [stop, error] = std::from_chars(header.data() + first, end, length, 16);
  return error == std::errc() && stop == end;
}

}  // namespace

FrameStream::FrameStream(int descriptor, std::size_t limit)
    : descriptor_(descriptor), limit_(limit) {
  const int on = 1;
  ::setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  ::fcntl(descriptor_, F_SETFL, ::fcntl(descriptor_, F_GETFL, 0) | O_NONBLOCK);
}

FrameStream FrameStream::connect(const std::string& host, int port, double timeout,
                                 std::size_t limit) {
  const std::string where = host + ":" + std::to_string(port);
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) {
    throw InputError(where + ": no such host; expected the address of Gazebo's master");
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses(found, &::freeaddrinfo);
  const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) throw InputError(where + ": no socket: " + std::strerror(errno));
  FrameStream stream(descriptor, limit);
  int error = 0;
  if (::connect(descriptor, addresses->ai_addr, addresses->ai_addrlen) != 0) {
    error = errno;
    if (error == EINPROGRESS) {
      pollfd waits{descriptor, POLLOUT, 0};
      socklen_t size = sizeof error;
      if (::poll(&waits, 1, static_cast<int>(1e3 * timeout)) <= 0) {
        error = ETIMEDOUT;
      } else {
        ::getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size);
      }
    }
  }
  if (error != 0) {
    throw InputError(where + ": " + std::strerror(error) +
                     "; expected a Gazebo that runs (scripts/gazebo start)");
  }
  return stream;
}

FrameStream::~FrameStream() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

FrameStream::FrameStream(FrameStream&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      limit_(other.limit_),
      in_(std::move(other.in_)),
      out_(std::move(other.out_)),
      closed_(std::move(other.closed_)) {}

FrameStream& FrameStream::operator=(FrameStream&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(limit_, other.limit_);
  in_.swap(other.in_);
  out_.swap(other.out_);
  closed_.swap(other.closed_);
  return *this;
}

void FrameStream::close(const std::string& why) {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  in_.clear();
  out_.clear();
  if (closed_.empty()) closed_ = why;
}

void FrameStream::send(std::string_view frame) {
  if (descriptor_ < 0) return;
  if (out_.size() + kHeader + frame.size() > kMostQueued) {
    close("the other side does not read");
    return;
  }
  std::array<char, kHeader + 1> header{};
  std::snprintf(header.data(), header.size(), "%8zx", frame.size());
  out_.append(header.data(), kHeader).append(frame);
  flush();
}

void FrameStream::flush() {
  while (descriptor_ >= 0 && !out_.empty()) {
    const ssize_t sent = ::send(descriptor_, out_.data(), out_.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
    if (sent < 0) {
      close(std::strerror(errno));
      return;
    }
    out_.erase(0, static_cast<std::size_t>(sent));
  }
}

void FrameStream::receive(const std::function<void(std::string_view)>& take) {
  bool more = descriptor_ >= 0;
  std::string why;
  while (more) {
    const std::size_t before = in_.size();
    in_.resize(before + kChunk);
    const ssize_t came = ::recv(descriptor_, in_.data() + before, kChunk, 0);
    in_.resize(before + (came > 0 ? static_cast<std::size_t>(came) : 0));
    if (came < 0 && errno == EINTR) continue;
    more = came == static_cast<ssize_t>(kChunk);
    if (came == 0) why = "the other side closed it";
    if (came < 0 && errno != EAGAIN && errno != EWOULDBLOCK) why = std::strerror(errno);

    std::size_t used = 0;
    std::size_t length = 0;
    while (in_.size() - used >= kHeader) {
      const std::string_view rest = std::string_view(in_).substr(used);
      if (!read_length(rest.substr(0, kHeader), length)) {
        close("a frame without a length");
        return;
      }
      if (length > limit_) {
        close("a frame of " + std::to_string(length) + " bytes; at most " + std::to_string(limit_));
        return;
      }
      if (rest.size() < kHeader + length) break;
      take(rest.substr(kHeader, length));
      if (descriptor_ < 0) return;
      used += kHeader + length;
    }
    in_.erase(0, used);
  }
  if (why.empty()) return;
  close(in_.empty() ? why : why + " within a frame");
}

}  // namespace prospect
