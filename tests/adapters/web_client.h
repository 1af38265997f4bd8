// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace prospect::test {

/// A connection to a server of this machine, by system calls alone: HTTP, and the WebSocket
/// protocol (RFC 6455) as a client speaks it, well or badly. Each call waits for two seconds at
/// most.
class WebClient {
 public:
  explicit WebClient(int port) {
    socket_ = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      close();
    }
  }
  ~WebClient() { close(); }
  WebClient(WebClient&& other) noexcept
      : socket_(std::exchange(other.socket_, -1)), in_(std::move(other.in_)) {}
  WebClient(const WebClient&) = delete;
  WebClient& operator=(const WebClient&) = delete;

  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }
  void close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }
  /// All that comes until the other side closes, or nothing more does.
  std::string all() {
    while (receive(kPatience)) {
    }
    return std::exchange(in_, {});
  }
  /// Whether the other side closes within so many milliseconds; what comes meanwhile is read.
  bool is_closed_within(int milliseconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(milliseconds);
    while (std::chrono::steady_clock::now() < end) {
      if (!receive(20) && closed_) return true;
    }
    return false;
  }

  std::string get(std::string_view target, std::string_view host = "127.0.0.1") {
    send("GET " + std::string(target) + " HTTP/1.1\r\nHost: " + std::string(host) + "\r\n\r\n");
    return all();
  }
  /// Asks to speak a protocol, and returns the head of the answer.
  std::string upgrade(std::string_view target, std::string_view protocol,
                      std::string_view host = "127.0.0.1", std::string_view more = "") {
    send("GET " + std::string(target) + " HTTP/1.1\r\nHost: " + std::string(host) +
         "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: " +
         std::string(protocol) + "\r\n" + std::string(more) + "\r\n");
    std::size_t end = std::string::npos;
    while ((end = in_.find("\r\n\r\n")) == std::string::npos && receive(kPatience)) {
    }
    if (end == std::string::npos) return std::exchange(in_, {});
    const std::string head = in_.substr(0, end + 4);
    in_.erase(0, end + 4);
    return head;
  }

  struct Frame {
    int opcode = 0;  ///< 1 text, 2 binary, 8 close, 9 ping, 10 pong
    std::string bytes;
  };
  /// The next message; none: the other side has closed, or says nothing. Pings are answered.
  std::optional<Frame> frame() {
    // Pings alone keep nobody waiting for ever.
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (std::chrono::steady_clock::now() < end) {
      std::size_t size = 0, head = 2;
      if (!have(2)) return std::nullopt;
      const auto byte = [this](std::size_t i) { return static_cast<std::uint8_t>(in_[i]); };
      size = byte(1) & 127U;
      const std::size_t more = size == 126 ? 2 : size == 127 ? 8 : 0;
      if (!have(head + more)) return std::nullopt;
      if (more > 0) size = 0;
      for (std::size_t i = 0; i < more; ++i) size = size << 8 | byte(head + i);
      head += more;
      if (!have(head + size)) return std::nullopt;
      Frame frame{byte(0) & 15, in_.substr(head, size)};
      in_.erase(0, head + size);
      if (frame.opcode != 9) return frame;
      say(frame.bytes, 10);
    }
    return std::nullopt;
  }
  /// Masked, as a client's frames are; `opcode` as above.
  bool say(std::string_view bytes, int opcode = 1) {
    std::string frame(1, static_cast<char>(0x80 | opcode));
    const std::size_t size = bytes.size();
    if (size < 126) {
      frame += static_cast<char>(0x80 | size);
    } else {
      const int wide = size < 65536 ? 2 : 8;
      frame += static_cast<char>(0x80 | (wide == 2 ? 126 : 127));
      for (int i = wide - 1; i >= 0; --i) frame += static_cast<char>(size >> (8 * i));
    }
    constexpr char kMask[] = {0x12, 0x34, 0x56, 0x78};
    frame.append(kMask, 4);
    for (std::size_t i = 0; i < size; ++i) frame += static_cast<char>(bytes[i] ^ kMask[i % 4]);
    return send(frame);
  }

 private:
  static constexpr int kPatience = 2000;  // [ms]

  bool have(std::size_t size) {
    while (in_.size() < size) {
      if (!receive(kPatience)) return false;
    }
    return true;
  }
  bool receive(int milliseconds) {
    if (socket_ < 0) return false;
    pollfd ready{socket_, POLLIN, 0};
    if (::poll(&ready, 1, milliseconds) <= 0) return false;
    char bytes[65536];
    const ssize_t got = ::recv(socket_, bytes, sizeof bytes, 0);
    if (got <= 0) {
      closed_ = true;
      return false;
    }
    in_.append(bytes, static_cast<std::size_t>(got));
    return true;
  }

  int socket_ = -1;
  std::string in_;
  bool closed_ = false;
};

}  // namespace prospect::test
