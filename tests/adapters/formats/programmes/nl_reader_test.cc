// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/programmes/nl_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/programmes/nl_writer.h"
#include "problems/path_problem.h"
#include "problems/r1.h"
#include "problems/zoo.h"

namespace prospect::nl_reader_test {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;
constexpr double kNone = std::numeric_limits<double>::infinity();

/// HS71 as the definition of the format has it: min x0 x3 (x0 + x1 + x2) + x2,
/// x0 x1 x2 x3 >= 25, x0^2 + x1^2 + x2^2 + x3^2 = 40, 1 <= x <= 5.
std::string hs71() {
  return R"(g3 1 1 0	# problem hs71
 4 2 1 0 1 	# vars, constraints, objectives, ranges, eqns
 2 1 0 0 0 0	# nonlinear constrs, objs; ccons: lin, nonlin, nd, nzlb
 0 0	# network constraints: nonlinear, linear
 4 4 4	# nonlinear vars in constraints, objectives, both
 0 0 0 1	# linear network variables; functions; arith, flags
 0 0 0 0 0 	# discrete variables: binary, integer, nonlinear (b,c,o)
 8 4 	# nonzeros in Jacobian, obj. gradient
 0 0	# max name lengths: constraints, variables
 0 0 0 0 0	# common exprs: b,c,o,c1,o1
C0	#product
o2	#*
o2
o2
v0	#x[1]
v1
v2
v3
C1
o54	#sumlist
4
o5	#^
v0
n2
o77
v1
o5
v2
n2
o2
v3
v3
O0 0	#cost
o2
o2
v0
v3
o54
3
v0
v1
v2
d2	# dual guess
0 0.5
1 -0.16
x4	# initial guess
0 1
1 5
2 5
3 1
r	#2 ranges (rhs's)
2 25
4 40
b	#4 bounds (on variables)
0 1 5
0 1 5
0 1.0e0 5
0 1 +5
k3	#intermediate Jacobian column lengths
2
4
6
J0 4
0 0
1 0
2 0
3 0
J1 4
0 0
1 0
2 0
3 0
G0 4
0 0
1 0
2 1
3 0
)";
}

class NlReader : public ::testing::Test {
 protected:
  ~NlReader() override { std::filesystem::remove(path_); }
  StatedProgramme read(const std::string& text) const {
    std::ofstream(path_) << text;
    return read_nl(path_);
  }
  /// HS71 with one piece replaced.
  static std::string altered(const std::string& what, const std::string& with) {
    std::string text = hs71();
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), with);
  }
  std::string refusal(const std::string& text) const {
    try {
      read(text);
    } catch (const InputError& e) {
      EXPECT_EQ(e.lines().size(), 1U);
      EXPECT_THAT(e.what(), HasSubstr("; expected "));
      EXPECT_THAT(e.what(), StartsWith(path_ + ":"));
      return std::string(e.what()).substr(path_.size() + 1);
    }
    return "accepted";
  }
  const std::string path_ = ::testing::TempDir() + "nl_reader_" + std::to_string(getpid()) + ".nl";
};

TEST_F(NlReader, ReadsAWholeFile) {
  const StatedProgramme p = read(hs71());
  EXPECT_THAT(p.name, StartsWith("nl_reader_"));
  EXPECT_EQ(p.start, Eigen::Vector4d(1, 5, 5, 1));
  EXPECT_EQ(p.lower, Eigen::Vector4d::Constant(1.0));
  EXPECT_EQ(p.upper, Eigen::Vector4d::Constant(5.0));
  ASSERT_EQ(p.rows.size(), 2U);
  EXPECT_EQ(p.rows[0].lower, 25.0);
  EXPECT_EQ(p.rows[0].upper, kNone);
  EXPECT_EQ(p.rows[1].lower, 40.0);
  EXPECT_EQ(p.rows[1].upper, 40.0);
  const Eigen::Vector4d x(1.0, 4.7429996, 3.8211499, 1.3794083);
  EXPECT_NEAR(p.objective.value(x), 17.0140173, 1e-6);
  EXPECT_NEAR(p.rows[0].body.value(x), 25.0, 1e-5);
  EXPECT_NEAR(p.rows[1].body.value(x), 40.0, 1e-5);
  const Eigen::Vector4d gradient(x[3] * (2 * x[0] + x[1] + x[2]), x[0] * x[3], x[0] * x[3] + 1,
                                 x[0] * (x[0] + x[1] + x[2]));
  EXPECT_LE((p.objective.gradient(x) - gradient).norm(), 1e-14);
  EXPECT_FALSE(p.optimum);
}

