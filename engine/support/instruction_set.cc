// SPDX-License-Identifier: Apache-2.0
#include "engine/support/instruction_set.h"

namespace prospect {

std::string_view name(InstructionSet set) {
  switch (set) {
    case InstructionSet::kAvx2:
      return "avx2";
    case InstructionSet::kAvx512:
      return "avx512";
    default:
      return "generic";
  }
}

InstructionSet best_instruction_set() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2");
  if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl")) {
    return InstructionSet::kAvx512;
  }
  if (avx2) return InstructionSet::kAvx2;
#endif
  return InstructionSet::kGeneric;
}

std::vector<InstructionSet> available_instruction_sets() {
  // Each set includes the narrower ones.
  std::vector<InstructionSet> sets;
  for (int i = 0; i <= static_cast<int>(best_instruction_set()); ++i) {
    sets.push_back(static_cast<InstructionSet>(i));
  }
  return sets;
}

}  // namespace prospect
