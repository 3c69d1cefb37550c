#include "erard/lanes/instruction_set.hpp"

#include "kernels.hpp"

namespace erard {

const char* name_of(InstructionSet set) noexcept {
  switch (set) {
    case InstructionSet::avx2: return "avx2";
    case InstructionSet::avx512: return "avx512";
    default: return "baseline";
  }
}

int lanes_of(InstructionSet set) noexcept {
  switch (set) {
    case InstructionSet::avx2: return 4;
    case InstructionSet::avx512: return 8;
    default: return 2;
  }
}

bool is_available(InstructionSet set) noexcept {
  switch (set) {
    case InstructionSet::avx2: return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case InstructionSet::avx512: return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq");
    default: return true;
  }
}

InstructionSet best_instruction_set() noexcept {
  InstructionSet best = InstructionSet::baseline;
  for (const InstructionSet set : kInstructionSets)
    if (is_available(set)) best = set;
  return best;
}

namespace lanes {

const Kernel& kernel_for(InstructionSet set) noexcept {
  switch (set) {
    case InstructionSet::avx2: return kernel_avx2();
    case InstructionSet::avx512: return kernel_avx512();
    default: return kernel_baseline();
  }
}

}  // namespace lanes
}  // namespace erard
