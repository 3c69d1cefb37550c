// The action without its felts: what the force makes of the key, and what the key makes of the force.
//   thesis 6.4.2, Figures 6.11 and 6.12
#pragma once

#include <string>
#include <vector>

#include "study/played_stroke.hpp"
#include "study/section.hpp"

namespace erard::study {

/// Ways of leaving the felts out.
enum class Felts {
  out,           // as the thesis did: rigid surfaces where the felts' surfaces were    FeltModel::rigid
  out_reset,     // those that a felt's compression at rest lets overlap are set back by it: the rest stays
  knuckle_kept,  // the same, but for the leather of the knuckle (contact JH), which stays
};
const char* name_of(Felts felts);

/// The grand action with its felts left out in one of these ways.
ActionFile action_without(Felts felts);

/// Relative errors (6.3) of one stroke [-].
struct FeltlessErrors {
  double key = 0;    // of the key's displacement, driven by force
  double force = 0;  // of the finger's force, driven by position
};

/// One stroke on one such action, against the same stroke on the full action.
struct FeltlessStroke {
  Felts felts = Felts::out;
  PlayedStroke by_force;     // driven by the force that the full action took under the piston
  PlayedStroke by_position;  // driven by the piston
  FeltlessErrors error;      // up to the release
  FeltlessErrors descent;    // up to the let-off of the full action
};

struct FeltlessComparison {
  StrokeCase stroke;
  PlayedStroke full;                    // with felts, driven by position
  PlayedStroke full_by_force;           // with felts, driven by the force of `full`
  std::vector<FeltlessStroke> without;  // in the order of Felts

  const FeltlessStroke& of(Felts felts) const { return without[static_cast<std::size_t>(felts)]; }
};

/// Plays one stroke with and without felts up to its release. Cost: half a second.
FeltlessComparison compare_felts(const StrokeCase& stroke);

inline constexpr double kFirstRebound = 0.020;  // [s] from the front rail to where the key would swing on its felt

/// Largest less smallest value of a quantity from kFirstRebound after the key met the front rail to the release.
template <typename Quantity>
double swing_on_rail(const PlayedStroke& stroke, double release, const Quantity& quantity) {
  return spread(stroke, stroke.event(EventKind::key_meets_front_rail).time + kFirstRebound, release, quantity);
}

/// When rigid surfaces that overlap at the start have pushed each other apart, to 1 um [s]; looked for in the first 5 ms.
double end_of_overlap(const PlayedStroke& stroke);

Section without_felts_section(const Pictures& pictures);

}  // namespace erard::study
