// Bounds fixed at compile time: all memory of one mechanism is in place, nothing grows while it moves.
#pragma once

namespace erard {

inline constexpr int kMaxBodies = 12;    // rigid bodies, the ground excluded (the grand action has 6)
inline constexpr int kMaxContacts = 20;  // of which each may carry one felt (the grand action has 14)
inline constexpr int kMaxCoordinates = kMaxBodies + kMaxContacts;

// scalar laws of the one-step problem: normal, tangent and felt stop of each contact, hinges, finger (grand action: 38)
inline constexpr int kMaxRows = 3 * kMaxContacts + kMaxBodies + 1;

}  // namespace erard
