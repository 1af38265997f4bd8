// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/export_problems.h"

#include <cctype>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/output_folder.h"
#include "adapters/formats/problem_file/problem_file.h"
#include "adapters/formats/programmes/c_writer.h"
#include "adapters/formats/programmes/casadi_writer.h"
#include "adapters/formats/programmes/nl_writer.h"
#include "adapters/missions/bench/problem_set.h"
#include "adapters/program/cli/command.h"
#include "adapters/program/cli/shell_words.h"
#include "adapters/program/cli/written_file.h"
#include "models/version.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

struct OutputFile {
  std::string name, content;
};

/// An identifier of C and of Python that is not in use: of the letters and digits of `name`.
std::string identifier(const std::string& name, std::set<std::string>& used) {
  // Words of C, and functions of libm, which a file of C may call.
  static const std::set<std::string> kTaken = {
      "auto",   "break",     "case",    "char",   "const",    "continue", "default", "do",
      "double", "else",      "enum",    "extern", "float",    "for",      "goto",    "if",
      "inline", "int",       "long",    "main",   "register", "return",   "short",   "signed",
      "sizeof", "static",    "struct",  "switch", "union",    "unsigned", "void",    "volatile",
      "while",  "operation", "numbers", "sin",    "cos",      "tan",      "exp",     "log",
      "log10",  "sqrt",      "pow",     "fabs",   "sinh",     "cosh",     "tanh",    "asin",
      "acos",   "atan",      "asinh",   "acosh",  "atanh",    "atan2",    "gamma",   "y0",
      "y1",     "j0",        "j1",      "casadi", "import",   "class"};
  std::string made;
  for (const char c : name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 && c > 0;
    if (plain || (!made.empty() && made.back() != '_')) made += plain ? c : '_';
  }
  while (!made.empty() && made.back() == '_') made.pop_back();
  if (made.empty() || std::isdigit(static_cast<unsigned char>(made[0])) != 0 ||
      kTaken.contains(made)) {
    made = "problem_" + made;
  }
  std::string free = made;
  for (int i = 2; !used.insert(free).second; ++i) free = made + "_" + std::to_string(i);
  return free;
}

/// What stands on the first line of what is written: of plain characters alone.
std::string comment_of(const std::string& problem, const std::string& source) {
  std::string text =
      problem + " of " + fs::path(source).filename().string() + ", written by prospect " + kVersion;
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e || c == '*' ||
        c == '/' || c == '\\' || c == '?') {
      c = '_';
    }
  }
  return text;
}

ProgrammeData data_of(const Problem& problem, const Eigen::VectorXd& start) {
  const Eigen::Index m = problem.num_constraints();
  return {column_pattern(problem),
          start,
          problem.lower(),
          problem.upper(),
          Eigen::VectorXd::Zero(m),
          Eigen::VectorXd::Constant(m, std::numeric_limits<double>::infinity())};
}

ProgrammeData data_of(const LiftedProblem& lifted, const Eigen::VectorXd& start, int gaps) {
  const Eigen::Index m = lifted.num_constraints();
  ProgrammeData data{lifted.pattern(),
                     lifted.lifted(start),
                     lifted.lower(),
                     lifted.upper(),
                     Eigen::VectorXd::Zero(m),
                     Eigen::VectorXd::Constant(m, std::numeric_limits<double>::infinity())};
  data.row_upper.head(gaps).setZero();
  return data;
}

/// The C of a problem file, and its bytes, to stand beside it.
void add_problem_file(const std::string& path, const Eigen::VectorXd& given,
                      const std::string& name, const std::string& comment,
                      const std::string& folder, std::vector<OutputFile>& files) {
  std::shared_ptr<const Problem> problem;
  try {
    problem = read_problem(path).problem;  // as the library reads it: without plug-ins
  } catch (const std::invalid_argument& e) {
    throw InputError(e.what());
  }
  if (!problem->has_gradient()) {
    throw InputError(path + ": a term has no gradient; expected gradients of all");
  }
  const LiftedProblem lifted(problem);
  const Eigen::VectorXd start =
      given.size() > 0 ? given : Eigen::VectorXd(0.5 * (problem->lower() + problem->upper()));
  const Horizon& h = problem->horizon();
  std::error_code error;
  const fs::path beside = fs::path(folder) / (name + ".h5");
  if (!fs::equivalent(path, beside, error)) {
    std::ifstream file(path, std::ios::binary);
    files.push_back({name + ".h5", std::string(std::istreambuf_iterator<char>(file), {})});
  }
  const std::string absolute = fs::absolute(beside).lexically_normal().string();
  files.push_back(
      {name + ".c", c_text_of_file(absolute, data_of(*problem, start),
                                   data_of(lifted, start, h.N * h.nx()), name, comment)});
}

