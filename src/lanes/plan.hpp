// A mechanism as the lanes see it: structure and numbers apart.
#pragma once

#include <optional>

#include "batch.hpp"
#include "erard/mechanics/mechanism.hpp"

namespace erard::lanes {

/// @return nothing where the lanes cannot step it: felt bodies, contacts without felt
std::optional<Plan> plan_of(const Mechanism& mechanism) noexcept;

ActionNumbers<double> numbers_of(const Mechanism& mechanism, const Plan& plan) noexcept;

}  // namespace erard::lanes
