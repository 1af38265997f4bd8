// SPDX-License-Identifier: Apache-2.0
#include "serial_port.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace prospect {
namespace {

speed_t speed_of(const std::string& device, int rate) {
  switch (rate) {
    case 19200:
      return B19200;
    case 57600:
      return B57600;
    case 115200:
      return B115200;
    default:
      throw std::invalid_argument(device + ": a rate of " + std::to_string(rate) +
                                  " baud; expected 19200, 57600 or 115200");
  }
}

}  // namespace

SerialPort::SerialPort(const std::string& device, int rate) {
  const speed_t speed = speed_of(device, rate);
  const auto refuse = [&](const std::string& expected) {
    const std::string what = device + ": " + std::strerror(errno) + "; expected " + expected;
    if (descriptor_ >= 0) ::close(descriptor_);
    throw std::invalid_argument(what);
  };
  descriptor_ = ::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor_ < 0) refuse("a serial device that may be read and written");
  termios line{};
  if (::tcgetattr(descriptor_, &line) != 0) refuse("a serial device");
  ::cfmakeraw(&line);
  line.c_cflag |= CLOCAL | CREAD;
  line.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  ::cfsetispeed(&line, speed);
  ::cfsetospeed(&line, speed);
  if (::tcsetattr(descriptor_, TCSANOW, &line) != 0 || ::ioctl(descriptor_, TIOCEXCL) != 0) {
    refuse("a serial device that can be set up");
  }
  ::tcflush(descriptor_, TCIOFLUSH);
}

SerialPort::~SerialPort() { ::close(descriptor_); }

std::vector<std::uint8_t> SerialPort::read() {
  std::vector<std::uint8_t> bytes;
  std::array<std::uint8_t, 1024> part;
  while (!closed_) {
    const ssize_t came = ::read(descriptor_, part.data(), part.size());
    if (came > 0) {
      bytes.insert(bytes.end(), part.begin(), part.begin() + came);
    } else if (came < 0 && errno == EINTR) {
      continue;
    } else {
      // A line without data and one that is gone both read nothing: only the first says "again".
      closed_ = came == 0 || (errno != EAGAIN && errno != EWOULDBLOCK);
      break;
    }
  }
  return bytes;
}

bool SerialPort::write(std::span<const std::uint8_t> bytes) {
  int queued = 0;
  if (closed_ || ::ioctl(descriptor_, TIOCOUTQ, &queued) != 0 || queued > 0) return false;
  // An empty queue takes what is far shorter than it.
  const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
  if (written < 0 && errno != EAGAIN && errno != EINTR) closed_ = true;
  return written == static_cast<ssize_t>(bytes.size());
}

}  // namespace prospect
