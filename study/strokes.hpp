// Two strokes, piano and forte: force, motion of all bodies, events; and three models of the string.
//   thesis 6.2, 6.3 and 6.4.1, Figures 6.2 to 6.9
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "study/played_stroke.hpp"
#include "study/section.hpp"

namespace erard::study {

/// A stroke driven by position (Figures 6.2, 6.3), and by the force that it took (6.7, 6.8).
struct DrivenStroke {
  StrokeCase stroke;
  PlayedStroke by_position;
  PlayedStroke by_force;
};

/// Plays a stroke until the jack is back under the knuckle. Cost: a tenth of a second.
DrivenStroke drive_both_ways(const StrokeCase& stroke);

/// The grand action with a string that is met without felt, by Newton's law.         thesis 6.2.2
/// @param restitution  e in [0, 1]; 0 is the inelastic string of most of the thesis's results, the e of its elastic law is
///                     not printed
ActionFile action_with_rigid_string(double restitution);

/// What the blow did to the hammer: speeds of its head, towards the string before and away from it after [m/s].
struct Impact {
  double before = 0, after = 0;
  double share() const { return after / before; }
};
/// Of the first blow: in the step before it, and in the last one of the contact.
/// @param action  whose stroke it is
/// Throws std::runtime_error when the hammer did not meet the string.
Impact impact_of(const ActionFile& action, const PlayedStroke& stroke);

/// Largest force of the finger from the impact to `end` [N].
double peak_after_impact(const PlayedStroke& stroke, double end);

/// What 6.4.1 says of the force around the let-off and the front rail.
struct LetOffPattern {
  double hump = 0;                // rise of the force after the jack met the button [N]
  double fall = 0;                // from there to the local minimum [N]
  double minimum_after_rail = 0;  // time of that minimum less that of the key's contact with the rail [s]
};
LetOffPattern let_off_pattern(const PlayedStroke& stroke);

/// Oscillation on the front rail between two times [s], by the maxima of the key's position that stand out by 5 um.
struct RailOscillation {
  double frequency = 0;    // of the mean interval between maxima; 0 with fewer than two [Hz]
  double mean_force = 0;   // [N]
  double compression = 0;  // of the rail's felt, mean [m]
};
RailOscillation rail_oscillation(const ActionFile& action, const PlayedStroke& stroke, double from, double until);

/// The events that the thesis marks, by its letters; (a) is the rest.                thesis 6.2.2
struct MarkedEvent {
  const char* letter;
  EventKind kind;
  const char* what;
};
inline constexpr std::array kMarked{MarkedEvent{"b", EventKind::jack_meets_let_off, "jack meets the let-off button"},
                                    MarkedEvent{"c", EventKind::key_meets_front_rail, "key meets the front rail"},
                                    MarkedEvent{"d", EventKind::hammer_meets_string, "hammer meets the string"},
                                    MarkedEvent{"e", EventKind::hammer_checked, "hammer is caught"},
                                    MarkedEvent{"f", EventKind::jack_returned, "jack is back"}};

/// One action, driven by position, and what its hammer met.
struct StringStroke {
  std::string name;
  ActionFile action;
  PlayedStroke played;
};

/// All that the tables and pictures of one stroke need.
struct StrokeResults {
  DrivenStroke driven;
  // felt; rigid with e = 0, with what the felt gave back, with 1; felt without backcheck, without drop screw
  std::vector<StringStroke> strings;
};
/// Plays one stroke in all these ways. Cost: half a second.
StrokeResults compute_stroke(const StrokeCase& stroke);

/// Draws strokes_*.svg into the folder.
void draw_strokes(const std::filesystem::path& folder, const std::vector<StrokeResults>& results);

Section strokes_section(const Pictures& pictures);

}  // namespace erard::study
