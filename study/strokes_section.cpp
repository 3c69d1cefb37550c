// Tables of the study "strokes".
#include <fmt/format.h>

#include "study/strokes.hpp"

namespace erard::study {
namespace {

using Rows = std::vector<std::vector<std::string>>;

const Event& first(const StrokeResults& r, EventKind kind) { return r.driven.by_position.event(kind); }
double escapement_speed(const StrokeResults& r) { return first(r, EventKind::escapement).hammer_speed; }

/// From 0.14 to 0.20 s in piano, from 0.08 to 0.12 s in forte                        thesis 6.4.1
RailOscillation thesis_oscillation(const StrokeResults& r) {
  const bool is_piano = r.driven.stroke.release == kPiano.release;
  return rail_oscillation(r.strings[0].action, r.driven.by_position, is_piano ? 0.14 : 0.08, is_piano ? 0.20 : 0.12);
}

/// Where Y begins to go back [s].
double release_of(const StrokeResults& r) {
  const auto& row = r.driven.by_position.row;
  return std::max_element(row.begin(), row.end(),
                          [](const Snapshot& a, const Snapshot& b) { return a.input.value < b.input.value; })
      ->time;
}

std::string event_table(const std::vector<StrokeResults>& results) {
  Rows rows;
  for (const StrokeResults& r : results) {
    const PlayedStroke& stroke = r.driven.by_position;
    for (const Event& event : stroke.result.events) {
      std::string name = event.kind == EventKind::escapement ? "escapement" : "";
      for (const MarkedEvent& marked : kMarked)
        if (marked.kind == event.kind) name = fmt::format("({}) {}", marked.letter, marked.what);
      if (!name.empty())
        rows.push_back({r.driven.stroke.name, name, milliseconds(event.time), fixed(1e3 * event.key_position, 2),
                        fixed(event.force, 2), fixed(event.hammer_speed, 3)});
    }
  }
  return table({"stroke", "event", "time ms", "key mm", "force N", "hammer m/s"}, rows);
}

/// Every number printed for the figures of the two strokes. (Those of (6.1), (6.2): thesis_tables.)
std::vector<Recomputed> recompute_strokes(const StrokeResults& piano, const StrokeResults& forte) {
  const RailOscillation p = thesis_oscillation(piano), f = thesis_oscillation(forte);
  constexpr const char* kPlayer =
      "no player's hand on the key: (6.2), which leaves it out as well, gives what is found here, and 6.4.1 explains "
      "its lower measured frequencies by the hand";
  constexpr const char* kStroke = "another stroke: Y is reconstructed";
  constexpr const char* kWedge =
      "the thesis lets the rail carry all of the finger's force; here the action on the capstan and the caught hammer "
      "on the backcheck carry part of it";
  const auto rail_mm = [](const StrokeResults& r) {
    return 1e3 * first(r, EventKind::key_meets_front_rail).key_position;
  };
  return {
      {"escapement speed, piano, measured [m/s]", 1.01, escapement_speed(piano), ""},
      {"the same, simulated [m/s]", 1.00, escapement_speed(piano), ""},
      {"escapement speed, forte, measured and simulated [m/s]", 1.56, escapement_speed(forte), ""},
      {"key meets the front rail, piano [mm]", 9.8, rail_mm(piano), ""},
      {"key meets the front rail, forte [mm]", 9.8, rail_mm(forte), ""},
      {"force that the piano stroke reaches (here before the let-off), \"about\" [N]", 2,
       hardest_push(piano.driven.by_position).force, kStroke},
      {"force that the forte stroke reaches, \"about\" [N]", 10, forte.driven.by_position.result.peak_force, kStroke},
      {"force on the rail, piano [N]", 3.5, p.mean_force, kStroke},
      {"force on the rail, forte [N]", 9, f.mean_force, kStroke},
      {"compression of the rail's felt, piano [mm]", 0.26, 1e3 * p.compression, kWedge},
      {"compression of the rail's felt, forte [mm]", 0.38, 1e3 * f.compression, kWedge},
      {"oscillation on the rail, piano, measured [Hz]", 70, p.frequency, kPlayer},
      {"oscillation on the rail, forte, measured [Hz]", 90, f.frequency, kPlayer},
      {"release, piano [s]", 0.22, release_of(piano), kStroke},
      {"release, forte [s]", 0.13, release_of(forte), kStroke}};
}

std::string replay_table(const std::vector<StrokeResults>& results) {
  Rows rows;
  for (const StrokeResults& r : results)
    for (const bool is_all : {false, true}) {
      const DrivenStroke& d = r.driven;
      const double end = is_all ? d.by_position.row.back().time : first(r, EventKind::hammer_checked).time;
      const auto hammer = static_cast<std::size_t>(r.strings[0].action.roles.hammer);
      rows.push_back({d.stroke.name, is_all ? "whole" : "to the check",
                      fmt::format("{:.1e}", relative_error(d.by_position, d.by_force, end, key_position)),
                      fmt::format("{:.1e}", largest_difference(d.by_position, d.by_force, end, key_position)),
                      fmt::format("{:.1e}", largest_difference(d.by_position, d.by_force, end,
                                                               [&](const Snapshot& s) { return s.angle[hammer]; }))});
    }
  return table({"stroke", "window", "key: eta", "key: largest m", "hammer: largest rad"}, rows);
}

std::string string_table(const std::vector<StrokeResults>& results) {
  Rows rows;
  for (const StrokeResults& r : results)
    for (const StringStroke& s : r.strings) {
      const Impact impact = impact_of(s.action, s.played);
      const Event* check = s.played.find(EventKind::hammer_checked);
      const double release = r.driven.stroke.release;
      const double gap = -s.played.at(release).compression[static_cast<std::size_t>(s.action.roles.string)];
      rows.push_back({r.driven.stroke.name, s.name, fixed(impact.before, 3), fixed(impact.after, 3),
                      fixed(impact.share(), 3), check == nullptr ? "never" : milliseconds(check->time),
                      fixed(1e3 * gap, 1), fixed(peak_after_impact(s.played, release), 2)});
    }
  return table({"stroke", "string or change", "to the string m/s", "back m/s", "share", "caught ms",
                "then from the string mm", "largest force after the blow N"},
               rows);
}

/// How far the key driven by force goes from the key driven by position before the check [m].
double replay_distance(const std::vector<StrokeResults>& results) {
  double largest = 0;
  for (const StrokeResults& r : results)
    largest = std::max(largest, largest_difference(r.driven.by_position, r.driven.by_force,
                                                   first(r, EventKind::hammer_checked).time, key_position));
  return largest;
}

std::string summary(const std::vector<StrokeResults>& results) {
  return fmt::format(
      "Driven by position, piano and forte give all events of 6.2.2, escapement at {:.2f} and {:.2f} m/s (thesis "
      "1.00\n"
      "and 1.56, Table 6.1) and the pattern of the let-off in the force. Driven by the force that it took, each stroke "
      "is\n"
      "the same motion again: up to the check the key is within {:.0e} m. The thesis's measured Y and F are not "
      "published;\n"
      "both keystrokes are reconstructions, so times and forces are those of other strokes than the printed ones.\n\n",
      escapement_speed(results[0]), escapement_speed(results[1]), replay_distance(results));
}

std::string force_notes(const StrokeResults& piano, const StrokeResults& forte) {
  const LetOffPattern p = let_off_pattern(piano.driven.by_position), f = let_off_pattern(forte.driven.by_position);
  return fmt::format(
      "- After (b) the force rises by {:.2f} N (piano) and {:.2f} N (forte) and falls by {:.2f} and {:.2f} N: the "
      "small hump\n"
      "  and the sharp decrease that 6.4.1 finds in every stroke.\n"
      "- (c) shows as the local minimum, as in the thesis: that comes {:.1f} and {:.1f} ms after the contact (its "
      "piano "
      "simulation is\n"
      "  off by about five).\n"
      "- In piano the hammer is at the string before the key is on the rail, in forte after it.\n\n",
      p.hump, f.hump, p.fall, f.fall, 1e3 * p.minimum_after_rail, 1e3 * f.minimum_after_rail);
}

std::string string_notes(const StrokeResults& piano, const StrokeResults& forte) {
  const auto peak = [](const StrokeResults& r, std::size_t i) {
    return fixed(peak_after_impact(r.strings[i].played, r.driven.stroke.release), 1);
  };
  return fmt::format(
      "**The string** (6.2.2). What is felt before the blow does not depend on it. With the inelastic string the "
      "hammer is\n"
      "not caught at all, where the thesis has it caught too late. A rigid string that gives back the share that the "
      "felt\n"
      "gave back has it caught a little early, since the blow takes no time, and more comes back to the finger: up to "
      "{} N\n"
      "(piano) and {} N (forte) instead of {} and {} N; a fully elastic one {} and {} N. The thesis, too, saw the "
      "force of\n"
      "the check too high with its elastic law, whose e it does not print. That the force rises at the check without "
      "the\n"
      "backcheck as well is confirmed; it also does without the drop screw, which 6.4.1 holds responsible: here it is "
      "the\n"
      "finger that presses on into the rail.\n\n",
      peak(piano, 2), peak(forte, 2), peak(piano, 0), peak(forte, 0), peak(piano, 3), peak(forte, 3));
}

}  // namespace

Section strokes_section(const Pictures& pictures) {
  const std::vector<StrokeResults> results{compute_stroke(kPiano), compute_stroke(kForte)};
  draw_strokes(pictures.folder, results);
  const auto picture = [&](const std::string& what, const std::string& name) {
    return fmt::format("![{}]({}/strokes_{}.svg)\n\n", what, pictures.link, name);
  };
  std::string text = summary(results);
  text += picture("Piston, key and force of both strokes, events marked", "force");
  text += event_table(results) + "\n" + force_notes(results[0], results[1]);
  const std::vector<Recomputed> printed = recompute_strokes(results[0], results[1]);
  const std::vector<Contradiction> contradicted = contradictions_of(printed);
  text += "**Every number printed for these figures**: met within 2 %, and not.\n\n";
  text += table_of_confirmed(printed) + "\n" + table(contradicted) + "\n";
  text +=
      "**All bodies** (Figure 6.4), with the felt string and with the inelastic one of the thesis's red curves:\n\n";
  text +=
      picture("Angles of all bodies, piano", "bodies_piano") + picture("Angles of all bodies, forte", "bodies_forte");
  text +=
      "**Poses at the events** (Figure 6.5); arrows are forces, felts are drawn five times as deep as they are "
      "pressed:\n\n";
  text += picture("The action at rest and at the events, piano", "poses_piano") +
          picture("The action at rest and at the events, forte", "poses_forte");
  text += "**Driven by force** (Figures 6.7, 6.8), replaying the force of each internal step:\n\n";
  text += picture("Key driven by position and by the force of that run", "replay") + replay_table(results) + "\n";
  text += string_notes(results[0], results[1]) + picture("Hammer and force with three strings", "strings") +
          string_table(results);
  const std::string result = fmt::format(
      "all events of 6.2.2 in their order; escapement at {:.2f} and {:.2f} m/s (thesis 1.00 and 1.56); the "
      "force that was felt gives the motion back within {:.0e} m up to the check",
      escapement_speed(results[0]), escapement_speed(results[1]), replay_distance(results));
  return {"Two strokes (Figures 6.2 to 6.5, 6.7 to 6.9)", result, text, contradicted};
}

}  // namespace erard::study
