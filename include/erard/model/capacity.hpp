// Bounds fixed at compile time: all memory of one mechanism is in place, nothing grows while it moves.
#pragma once

namespace erard {

inline constexpr int kMaxBodies = 12;    // rigid bodies, the ground excluded (the grand action has 6)
inline constexpr int kMaxContacts = 20;  // of which each may carry one felt (the grand action has 14)
inline constexpr int kMaxCoordinates = kMaxBodies + kMaxContacts;

// scalar laws: normal, tangent and felt stop of each contact, hinges (grand action: 23, with felt bodies 37)
inline constexpr int kMaxRows = 3 * kMaxContacts + kMaxBodies;

}  // namespace erard