TEST_F(NlReader, ReadsWindowsLinesAndNoComments) {
  std::string plain;
  bool comment = false;
  for (const char c : hs71()) {
    comment = c != '\n' && (comment || c == '#');
    if (comment) continue;
    plain += c == '\n' ? std::string("\r\n") : std::string(1, c);
  }
  EXPECT_EQ(read(plain).rows.size(), 2U);
}

/// max v2 + sqrt(x0), v2 = 2 x0 + x1 x1 - 1, v3 = |v2|, in a range, free, of linear parts alone.
TEST_F(NlReader, ReadsDefinedVariablesRangesAndLinearParts) {
  const StatedProgramme p = read(R"(g3 1 1 0
 2 3 1 1 0
 1 1
 0 0
 2 2 2
 0 0 0 1
 0 0 0 0 0
 5 2
 0 0
 1 1 0 0 0
V2 1 0
0 2
o1
o2
v1
v1
n1
V3 0 1
o15
v2
C0
v3
C1
n0
C2
n3
O0 1
o0
v2
o39
v0
S0 2 sstatus
0 1
1 2
r
0 -1 4
3
1 7
b
3
4 2.5
k1
2
J0 2
0 0
1 0
J1 2
0 1
1 -2
J2 1
1 1.5
G0 2
0 0
1 10
)");
  const Eigen::Vector2d x(4.0, 3.0);
  EXPECT_EQ(p.objective.value(x), -(16.0 + 2.0 + 30.0));
  EXPECT_EQ(p.objective.gradient(x), Eigen::Vector2d(-2.25, -16.0));
  EXPECT_EQ(p.start, Eigen::Vector2d::Zero());
  EXPECT_EQ(p.lower, Eigen::Vector2d(-kNone, 2.5));
  EXPECT_EQ(p.upper, Eigen::Vector2d(kNone, 2.5));
  ASSERT_EQ(p.rows.size(), 3U);
  EXPECT_EQ(p.rows[0].body.value(x), 16.0);
  EXPECT_EQ(p.rows[0].lower, -1.0);
  EXPECT_EQ(p.rows[0].upper, 4.0);
  EXPECT_EQ(p.rows[1].body.value(x), -2.0);
  EXPECT_EQ(p.rows[1].lower, -kNone);
  EXPECT_EQ(p.rows[1].upper, kNone);
  EXPECT_EQ(p.rows[2].body.value(x), 7.5);
  EXPECT_EQ(p.rows[2].upper, 7.0);
}

