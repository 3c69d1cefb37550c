// Which kernel serves an instruction set.
#pragma once

#include "batch.hpp"
#include "erard/lanes/instruction_set.hpp"

namespace erard::lanes {

const Kernel& kernel_for(InstructionSet set) noexcept;

}  // namespace erard::lanes
