// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/progress_line.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ext/stdio_filebuf.h>
#include <iostream>
#include <memory>
#include <string_view>
#include <vector>

#include "adapters/formats/files/printable_text.h"
#include "engine/support/named.h"

namespace prospect {
namespace {

constexpr double kPeriod = 0.1;  // [s]
constexpr int kBarCells = 20;
constexpr std::size_t kModeColumns = 11;  // of "look around"

/// A share in [0, 1] as a bar of kBarCells cells, in eighths of a cell.
std::string bar(double share) {
  static constexpr std::string_view kEighths[] = {"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  const double clamped = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 0.0;
  const int eighths = static_cast<int>(std::lround(clamped * kBarCells * 8));
  std::string text;
  for (int i = 0; i < eighths / 8; ++i) text += "█";
  text += kEighths[eighths % 8];
  const int used = eighths / 8 + (eighths % 8 != 0);
  return text + std::string(static_cast<std::size_t>(kBarCells - used), ' ');
}

/// The value by a pattern with one number in it; a dash in the number's place where there is none.
std::string format(const char* pattern, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, pattern, std::isfinite(value) ? value : 0.0);
  std::string text = buffer;
  if (std::isfinite(value)) return text;
  const std::size_t last = text.find_last_of("0123456789");
  const std::size_t first = text.find_first_of("0123456789");
  std::fill(text.begin() + static_cast<std::ptrdiff_t>(first),
            text.begin() + static_cast<std::ptrdiff_t>(last), ' ');
  text[last] = '-';
  return text;
}

/// A part of the line: what it says, how many columns that takes, and its colour.
struct Part {
  std::string text;
  int columns;
  const char* color = "";
};

}  // namespace

ProgressLine::ProgressLine(std::ostream& out, const Terminal& terminal)
    : out_(&out), terminal_(terminal) {}

ProgressLine ProgressLine::on_stderr() {
  const bool tty = isatty(STDERR_FILENO) == 1;
  const char* no_color = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  const bool dumb = terminal && std::string_view(terminal) == "dumb";
  winsize size{};
  int columns = 100;
  if (tty && ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) {
    columns = size.ws_col;
  }
  // A file of its own: standard error may replace the control characters that this line is drawn
  // with. A dumb terminal cannot rewrite a line.
  struct Errors : __gnu_cxx::stdio_filebuf<char>, std::ostream {
    Errors()
        : __gnu_cxx::stdio_filebuf<char>(::dup(STDERR_FILENO), std::ios::out), std::ostream(this) {}
  };
  ProgressLine line(std::cerr, {tty && !dumb, !(no_color && *no_color), columns});
  if (line.terminal_.tty) {
    line.own_ = std::make_shared<Errors>();
    line.out_ = line.own_.get();
  }
  return line;
}

void ProgressLine::show(const StepRecord& step, const std::string& solver, double now_seconds) {
  if (!terminal_.tty) return;
  constexpr const char* kDim = "\033[2m";
  constexpr const char* kWarn = "\033[33m";
  const bool well = step.localization == Localization::kOk;
  const bool tail = step.plan_kind == PlanKind::kStoppingTail;
  const auto plain = [](std::string text, const char* color = "") {
    const int columns = static_cast<int>(text.size());
    return Part{std::move(text), columns, color};
  };
  std::vector<Part> parts;
  parts.push_back(plain(format("%7.1f s ", step.time)));
  parts.push_back(plain(format("%6.1f %%  ", 100.0 * step.coverage)));
  parts.push_back({bar(step.coverage), kBarCells, kDim});
  parts.push_back(plain(format("%8.1f m", step.path_length)));
  parts.push_back(plain(format("   error %.2f m", step.localization_error), well ? "" : kWarn));
  if (!well) parts.push_back(plain(" (" + name_of(step.localization) + ')', kWarn));
  parts.push_back(plain(format("  %4.0f features", step.tracked_features), well ? "" : kWarn));
  if (step.mode) {
    // Padded, so that what follows stays in its place when the mode changes.
    std::string mode = name_of(step.mode);
    mode.resize(std::max(mode.size(), kModeColumns), ' ');
    parts.push_back(plain("   " + mode, step.mode == ModeKind::kRetreat ? kWarn : ""));
    if (step.target && std::isfinite(step.target->path_left)) {
      Part target = plain(format("  → target %.1f m", step.target->path_left));
      target.columns -= 2;  // the arrow: three bytes, one column
      parts.push_back(std::move(target));
    }
  }
  parts.push_back(plain("   " + solver));
  parts.push_back(plain(format(" %4.0f ms", step.wall.plan)));
  if (tail) parts.push_back(plain("  stopping", kWarn));

  // Whole parts only: half a number misleads.
  std::string line;
  int used = 0;
  for (const Part& part : parts) {
    if (used + part.columns > terminal_.columns - 1) break;
    used += part.columns;
    const bool tinted = terminal_.color && *part.color;
    line += tinted ? part.color + part.text + "\033[0m" : part.text;
  }
  put(line, now_seconds);
}

void ProgressLine::show(const std::string& text, double now_seconds) {
  if (!terminal_.tty) return;
  put(printable(text.substr(0, static_cast<std::size_t>(std::max(0, terminal_.columns - 1)))),
      now_seconds);
}

void ProgressLine::put(const std::string& line, double now_seconds) {
  if (shown_ && now_seconds - last_ < kPeriod) {
    held_back_ = line;
    return;
  }
  last_ = now_seconds;
  write(line);
}

void ProgressLine::write(const std::string& line) {
  *out_ << '\r' << line << "\033[K" << std::flush;
  shown_ = true;
  held_back_.clear();
}

void ProgressLine::finish() {
  if (!shown_) return;
  if (!held_back_.empty()) write(held_back_);
  *out_ << '\n' << std::flush;
  shown_ = false;
}

}  // namespace prospect
