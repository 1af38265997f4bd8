// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/progress_line.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <tuple>

namespace prospect::progress_line_test {
namespace {

using testing::HasSubstr;
using testing::Not;

StepRecord step() {
  StepRecord s;
  s.time = 42.5;
  s.coverage = 0.632;
  s.path_length = 31.42;
  s.localization_error = 0.084;
  s.localization = Localization::kOk;
  s.tracked_features = 87;
  s.plan_kind = PlanKind::kOptimised;
  s.wall.plan = 41.4;
  return s;
}

/// Columns that a terminal needs: code points, without escape sequences and carriage returns.
int columns(const std::string& line) {
  int count = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '\033') {
      while (line[i] != 'm' && line[i] != 'K') ++i;
    } else if ((line[i] & 0xC0) != 0x80 && line[i] != '\r') {
      ++count;
    }
  }
  return count;
}

TEST(ProgressLine, SaysWhatIsGoingOn) {
  std::ostringstream out;
  ProgressLine line(out, {true, false});
  line.show(step(), "ipopt", 0.0);
  // 0.632 of 20 cells of 8 eighths: 101 eighths, 12 cells and 5.
  EXPECT_EQ(out.str(),
            "\r   42.5 s   63.2 %  ████████████▋           31.4 m   error 0.08 m    87 features   "
            "ipopt   41 ms\033[K");
  line.finish();
  EXPECT_EQ(out.str().back(), '\n');
}

TEST(ProgressLine, SaysWhatTheRobotDoesAndWhereItGoes) {
  StepRecord s = step();
  s.mode = ModeKind::kExplore;
  s.target.emplace().path_left = 3.21;
  std::ostringstream out;
  ProgressLine(out, {true, false, 200}).show(s, "ipopt", 0.0);
  EXPECT_THAT(out.str(), HasSubstr("  87 features   explore      → target 3.2 m   ipopt   41 ms"));
  // The mode stays where only it fits; half a target would mislead.
  std::ostringstream narrow;
  ProgressLine(narrow, {true, false, 110}).show(s, "ipopt", 0.0);
  EXPECT_THAT(narrow.str(), HasSubstr("explore"));
  EXPECT_THAT(narrow.str(), Not(HasSubstr("target")));
  // Without a way to it there is no distance to show.
  s.target->path_left = std::nan("");
  std::ostringstream unknown;
  ProgressLine(unknown, {true, false, 200}).show(s, "ipopt", 0.0);
  EXPECT_THAT(unknown.str(), Not(HasSubstr("target")));
  EXPECT_THAT(unknown.str(), HasSubstr("ipopt"));
}

TEST(ProgressLine, ShowsADashWhereThereIsNoNumber) {
  StepRecord s = step();
  s.coverage = std::nan("");
  s.localization_error = INFINITY;
  std::ostringstream out;
  ProgressLine(out, {true, false}).show(s, "ipopt", 0.0);
  EXPECT_EQ(out.str(),
            "\r   42.5 s      - %                          31.4 m   error    - m    87 features   "
            "ipopt   41 ms\033[K");
}

TEST(ProgressLine, WarnsOfARetreat) {
  StepRecord s = step();
  s.target.emplace().path_left = 3.21;
  for (const ModeKind mode : {ModeKind::kExplore, ModeKind::kRetreat}) {
    s.mode = mode;
    std::ostringstream out;
    ProgressLine(out, {true, true, 200}).show(s, "ipopt", 0.0);
    EXPECT_EQ(out.str().find("\033[33m   retreat") != std::string::npos,
              mode == ModeKind::kRetreat);
  }
}

TEST(ProgressLine, IsQuietWhereThereIsNoTerminal) {
  std::ostringstream out;
  ProgressLine line(out, {false, true});
  for (int i = 0; i < 100; ++i) line.show(step(), "ipopt", i);
  line.finish();
  EXPECT_EQ(out.str(), "");
}

/// Standard error goes elsewhere for a while.
class StandardError {
 public:
  explicit StandardError(int to) : before_(::dup(STDERR_FILENO)) { ::dup2(to, STDERR_FILENO); }
  ~StandardError() {
    ::dup2(before_, STDERR_FILENO);
    ::close(before_);
  }
  StandardError(const StandardError&) = delete;
  StandardError& operator=(const StandardError&) = delete;

 private:
  int before_;
};

