// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/problem_file/problem_file.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "adapters/formats/problem_file/hdf5_archive.h"
#include "adapters/formats/problem_file/problem_format.h"
#include "models/one_line.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

/// A file of more bytes is none of ours.
constexpr std::uintmax_t kMostBytes = 1u << 30;

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
  throw std::invalid_argument(one_line(path + ": " + what));
}

/// Throws if no solver can begin: if the cost or a constraint is no finite number at the warm
/// start, at the best seeds and at the inputs nearest to zero. Single entries can each be in order
/// and still make, together, numbers beyond all bounds.
void check_can_be_solved(const ReadProblem& read) {
  const Problem& problem = *read.problem;
  std::vector<Eigen::VectorXd> points;
  if (read.saved.warm_start && read.saved.warm_start->x.size() == problem.num_variables()) {
    points.push_back(read.saved.warm_start->x);
  }
  constexpr std::size_t kMostSeeds = 10;  // the best come first
  for (std::size_t n = 0; n < std::min(kMostSeeds, read.saved.seeds.size()); ++n) {
    points.push_back(read.saved.seeds[n].z);
  }
  points.push_back(Eigen::VectorXd::Zero(problem.num_variables())
                       .cwiseMax(problem.lower())
                       .cwiseMin(problem.upper()));
  Workspace workspace = problem.make_workspace();
  Evaluation value;
  for (const Eigen::VectorXd& z : points) {
    if (problem.evaluate(z, Evaluate::kValue, workspace, value)) return;
  }
  std::string terms;
  for (const TermValue& term : problem.explain(points.front()).terms) {
    if (!std::isfinite(term.raw) || !std::isfinite(term.weighted)) {
      terms += (terms.empty() ? " (" : ", ") + term.name;
    }
  }
  throw std::invalid_argument("its terms are no finite numbers at any of its seeds" + terms +
                              (terms.empty() ? "" : ")") + "; expected a problem to solve");
}

std::string contents(const std::string& path) {
  constexpr const char* kExpected = "; expected a problem file";
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found)
    refuse(path, std::string("no such file") + kExpected);
  if (error) refuse(path, "cannot be read (" + error.message() + ")" + kExpected);
  if (fs::is_directory(status)) refuse(path, std::string("is a directory") + kExpected);
  if (!fs::is_regular_file(status)) refuse(path, std::string("is no regular file") + kExpected);
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) refuse(path, "cannot be read (" + error.message() + ")" + kExpected);
  if (size == 0) refuse(path, std::string("empty file") + kExpected);
  if (size > kMostBytes) {
    refuse(path, std::to_string(size) + " bytes; expected a problem file, at most 1 GiB");
  }
  std::string bytes(static_cast<std::size_t>(size), '\0');
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file) {
    refuse(path, std::string("cannot be read (") +
                     (errno != 0 ? std::strerror(errno) : "it became shorter meanwhile") + ")" +
                     kExpected);
  }
  return bytes;
}

}  // namespace

void write_problem(const std::string& path, const SavedProblem& saved) {
  std::string bytes;
  try {
    SavedProblem problem = saved;
    for (const bool there : {problem.specification.robot.model != nullptr,
                             problem.specification.cost_to_go != nullptr}) {
      if (!there) throw std::invalid_argument("an incomplete problem; expected a whole one");
    }
    problem.specification = with_maps_cut(std::move(problem.specification));
    Hdf5Writer writer;
    transfer_problem(writer, problem, {});
    bytes = writer.finish();
  } catch (const std::invalid_argument& e) {
    refuse(path, std::string("cannot be written: ") + e.what());
  } catch (const std::exception& e) {
    throw std::runtime_error(one_line(path + ": cannot be written: " + e.what()));
  }

  const std::string temporary = path + ".part";
  errno = 0;
  std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
  file << bytes;
  file.close();
  std::error_code error;
  if (!file) {
    error = std::error_code(errno, std::generic_category());
  } else {
    fs::rename(temporary, path, error);
    if (!error) return;
  }
  std::error_code ignored;
  fs::remove(temporary, ignored);
  throw std::runtime_error(one_line(path + ": writing failed (" + error.message() + ")"));
}

ReadProblem read_problem(const std::string& path, const TermRegistry& terms) {
  const std::string bytes = contents(path);
  try {
    ReadProblem read;
    Hdf5Reader reader(bytes);
    transfer_problem(reader, read.saved, terms);
    reader.finish();
    read.problem = make_problem(read.saved.specification);
    check_can_be_solved(read);
    return read;
  } catch (const std::exception& e) {
    refuse(path, e.what());
  }
}

}  // namespace prospect
