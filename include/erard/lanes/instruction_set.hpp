// How many keys the CPU can step at once.
#pragma once

namespace erard {

/// What the lanes are compiled for, from the least on.
enum class InstructionSet {
  baseline,  // of every x86-64: SSE2, 2 lanes
  avx2,      // 4 lanes
  avx512,    // 8 lanes
};
inline constexpr InstructionSet kInstructionSets[] = {InstructionSet::baseline, InstructionSet::avx2,
                                                      InstructionSet::avx512};

const char* name_of(InstructionSet set) noexcept;
int lanes_of(InstructionSet set) noexcept;

/// Whether this CPU, and its operating system, have it.
bool is_available(InstructionSet set) noexcept;
InstructionSet best_instruction_set() noexcept;

}  // namespace erard