TEST_F(NlReader, ReadsEveryOperationThatIsAFunction) {
  const double a = 0.3, b = 0.6;
  const auto value = [&](const std::string& expression) {
    std::string text =
        altered("O0 0	#cost\no2\no2\nv0\nv3\no54\n3\nv0\nv1\nv2\n", "O0 0\n" + expression);
    text.replace(text.find("2 1\n3 0\n"), 4, "2 0\n");
    return read(text).objective.value(Eigen::Vector4d(a, b, 0.0, 0.0));
  };
  EXPECT_EQ(value("o6\nv1\nv0\n"), b - a);
  EXPECT_EQ(value("o6\nv0\nv1\n"), 0.0);
  EXPECT_EQ(value("o11\n3\nv1\nv0\nn9\n"), a);
  EXPECT_EQ(value("o12\n3\nv1\nv0\ns-9\n"), b);
  EXPECT_EQ(value("o16\nv1\n"), -b);
  EXPECT_EQ(value("o35\no22\nv0\nv1\nl5\nn6\n"), 5.0);
  EXPECT_EQ(value("o35\no23\nv1\nv0\nn5\nn6\n"), 6.0);
  EXPECT_EQ(value("o35\no24\nv1\nv1\nn5\nn6\n"), 5.0);
  EXPECT_EQ(value("o35\no28\nv1\nv0\nn5\nn6\n"), 5.0);
  EXPECT_EQ(value("o35\no29\nv0\nv0\nn5\nn6\n"), 6.0);
  EXPECT_EQ(value("o35\no30\nv0\nv0\nn5\nn6\n"), 6.0);
  EXPECT_EQ(value("o35\no20\no22\nv1\nv0\no22\nv0\nv1\nn5\nn6\n"), 5.0);
  EXPECT_EQ(value("o35\no21\no22\nv1\nv0\no22\nv0\nv1\nn5\nn6\n"), 6.0);
  EXPECT_EQ(value("o35\no34\no22\nv1\nv0\nn5\nn6\n"), 5.0);
  EXPECT_EQ(value("o35\no70\n2\no22\nv0\nv1\no22\nv0\nv1\nn5\nn6\n"), 5.0);
  EXPECT_EQ(value("o37\nv0\n"), std::tanh(a));
  EXPECT_EQ(value("o38\nv0\n"), std::tan(a));
  EXPECT_EQ(value("o39\nv0\n"), std::sqrt(a));
  EXPECT_EQ(value("o40\nv0\n"), std::sinh(a));
  EXPECT_EQ(value("o41\nv0\n"), std::sin(a));
  EXPECT_EQ(value("o42\nv0\n"), std::log10(a));
  EXPECT_EQ(value("o43\nv0\n"), std::log(a));
  EXPECT_EQ(value("o44\nv0\n"), std::exp(a));
  EXPECT_EQ(value("o45\nv0\n"), std::cosh(a));
  EXPECT_EQ(value("o46\nv0\n"), std::cos(a));
  EXPECT_DOUBLE_EQ(value("o47\nv0\n"), std::atanh(a));
  EXPECT_EQ(value("o48\nv0\nv1\n"), std::atan2(a, b));
  EXPECT_EQ(value("o49\nv0\n"), std::atan(a));
  EXPECT_EQ(value("o50\nv0\n"), std::asinh(a));
  EXPECT_EQ(value("o51\nv0\n"), std::asin(a));
  EXPECT_DOUBLE_EQ(value("o52\nn2\n"), std::acosh(2.0));
  EXPECT_EQ(value("o53\nv0\n"), std::acos(a));
  EXPECT_EQ(value("o76\nv0\nn3\n"), std::pow(a, 3.0));
  EXPECT_EQ(value("o77\nv0\n"), a * a);
  EXPECT_EQ(value("o78\nn3\nv0\n"), std::pow(3.0, a));
  EXPECT_EQ(value("o3\nv0\nv1\n"), a / b);
}

TEST_F(NlReader, NamesWhatItCannotReadByItsLine) {
  EXPECT_THAT(refusal(altered("g3 1", "b3 1")), StartsWith("1: a binary .nl"));
  EXPECT_THAT(refusal("{\"problems\": []}"),
              StartsWith("1: '{\"problems\": []}'; expected the header"));
  EXPECT_THAT(refusal(""), StartsWith("1: the file ends; expected the header"));
  EXPECT_THAT(refusal(altered(" 4 2 1 0 1", " 4000 2 1 0 1")), StartsWith("2: "));
  EXPECT_THAT(refusal(altered(" 4 2 1 0 1", " 4 2 2 0 1")), StartsWith("2: several objectives"));
  EXPECT_THAT(refusal(altered(" 4 2 1 0 1 ", " 4 2 1 0 1 3")), StartsWith("2: logical"));
  EXPECT_THAT(refusal(altered(" 2 1 0 0 0 0", " 2 1 0 1 0 0")), StartsWith("3: complementarity"));
  EXPECT_THAT(refusal(altered(" 0 0 0 1", " 0 2 0 1")), StartsWith("6: imported functions"));
  EXPECT_THAT(refusal(altered(" 0 0 0 0 0 ", " 0 1 0 0 0 ")),
              StartsWith("7: binary or integer variables"));
  EXPECT_THAT(refusal(altered("o54	#sumlist", "o13")),
              StartsWith("20: operation o13 (floor)"));
  EXPECT_THAT(refusal(altered("v1\nv2\nv3\nC1", "v1\nv2\nv7\nC1")), StartsWith("18: 'v7'"));
  EXPECT_THAT(refusal(altered("v1\nv2\nv3\nC1", "v1\nv2\nf0 1\nC1")),
              StartsWith("18: an imported function"));
  EXPECT_THAT(refusal(altered("v1\nv2\nv3\nC1", "v1\nv2\nnx\nC1")), StartsWith("18: 'nx'"));
  EXPECT_THAT(refusal(altered("v1\nv2\nv3\nC1", "v1\nv2\nn1e999\nC1")), StartsWith("18: "));
  EXPECT_THAT(refusal(altered("C1\n", "C0\n")), HasSubstr("this constraint is there twice"));
  EXPECT_THAT(refusal(altered("C1\n", "C2\n")), HasSubstr("expected a constraint from 0 to 1"));
  EXPECT_THAT(refusal(altered("2 25\n", "5 1 2\n")), HasSubstr("complementarity"));
  EXPECT_THAT(refusal(altered("0 1 5\n", "0 6 5\n")), HasSubstr("not above the upper"));
  EXPECT_THAT(refusal(altered("0 1 5\n", "0 1 nan\n")), HasSubstr("a number"));
  EXPECT_THAT(refusal(altered("0 1\n1 5\n", "0 1\n9 5\n")), HasSubstr("a variable from 0 to 3"));
  EXPECT_THAT(refusal(altered("k3	#", "Q3	#")), HasSubstr("a segment"));
  EXPECT_THAT(refusal(altered("G0 4\n0 0\n1 0\n2 1\n3 0\n", "G0 4\n0 0\n")),
              HasSubstr("the file ends"));
  std::string deep;
  for (int i = 0; i < 6000; ++i) deep += "o16\n";
  EXPECT_THAT(refusal(altered("o77\nv1\n", deep + "v1\n")), HasSubstr("at most 5000 deep"));
  try {
    read_nl("no.nl");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "no.nl: no such file; expected a file .nl");
  }
}

