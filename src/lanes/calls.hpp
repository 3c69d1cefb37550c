// What the lanes leave to the scalar engine's own code.
#pragma once

#include "batch.hpp"

namespace erard::lanes {

const Calls& calls() noexcept;

}  // namespace erard::lanes
