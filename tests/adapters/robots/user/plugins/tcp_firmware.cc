// SPDX-License-Identifier: Apache-2.0
// The firmware of a differential drive behind TCP: takes "V SPEED YAW_RATE", answers each 20 ms
// "O X Y YAW SPEED YAW_RATE"; ramps 1 m/s^2 and 3 rad/s^2; stops 0.3 s after the last command.
//   tcp_firmware [well|mirrored|backwards|garbage|silent|gone]: what it does wrong, but for the
// first from its first 0.3 m on. Prints its port, and when the link has ended how far it drove, and
// how far since its fault.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double ramped(double from, double to, double most) {
  return from + std::clamp(to - from, -most, most);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string fault = argc > 1 ? argv[1] : "well";
  const int door = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (::bind(door, reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      ::listen(door, 1) != 0 ||
      ::getsockname(door, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    return 1;
  }
  std::printf("%d\n", ntohs(address.sin_port));
  std::fflush(stdout);
  const int link = ::accept(door, nullptr, nullptr);

  double x = 0.0, y = 0.0, yaw = 0.0, speed = 0.0, rate = 0.0, way = 0.0, since = 0.0;
  double told_speed = 0.0, told_rate = 0.0, told_at = 0.0;
  std::string text;
  bool there = true;
  for (double before = now(); there;) {
    pollfd waits{link, POLLIN, 0};
    ::poll(&waits, 1, 20);
    char part[4096];
    const ssize_t came = ::recv(link, part, sizeof part, MSG_DONTWAIT);
    there = came != 0;
    if (came > 0) text.append(part, static_cast<std::size_t>(came));
    for (std::size_t end; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1)) {
      if (std::sscanf(text.c_str(), "V %lf %lf", &told_speed, &told_rate) == 2) told_at = now();
    }
    const double time = now(), dt = time - before;
    if (dt < 0.02) continue;
    before = time;
    const bool wrong = fault != "well" && way > 0.3;
    if (time - told_at > 0.3) told_speed = told_rate = 0.0;
    speed = ramped(speed, wrong && fault == "backwards" ? -told_speed : told_speed, 1.0 * dt);
    rate = ramped(rate, wrong && fault == "mirrored" ? -told_rate : told_rate, 3.0 * dt);
    x += speed * std::cos(yaw) * dt;
    y += speed * std::sin(yaw) * dt;
    yaw += rate * dt;
    way += std::abs(speed) * dt;
    if (wrong) since += std::abs(speed) * dt;
    if (wrong && fault == "silent") continue;
    if (wrong && fault == "gone") there = false;
    char line[200];
    int length =
        std::snprintf(line, sizeof line, "O %.5f %.5f %.5f %.5f %.5f\n", x, y, yaw, speed, rate);
    if (wrong && fault == "garbage") {
      length = std::snprintf(line, sizeof line, "O nan %.5f inf -nan nan\n", y);
    }
    ::send(link, line, static_cast<std::size_t>(length), MSG_NOSIGNAL);
  }
  ::close(link);
  std::printf("%.3f %.3f\n", way, since);
}