TEST_F(NlReader, TakesNoFileThatIsCutOffForAWholeOne) {
  const std::string whole = hs71();
  for (std::size_t length = 0; length + 1 < whole.size(); ++length) {
    EXPECT_NE(refusal(whole.substr(0, length)), "accepted") << length;
  }
  EXPECT_EQ(read(whole.substr(0, whole.size() - 1)).rows.size(), 2U);
}

void expect_same_bits(const StatedProgramme& a, const StatedProgramme& b) {
  EXPECT_EQ(a.start, b.start);
  EXPECT_EQ(a.lower, b.lower);
  EXPECT_EQ(a.upper, b.upper);
  ASSERT_EQ(a.rows.size(), b.rows.size());
  const Eigen::VectorXd middle = 0.5 * (a.lower + a.upper);
  for (const Eigen::VectorXd& x : {a.start, middle}) {
    EXPECT_EQ(a.objective.value(x), b.objective.value(x));
    const Eigen::VectorXd gradient = a.objective.gradient(x);
    EXPECT_LE((gradient - b.objective.gradient(x)).norm(), 1e-12 * gradient.norm());
    for (std::size_t r = 0; r < a.rows.size(); ++r) {
      EXPECT_EQ(a.rows[r].body.value(x), b.rows[r].body.value(x));
      EXPECT_EQ(a.rows[r].body.dependencies(), b.rows[r].body.dependencies());
      EXPECT_EQ(a.rows[r].lower, b.rows[r].lower);
      EXPECT_EQ(a.rows[r].upper, b.rows[r].upper);
    }
  }
}

TEST_F(NlReader, ReadsWhatWasWrittenToTheBit) {
  for (const auto& problems : {zoo::well_scaled(), zoo::badly_scaled()}) {
    for (const FunctionProblem& p : problems) {
      SCOPED_TRACE(p.name);
      expect_same_bits(p.stated(), read(nl_text(p.stated(), p.name)));
    }
  }
  expect_same_bits(path_problem(2).stated, read(nl_text(path_problem(2).stated, "path")));
  expect_same_bits(r1_stated(), read(nl_text(r1_stated(), "R1")));
  const StatedProgramme hs = read(hs71());
  expect_same_bits(hs, read(nl_text(hs, "hs71")));
}

TEST_F(NlReader, WritesTheCountsOfTheHeader) {
  const std::string text = nl_text(read(hs71()), "a comment");
  EXPECT_THAT(text, StartsWith("g3 1 1 0\t# a comment\n 4 2 1 0 1\n 2 1\n 0 0\n 4 4 4\n 0 0 0 1\n"
                               " 0 0 0 0 0\n 8 4\n 0 0\n 0 0 0 0 0\nC0\n"));
  EXPECT_THAT(text, EndsWith("G0 4\n0 0\n1 0\n2 0\n3 0\n"));
}

}  // namespace
}  // namespace prospect::nl_reader_test
