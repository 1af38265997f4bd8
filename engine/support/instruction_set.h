// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

// For kernels: loops over many points that are compiled for several vector widths from one source
// and chosen at run time. The body of such a kernel and all that it calls are force-inlined,
// because a function compiled for the baseline cannot be widened after the fact: each entry point
// is one body per instruction set,
//
//   PROSPECT_FORCE_INLINE void body(...) {...}
//   void body_generic(...) { body(...); }
//   #if defined(__x86_64__)
//   PROSPECT_TARGET_AVX2 void body_avx2(...) { body(...); }
//   PROSPECT_TARGET_AVX512 void body_avx512(...) { body(...); }
//   #endif
//
// Neither target includes fused multiply-add, and contraction is off (cmake/Room.cmake): all widths
// give the same bits as long as sums run in a fixed number of lanes.
#define PROSPECT_FORCE_INLINE [[gnu::always_inline]] static inline
#if defined(__x86_64__)
#define PROSPECT_TARGET_AVX2 __attribute__((target("avx2")))
#define PROSPECT_TARGET_AVX512 \
  __attribute__((target("avx512f,avx512dq,avx512vl,prefer-vector-width=512")))
#endif

namespace prospect {

enum class InstructionSet {
  kGeneric,  ///< what the compiler assumes of every processor of the architecture
  kAvx2,
  kAvx512  ///< F, DQ and VL
};

/// "generic", "avx2", "avx512".
std::string_view name(InstructionSet set);

/// Those that this processor can run, narrowest first; never empty. Thread-safe.
std::vector<InstructionSet> available_instruction_sets();
/// The widest. Does not allocate.
InstructionSet best_instruction_set();

}  // namespace prospect
