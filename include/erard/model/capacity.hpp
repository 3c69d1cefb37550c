// Bounds fixed at compile time: all memory of one mechanism is in place, nothing grows while it moves. Mechanism, State
// and Workspace together stay below 64 KiB, so that an action stays in the inner caches.
#pragma once

namespace erard {

inline constexpr int kMaxBodies = 12;    // rigid bodies, the ground excluded (the grand action has 6)
inline constexpr int kMaxContacts = 20;  // of which each may carry one felt (the grand action has 14)

// bodies and felts with mass (grand action: 6, with felt bodies 20)
inline constexpr int kMaxCoordinates = 24;

// scalar laws: normal, tangent and stop of a felt with mass of each contact, hinges (grand action: 23, with felt bodies 37)
inline constexpr int kMaxRows = 40;

}  // namespace erard
