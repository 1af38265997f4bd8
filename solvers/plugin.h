#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "engine/problem/solver.h"
#include "models/version.h"

/// What a shared library must offer to be loaded as a plug-in (solvers/load_plugin.h, `prospect
/// --plugin lib.so`): a C function `prospect_plugin` that returns one Plugin. A whole example is
/// docs/examples/plugin; the page is docs/reference/plugins.md.
///
/// Prospect's libraries are static, so that a plug-in holds a copy of the engine of its own, and
/// that copy works on the objects of the program. Hence both must be compiled from the same
/// version, with the same layout of every type. That is what PluginAbi states, and load_plugin()
/// refuses a plug-in that states anything else before any object has crossed the border.
///
/// May cross: a const Problem& and all that is reached from it (virtual calls on the terms and the
/// model of the program), a StopCondition, warm starts, options and results by value, memory (both
/// sides share one malloc; Eigen's alignment is part of PluginAbi).
/// May not: exceptions (the program turns those of a Solver into kError, and those of the entry
/// point and of the factory into a refusal; a constructor of a static object that throws ends the
/// program), typeid and dynamic_cast on classes of Prospect, addresses of static objects. Nothing
/// static is shared: each side has its own. A plug-in links the shared C++ standard library.
namespace prospect {

/// Of this file, and of the virtual functions of Solver, Term, MotionModel and their scratch:
/// raised with every change of either.
constexpr std::uint32_t kPluginInterface = 3;

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
};
#undef PROSPECT_LIBSTDCXX
#undef PROSPECT_LIBSTDCXX_STRINGS
#undef PROSPECT_CHECKED_CONTAINERS

/// One back end of a plug-in.
struct PluginSolver {
  const char* name;         ///< 1 to 64 letters, digits and _ - . : ; not one the registry has
  const char* description;  ///< one sentence, for `prospect list solvers`
  Solver* (*make)();        ///< called once; the program deletes what it returns
};

/// What `prospect_plugin` returns: static data of the plug-in, or nullptr if it cannot be used now.
struct Plugin {
  std::uint32_t interface_version;  ///< kPluginInterface; first in every version
  PluginAbi abi;                    ///< kPluginAbi
  const PluginSolver* solvers;
  std::size_t num_solvers;
};

}  // namespace prospect

/// Defined by the plug-in; visible even if it is compiled with -fvisibility=hidden.
extern "C" [[gnu::visibility("default")]] const prospect::Plugin* prospect_plugin();