TEST(ProgressLine, IsShownOnStandardErrorWhereThatIsATerminal) {
  ::setenv("TERM", "xterm", 1);
  int terminal[2], pipe[2];
  ASSERT_EQ(::openpty(&terminal[0], &terminal[1], nullptr, nullptr, nullptr), 0);
  ASSERT_EQ(::pipe(pipe), 0);
  for (const auto& [to, from, shown] :
       {std::tuple(terminal[1], terminal[0], true), {pipe[1], pipe[0], false}}) {
    {
      const StandardError elsewhere(to);
      ProgressLine::on_stderr().show("a long way", 0.0);
    }
    ASSERT_EQ(::fcntl(from, F_SETFL, O_NONBLOCK), 0);
    char text[200] = {};
    const auto size = ::read(from, text, sizeof text - 1);
    EXPECT_EQ(std::string(text).find("a long way") != std::string::npos, shown) << size;
    ::close(to);
    ::close(from);
  }
}

TEST(ProgressLine, WritesAtMostTenTimesASecondAndTheLastStepAlways) {
  std::ostringstream out;
  ProgressLine line(out, {true, false});
  StepRecord s = step();
  for (int i = 0; i <= 3000; ++i) {  // 3 s, a step each millisecond
    s.tracked_features = i;
    line.show(s, "ipopt", 1000.0 + 1e-3 * i);
  }
  const std::string before = out.str();
  const auto written = std::count(before.begin(), before.end(), '\r');
  EXPECT_LE(written, 31);
  EXPECT_GE(written, 28);
  s.tracked_features = 4321;
  line.show(s, "ipopt", 1003.0 + 1e-3);
  EXPECT_THAT(out.str(), Not(HasSubstr("4321")));
  line.finish();
  EXPECT_THAT(out.str(), HasSubstr("4321 features"));
  const std::string after = out.str();
  line.finish();
  EXPECT_EQ(out.str(), after);
}

TEST(ProgressLine, ShowsAnyOtherText) {
  std::ostringstream out;
  ProgressLine line(out, {true, true, 20});
  line.show("office@40: step 12 of 40, 8.3 s", 0.0);
  EXPECT_EQ(out.str(), "\roffice@40: step 12 \033[K");
  line.show("step 13", 0.05);
  EXPECT_THAT(out.str(), Not(HasSubstr("step 13")));
  line.finish();
  EXPECT_THAT(out.str(), HasSubstr("\rstep 13\033[K\n"));
  std::ostringstream pipe;
  ProgressLine silent(pipe, {false, true});
  silent.show("step 12", 0.0);
  silent.finish();
  EXPECT_EQ(pipe.str(), "");
  std::ostringstream narrow;
  ProgressLine(narrow, {true, false, 0}).show("step 12", 0.0);
  EXPECT_EQ(narrow.str(), "\r\033[K");
}

TEST(ProgressLine, FinishesNothingThatWasNotBegun) {
  std::ostringstream out;
  ProgressLine(out, {true, true}).finish();
  EXPECT_EQ(out.str(), "");
}

TEST(ProgressLine, ColoursOnlyWhereAsked) {
  StepRecord s = step();
  s.localization = Localization::kDegraded;
  s.plan_kind = PlanKind::kStoppingTail;
  std::ostringstream plain, colored;
  ProgressLine(plain, {true, false, 200}).show(s, "ipopt", 0.0);
  ProgressLine(colored, {true, true, 200}).show(s, "ipopt", 0.0);
  EXPECT_THAT(plain.str(), Not(HasSubstr("\033[3")));
  EXPECT_THAT(plain.str(), HasSubstr("(degraded)"));
  EXPECT_THAT(plain.str(), HasSubstr("stopping"));
  EXPECT_THAT(colored.str(), HasSubstr("\033[33m"));
  EXPECT_EQ(columns(colored.str()), columns(plain.str()));
}

TEST(ProgressLine, NeverWraps) {
  StepRecord s = step();
  s.localization = Localization::kLost;
  s.plan_kind = PlanKind::kStoppingTail;
  s.coverage = 1.0;
  s.mode = ModeKind::kTurnOnTheSpot;
  s.target.emplace().path_left = 12.3;
  for (int width = 1; width < 180; ++width) {
    std::ostringstream out;
    ProgressLine(out, {true, true, width}).show(s, "nlopt:LD_SLSQP", 0.0);
    EXPECT_LT(columns(out.str()), width);
  }
}

TEST(ProgressLine, TakesNumbersThatAreNone) {
  std::ostringstream out;
  ProgressLine line(out, {true, false, 200});
  StepRecord s = step();
  s.mode = ModeKind::kExplore;
  s.target.emplace();
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e308, -1.0, 7.0}) {
    s.coverage = s.localization_error = s.wall.plan = s.path_length = bad;
    s.target->path_left = bad;
    line.show(s, "ipopt", 0.0);
    line.finish();
  }
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 6);
}

}  // namespace
}  // namespace prospect::progress_line_test
