// What the lanes leave to the scalar engine's own code.
#pragma once

#include "batch.hpp"

namespace erard::lanes {

extern const Calls kCalls;

}  // namespace erard::lanes