/// How what was written is compiled, where this program stands.
std::string compile_line(const std::string& folder, const std::vector<OutputFile>& files,
                         bool with_library) {
  std::string libraries = " -lm";
  if (with_library) {
    libraries = " -lprospect_external";
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    for (const char* place : {PROSPECT_LIBDIR, "adapters/program/external"}) {
      const fs::path there = (program.parent_path() / place).lexically_normal();
      if (program.empty() || !fs::exists(there / "libprospect_external.so", error)) continue;
      const std::string path = shell_word(there.string());
      libraries += " -L" + path + " -Wl,-rpath," + path;
      break;
    }
  }
  std::vector<std::string> sources;
  for (const OutputFile& file : files) {
    if (file.name.ends_with(".c")) sources.push_back(file.name.substr(0, file.name.size() - 2));
  }
  const std::string cc = "cc -O2 -shared -fPIC ";
  if (sources.size() == 1) {
    const std::string stem = shell_word((fs::path(folder) / sources[0]).string());
    return cc + stem + ".c -o " + stem + ".so" + libraries;
  }
  return "for f in " + shell_word(folder) + "/*.c; do " + cc + "\"$f\" -o \"${f%.c}.so\"" +
         libraries + "; done";
}

}  // namespace

int export_problems(const ProblemExport& wanted, const Registries& registries,
                    SignalGuard& signals) {
  if (wanted.problems == "missions") {
    throw InputError(
        "missions: is driven, and stored nowhere; expected a folder that `prospect bench "
        "--capture DIR` has written");
  }
  const ProblemSet set = make_problem_set(wanted.problems, Configuration(), registries, false);
  std::set<std::string> used;
  std::vector<OutputFile> files;
  bool with_library = false;
  for (std::size_t i = 0; i < set.problems.size(); ++i) {
    const BenchProblem& problem = set.problems[i];
    const bool is_file = !problem.stated && i < set.files.size();
    const std::string source = is_file ? set.files[i] : wanted.problems;
    const std::string name = identifier(problem.name, used);
    const std::string comment = comment_of(problem.name, source);
    const std::string where =
        is_file ? source : "problem '" + problem.name + "' of '" + wanted.problems + "'";
    if (!problem.stated && wanted.to != "c") {
      throw InputError(where + ": its " +
                       (is_file ? "maps and landmarks are" : "functions are code,") +
                       " no formulas, which --to " + wanted.to + " needs; expected " +
                       (is_file ? "--to c" : "problems as expressions"));
    }
    if (!problem.stated && !is_file) {
      throw InputError(where +
                       ": its functions are code of a plug-in; expected problems as expressions "
                       "or problem files");
    }
    if (is_file) {
      with_library = true;
      add_problem_file(source, problem.start.x, name, comment, wanted.folder, files);
    } else if (wanted.to == "c") {
      files.push_back({name + ".c", c_text(problem.stated(), name, comment)});
    } else if (wanted.to == "nl") {
      files.push_back({name + ".nl", nl_text(problem.stated(), comment)});
    } else {
      files.push_back({name + ".py", casadi_text(problem.stated(), comment)});
    }
  }
  signals.note();  // what is written now is written whole
  OutputFolder out = OutputFolder::beside(wanted.folder);
  std::vector<std::string> names;
  for (const OutputFile& file : files) names.push_back(file.name);
  out.claim_all(names);  // all, before the first is written
  for (const OutputFile& file : files) {
    const std::string path = (fs::path(wanted.folder) / file.name).string();
    write_file(out, file.name, file.content, path);
    std::printf("%s\n", path.c_str());
  }
  if (wanted.to == "c") {
    std::printf("%s\n", compile_line(wanted.folder, files, with_library).c_str());
  }
  return kDone;
}

}  // namespace prospect
