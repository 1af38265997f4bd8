// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/planner/seeds.h"
#include "engine/problem/solver.h"
#include "engine/problem/term_registry.h"
#include "engine/terms/problem_specification.h"

namespace prospect {

/// Where a problem comes from.
struct ProblemOrigin {
  std::string program;     ///< that wrote it, with its version: "prospect 0.1.0"
  std::string world;       ///< name of the world, free text
  std::uint64_t seed = 0;  ///< of the mission
  int step = 0;            ///< planning step of the mission, from 0
  double time = 0.0;       ///< [s] of the robot's clock since the start
};

/// One self-contained planning problem, as a file holds it.
struct SavedProblem {
  ProblemOrigin origin;
  ProblemSpecification specification;
  std::vector<Seed> seeds;              ///< the planner's, best first; may be empty
  std::optional<WarmStart> warm_start;  ///< of a solver, if there is one
};

/// The version that is written; all up to it are read. docs/reference/problem_files.md describes
/// them.
constexpr int kProblemFileVersion = 7;

/// Writes a problem file (HDF5): to `path`.part, then renamed, so that `path` is never half
/// written. Maps are cut down to what the problem looks at (with_maps_cut); terms that are not
/// built in are written by their names, versions and options. The same problem gives the same
/// bytes. Throws std::invalid_argument, with nothing written, for a problem that a file cannot hold
/// (a motion model of the user's own, a number that is not finite, more than the limits of
/// docs/reference/problem_files.md), and std::runtime_error if writing fails; both in one line that
/// begins with the path.
void write_problem(const std::string& path, const SavedProblem& saved);

/// A problem file, read and checked as a whole, and the Problem that it makes.
struct ReadProblem {
  SavedProblem saved;
  std::shared_ptr<const Problem> problem;
};

/// Reads a problem file. With the same build on the same machine, the problem's costs, constraints
/// and derivatives are those of the one that was written, bit for bit. Throws std::invalid_argument
/// in one line, "PATH: what; expected what", for a file that is missing, damaged, truncated, of
/// another kind or version, holds what no problem can, or makes a problem whose terms are no finite
/// numbers wherever a solver could begin. terms: where those that are not built in are looked up; a
/// file with one that is not there, or that has other options there, is refused by its name.
///
/// Reads the file once, from its beginning to its end; nothing else is opened, whatever it says.
/// Thread-safety: calls from several threads are safe if the HDF5 library is (Debian's is).
ReadProblem read_problem(const std::string& path, const TermRegistry& terms = {});

}  // namespace prospect
