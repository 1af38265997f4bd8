// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/live/access.h"

#include <arpa/inet.h>
#include <sys/random.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <stdexcept>

namespace prospect {
namespace {

constexpr std::size_t kShortest = 16, kLongest = 128;

bool is_plain(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '-' ||
         c == '_';
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return result;
}

/// "name:8080" -> "name", "[::1]:8080" -> "::1"; empty if it is neither.
std::string name_of(std::string_view host) {
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    if (end == std::string_view::npos) return "";
    return std::string(host.substr(1, end - 1));
  }
  const std::size_t colon = host.find(':');
  if (colon != std::string_view::npos && host.find(':', colon + 1) != std::string_view::npos) {
    return "";
  }
  return std::string(host.substr(0, colon));
}

bool is_address(const std::string& name) {
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  return inet_pton(AF_INET, name.c_str(), bytes.data()) == 1 ||
         inet_pton(AF_INET6, name.c_str(), bytes.data()) == 1;
}

}  // namespace

std::string make_token() {
  std::array<unsigned char, 16> random{};
  for (std::size_t have = 0; have < random.size();) {
    const ssize_t got = getrandom(random.data() + have, random.size() - have, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw std::runtime_error("the system gives no random numbers for a token");
    have += static_cast<std::size_t>(got);
  }
  constexpr char kDigits[] = "0123456789abcdef";
  std::string token;
  for (const unsigned char byte : random) {
    token += kDigits[byte >> 4];
    token += kDigits[byte & 15];
  }
  return token;
}

std::string token_fault(std::string_view token) {
  bool plain = token.size() >= kShortest && token.size() <= kLongest;
  for (const char c : token) plain = plain && is_plain(c);
  return plain ? "" : "expected 16 to 128 letters, digits, '-' or '_'";
}

bool same_token(std::string_view a, std::string_view b) {
  // All of `b`, whatever `a` is, which is the one that a stranger chooses the length of.
  unsigned char differ = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const char other = i < a.size() ? a[i] : '\0';
    differ = static_cast<unsigned char>(
        differ | (static_cast<unsigned char>(b[i]) ^ static_cast<unsigned char>(other)));
  }
  return differ == 0;
}

std::string_view query_value(std::string_view target, std::string_view key) {
  std::size_t at = target.find('?');
  while (at != std::string_view::npos) {
    const std::string_view rest = target.substr(at + 1);
    const std::string_view entry = rest.substr(0, rest.find('&'));
    if (entry.size() > key.size() && entry.starts_with(key) && entry[key.size()] == '=') {
      return entry.substr(key.size() + 1);
    }
    at = target.find('&', at + 1);
  }
  return {};
}

bool is_own_host(std::string_view host, std::string_view machine) {
  const std::string name = lower(name_of(host)), own = lower(machine);
  return is_address(name) || name == "localhost" ||
         (!own.empty() && (name == own || name == own + ".local"));
}

bool is_same_origin(std::string_view origin, std::string_view host) {
  return lower(origin) == "http://" + lower(host);
}

}  // namespace prospect
