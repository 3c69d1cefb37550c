// What the lanes leave to the scalar engine's own code.
#pragma once

#include "batch.hpp"
#include "erard/solver/scheme.hpp"

namespace erard::lanes {

/// @param scheme  must outlive them
Calls calls_of(const Scheme& scheme) noexcept;

}  // namespace erard::lanes
