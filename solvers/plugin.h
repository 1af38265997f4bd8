// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "engine/problem/solver.h"
#include "engine/problem/term_registry.h"
#include "engine/terms/problem_specification.h"
#include "models/version.h"

/// What a shared library must offer to be loaded as a plug-in (solvers/load_plugin.h, `prospect
/// --plugin lib.so`): a C function `prospect_plugin` that returns one Plugin, with back ends,
/// terms, problems and a robot. Whole examples are docs/examples/plugin, user_term and create2; the
/// page is docs/reference/plugins.md.
///
/// Prospect's libraries are static, so that a plug-in holds a copy of the engine of its own, and
/// that copy works on the objects of the program. Hence both must be compiled from the same
/// version, with the same layout of every type. That is what PluginAbi states, and load_plugin()
/// refuses a plug-in that states anything else before any object has crossed the border.
///
/// May cross: a const Problem& and all that is reached from it (virtual calls on the terms and the
/// model of the program), a StopCondition, warm starts, options and results by value, a const
/// TermContext& and the maps that are reached from it, a ProblemDefinition by value, memory (both
/// sides share one malloc; Eigen's alignment is part of PluginAbi).
/// May not: exceptions (the program turns those of a Solver into kError, those of a term's factory
/// and of its evaluate() into a step without that term, and those of the entry point and of the
/// other factories into a refusal; a constructor of a static object that throws ends the program),
/// typeid and dynamic_cast on classes of Prospect, addresses of static objects. Nothing static is
/// shared: each side has its own. A plug-in links the shared C++ standard library.
namespace prospect {

/// Of this file, and of the virtual functions of Solver, Term, MotionModel and their scratch:
/// raised with every change of either.
constexpr std::uint32_t kPluginInterface = 5;

/// What two libraries must have in common to share objects. Constants of the file that is compiled,
/// so that a plug-in states its own flags; compared one by one.
struct PluginAbi {
  const char* version;              ///< of Prospect: private layouts count too
  std::int32_t compiler;            ///< __GXX_ABI_VERSION
  std::int32_t standard_library;    ///< major version of libstdc++, 0 for another
  std::int32_t new_strings;         ///< _GLIBCXX_USE_CXX11_ABI
  std::int32_t checked_containers;  ///< 1: compiled with _GLIBCXX_DEBUG
  std::int32_t eigen;               ///< 30400 for 3.4.0
  std::int32_t eigen_alignment;     ///< EIGEN_MAX_ALIGN_BYTES [byte]; -mavx and wider change it
  std::int32_t eigen_static;        ///< EIGEN_MAX_STATIC_ALIGN_BYTES [byte]
  std::int32_t eigen_row_major;     ///< 1: matrices are stored by rows
  std::int32_t eigen_index;         ///< sizeof(Eigen::Index) [byte]
  std::int32_t problem, evaluation, trajectories, term_traits, result;  ///< sizes [byte]
  std::int32_t definition, specification, evaluators;                   ///< likewise
  std::int32_t optimized;  ///< 1: compiled with optimisation; not compared, told (load_plugin.h)
};

#ifdef _GLIBCXX_RELEASE
#define PROSPECT_LIBSTDCXX _GLIBCXX_RELEASE
#define PROSPECT_LIBSTDCXX_STRINGS _GLIBCXX_USE_CXX11_ABI
#else
#define PROSPECT_LIBSTDCXX 0
#define PROSPECT_LIBSTDCXX_STRINGS 0
#endif
#ifdef _GLIBCXX_DEBUG
#define PROSPECT_CHECKED_CONTAINERS 1
#else
#define PROSPECT_CHECKED_CONTAINERS 0
#endif
#ifdef __OPTIMIZE__
#define PROSPECT_OPTIMIZED 1
#else
#define PROSPECT_OPTIMIZED 0
#endif
constexpr PluginAbi kPluginAbi = {
    kVersion,
    __GXX_ABI_VERSION,
    PROSPECT_LIBSTDCXX,
    PROSPECT_LIBSTDCXX_STRINGS,
    PROSPECT_CHECKED_CONTAINERS,
    10000 * EIGEN_WORLD_VERSION + 100 * EIGEN_MAJOR_VERSION + EIGEN_MINOR_VERSION,
    EIGEN_MAX_ALIGN_BYTES,
    EIGEN_MAX_STATIC_ALIGN_BYTES,
    EIGEN_DEFAULT_MATRIX_STORAGE_ORDER_OPTION == Eigen::RowMajor ? 1 : 0,
    static_cast<std::int32_t>(sizeof(Eigen::Index)),
    static_cast<std::int32_t>(sizeof(Problem)),
    static_cast<std::int32_t>(sizeof(Evaluation)),
    static_cast<std::int32_t>(sizeof(TrajectoryBatch)),
    static_cast<std::int32_t>(sizeof(TermTraits)),
    static_cast<std::int32_t>(sizeof(Result)),
    static_cast<std::int32_t>(sizeof(ProblemDefinition)),
    static_cast<std::int32_t>(sizeof(ProblemSpecification)),
    static_cast<std::int32_t>(sizeof(CachedEvaluators)),
    PROSPECT_OPTIMIZED,
};
#undef PROSPECT_LIBSTDCXX
#undef PROSPECT_LIBSTDCXX_STRINGS
#undef PROSPECT_CHECKED_CONTAINERS
#undef PROSPECT_OPTIMIZED

/// One back end of a plug-in.
struct PluginSolver {
  const char* name;         ///< 1 to 64 letters, digits and _ - . : ; not one the registry has
  const char* description;  ///< one sentence, for `prospect list solvers`
  Solver* (*make)();        ///< called once; the program deletes what it returns
};

/// One term of a plug-in (engine/problem/term_registry.h).
struct PluginTerm {
  const char* name;         ///< 1 to 64 letters, digits and _ - ; not one the registry has
  const char* description;  ///< one sentence, for `prospect list terms`
  std::int32_t version;     ///< of its options: raised when they change their meaning, from 1
  const TermOption* options;
  std::size_t num_options;
  /// Called at every planning step, with all options; the program deletes what it returns.
  Term* (*make)(const TermOptions& options, const TermContext& context);
};

/// One problem of a plug-in, to measure back ends on (engine/problem/problem_registry.h).
struct PluginProblem {
  const char* set;          ///< it is reported with: 1 to 64 letters, digits and _ - .
  const char* description;  ///< of the set, one line, for `prospect list sets`
  const char* name;         ///< unique within its set
  ProblemDefinition (*make)();
  Eigen::VectorXd (*start)() = nullptr;  ///< where back ends start; null: the middle of the bounds
  /// Cost of the best point known; not a number: nobody has looked.
  double best_known = std::numeric_limits<double>::quiet_NaN();
};

struct PluginRobot;  // runtime/plugin_robot.h: what it is the room of solvers does not know

/// What `prospect_plugin` returns: static data of the plug-in, or nullptr if it cannot be used now.
struct Plugin {
  std::uint32_t interface_version;  ///< kPluginInterface; first in every version
  PluginAbi abi;                    ///< kPluginAbi
  const PluginSolver* solvers = nullptr;
  std::size_t num_solvers = 0;
  const PluginTerm* terms = nullptr;
  std::size_t num_terms = 0;
  const PluginProblem* problems = nullptr;
  std::size_t num_problems = 0;
  const PluginRobot* robot = nullptr;
};

}  // namespace prospect

/// Defined by the plug-in; visible even if it is compiled with -fvisibility=hidden.
extern "C" [[gnu::visibility("default")]] const prospect::Plugin* prospect_plugin();
