#include "study/without_felts.hpp"

#include <fmt/format.h>

#include <array>

#include "study/figure.hpp"
#include "study/rigid_contact.hpp"
#include "study/thesis_numbers.hpp"

namespace erard::study {
namespace {

constexpr std::array kWays{Felts::out, Felts::out_reset, Felts::knuckle_kept};
constexpr double kSettled = 0.005;  // [s] what overlaps at the start has moved apart, the finger has not pressed yet

double gap(const Model& model, const Snapshot& row, const char* contact) {
  return -row.compression[static_cast<std::size_t>(find_contact(model, contact))];
}

std::string millimetres(double length, int digits = 2) {
  return fmt::format("{:.{}f}", std::abs(length) < 5e-8 ? 0.0 : 1e3 * length, digits);
}
std::string limits(long reached, long steps) { return fmt::format("{} of {}", reached, steps); }

/// How much later the jack meets the let-off button than with felts [s].
double delay(const FeltlessComparison& c, const FeltlessStroke& s) {
  return s.by_force.event(EventKind::jack_meets_let_off).time - c.full.event(EventKind::jack_meets_let_off).time;
}

std::string key_table(const std::vector<FeltlessComparison>& comparisons) {
  std::vector<std::vector<std::string>> rows;
  for (const FeltlessComparison& c : comparisons)
    for (const FeltlessStroke& s : c.without)
      rows.push_back({c.stroke.name, name_of(s.felts), percent(s.error.key), percent(s.descent.key),
                      millimetres(largest_difference(c.full, s.by_force, c.stroke.release, key_position)),
                      fmt::format("{:.1f}", 1e3 * delay(c, s)),
                      fmt::format("{:.3f} ({:.3f})", s.by_force.event(EventKind::hammer_meets_string).hammer_speed,
                                  c.full.event(EventKind::hammer_meets_string).hammer_speed),
                      limits(s.by_force.result.not_converged, s.by_force.result.steps)});
  return table({"driven by force", "felts", "key: eta %", "up to the let-off", "largest mm", "let-off later by ms",
                "hammer at the string m/s (with felts)", "steps not converged"},
               rows);
}

std::string force_table(const std::vector<FeltlessComparison>& comparisons) {
  std::vector<std::vector<std::string>> rows;
  for (const FeltlessComparison& c : comparisons)
    for (const FeltlessStroke& s : c.without)
      rows.push_back({c.stroke.name, name_of(s.felts), percent(s.error.force), percent(s.descent.force),
                      fmt::format("{:.1f} ({:.1f})", s.by_position.result.peak_force, c.full.result.peak_force),
                      fmt::format("{:.1f}", s.error.force / s.error.key),
                      limits(s.by_position.result.not_converged, s.by_position.result.steps)});
  return table({"driven by position", "felts", "force: eta %", "up to the let-off", "peak N (with felts)",
                "eta of the force over eta of the key", "steps not converged"},
               rows);
}

std::string regulation_table(const FeltlessComparison& comparison) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const char* name, const ActionFile& action, const PlayedStroke& stroke) {
    const Snapshot& row = stroke.at(kSettled);
    rows.push_back({name, millimetres(row.key_position, 3), millimetres(gap(action.model, row, "HG")),
                    millimetres(gap(action.model, row, "JH"), 3), millimetres(gap(action.model, row, "LH"), 3)});
  };
  add("with felts", default_action(), comparison.full);
  for (const FeltlessStroke& s : comparison.without) add(name_of(s.felts), action_without(s.felts), s.by_position);
  return table({fmt::format("after {:.0f} ms", 1e3 * kSettled), "key mm", "blow mm", "jack below the knuckle mm",
                "lever below the knuckle mm"},
               rows);
}

std::string rail_table(const std::vector<FeltlessComparison>& comparisons) {
  std::vector<std::vector<std::string>> rows;
  for (const FeltlessComparison& c : comparisons) {
    const auto add = [&](const char* felts, const PlayedStroke& by_force, const PlayedStroke& by_position) {
      const auto swing = [&](const PlayedStroke& stroke, const auto& quantity) {
        return swing_on_rail(stroke, c.stroke.release, quantity);
      };
      rows.push_back({c.stroke.name, felts, millimetres(swing(by_force, key_position), 3),
                      millimetres(swing(by_position, key_position), 3),
                      fmt::format("{:.2f}", swing(by_position, finger_force))});
    };
    add("in", c.full_by_force, c.full);
    for (const FeltlessStroke& s : c.without) add(name_of(s.felts), s.by_force, s.by_position);
  }
  return table({"on the rail", "felts", "key, driven by force: highest less lowest mm", "key, driven by position mm",
                "force, driven by position N"},
               rows);
}

void draw_curves(const std::filesystem::path& svg, const std::vector<FeltlessComparison>& comparisons) {
  constexpr std::array kStyles{"lines lw 1.6 lc rgb '#999999'", "lines lw 1.2 lc rgb '#0072b2'",
                               "lines lw 1.2 dashtype 2 lc rgb '#009e73'"};
  std::vector<Panel> panels;
  for (const bool is_key : {true, false})
    for (const FeltlessComparison& c : comparisons) {
      Panel panel;
      panel.title = fmt::format("{}, driven by {}", c.stroke.name, is_key ? "force" : "position");
      panel.x = {"time [ms]", {0, 1e3 * c.stroke.release}};
      panel.y = {is_key ? "key down [mm]" : "force on the finger [N]",
                 {0, is_key ? 11 : 4.5 * c.full.result.peak_force}};
      panel.key = is_key ? "bottom right" : "off";
      const auto add = [&](const std::string& label, const PlayedStroke& stroke, const char* style) {
        const Points p = is_key ? points_of(stroke, c.stroke.release, key_position, 1e3, 16)
                                : points_of(stroke, c.stroke.release, finger_force, 1.0, 4);
        panel.curves.push_back({"felts " + label, p.x, p.y, style});
      };
      // the full action on top of the others
      for (const FeltlessStroke& s : c.without)
        add(name_of(s.felts), is_key ? s.by_force : s.by_position, kStyles[static_cast<std::size_t>(s.felts)]);
      add("in", c.full, "lines lw 1.6 lc rgb '#d55e00'");
      panels.push_back(panel);
    }
  draw(svg, panels, 2, 640, 380);
}

std::string summary(const FeltlessComparison& piano, const FeltlessComparison& forte) {
  const FeltlessStroke& p = piano.of(Felts::out);
  const FeltlessStroke& f = forte.of(Felts::out);
  return fmt::format(
      "All felts replaced by rigid surfaces, friction kept (thesis 6.4.2). Driven by position, the force is off by {} "
      "%\n"
      "(piano) and {} % (forte); driven by the force that the full action took, the key is off by {} and {} %, {:.1f} "
      "and\n"
      "{:.1f} times less: that a model must be judged by the force is confirmed. The \"very little difference\" of "
      "the\n"
      "displacements is not: the let-off is {:.1f} and {:.1f} ms late, and up to the let-off alone, without the "
      "stretch on\n"
      "the front rail where every model lies still, the key is off by {} and {} %, the force by {} and {} %.\n",
      percent(p.error.force), percent(f.error.force), percent(p.error.key), percent(f.error.key),
      p.error.force / p.error.key, f.error.force / f.error.key, 1e3 * delay(piano, p), 1e3 * delay(forte, f),
      percent(p.descent.key), percent(f.descent.key), percent(p.descent.force), percent(f.descent.force));
}

std::string rest_note(const FeltlessComparison& piano) {
  const Snapshot& rest = piano.full.row.front();
  double least = INFINITY, most = 0;
  for (std::size_t c = 0; c < rest.compression.size(); ++c) {
    if (rest.normal[c] <= 0) continue;
    least = std::min(least, rest.compression[c]);
    most = std::max(most, rest.compression[c]);
  }
  return fmt::format(
      "Errors are (6.3) against the action with felts, up to the release of thesis 6.4.1 (0.22 and 0.13 s).\n\n"
      "**The rest moves.** The file's rest angles press felts by {} to {} mm; surfaces that are rigid in the felts'\n"
      "place push each other apart: nothing overlaps by more than 1 um from {:.1f} ms on. The key sinks, the hammer "
      "rises\n"
      "off the lever and on to the jack, the blow shortens. \"Surfaces reset\" sets each surface back by what its felt "
      "gave\n"
      "at rest, as regulation would.\n\n",
      millimetres(least), millimetres(most), 1e3 * end_of_overlap(piano.of(Felts::out).by_position));
}

std::string lead_note(const FeltlessComparison& piano, const FeltlessComparison& forte) {
  // L l21 / (l12 l23) of thesis Table 2.1: travel of the key for a travel at the knuckle
  constexpr double kKeyPerKnuckle = thesis::kArm * thesis::kL21 / (thesis::kL12 * thesis::kL23);
  const Snapshot& push = hardest_push(piano.full);
  const double depth = -gap(default_action().model, push, "JH");
  return fmt::format(
      "**Why the key moves differently.** Felts give before the hammer does, so with them the key is ahead. At the "
      "largest\n"
      "force of the piano descent ({:.2f} N at {:.0f} ms) the knuckle's leather is {} mm deep; times {:.2f}, the key's "
      "travel\n"
      "for that of the knuckle (L l21 / (l12 l23), Table 2.1), that is {} mm of key. With this one felt kept the key "
      "is off\n"
      "by {} % (piano) and {} % (forte).\n\n",
      push.force, 1e3 * push.time, millimetres(depth), kKeyPerKnuckle, millimetres(kKeyPerKnuckle * depth),
      percent(piano.of(Felts::knuckle_kept).error.key), percent(forte.of(Felts::knuckle_kept).error.key));
}

std::string rail_note() {
  return fmt::format(
      "**On the front rail**, from {:.0f} ms after it was met to the release, the key driven by force lies still "
      "without\n"
      "felts and swings with them: the oscillations of 6.4.1 are those of the felt, as the thesis concludes. Driven "
      "by\n"
      "position, the thesis sees none in the force either; here the force swings more. The reconstructed Y holds the "
      "recoil\n"
      "of a finger from a rail with felt, and the finger's spring and damper turn it into force against a key that "
      "cannot\n"
      "give.\n\n",
      1e3 * kFirstRebound);
}

}  // namespace

const char* name_of(Felts felts) {
  return felts == Felts::out         ? "out"
         : felts == Felts::out_reset ? "out, surfaces reset"
                                     : "out but for the knuckle's, reset";
}

ActionFile action_without(Felts felts) {
  if (felts == Felts::out) {
    ActionOptions options;
    options.felts = FeltModel::rigid;
    return default_action(options);
  }
  ActionFile action = default_action();
  Model& model = action.model;
  const Snapshot rest = play(action, default_keystroke(kPiano.name), study_tick(DriveKind::none), 0).row.front();
  for (int c = 0; c < model.contact_count; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (felts == Felts::knuckle_kept && c == action.roles.escapement) continue;
    if (!model.contacts[i].has_felt) continue;
    remove_felt(model, c);
    if (rest.normal[i] > 0) set_back(model, c, rest.compression[i]);
  }
  return action;
}

FeltlessComparison compare_felts(const StrokeCase& stroke) {
  const Keystroke piston = default_keystroke(stroke.name);
  const double end = stroke.release;
  FeltlessComparison c;
  c.stroke = stroke;
  c.full = play(default_action(), piston, study_tick(DriveKind::piston), end);
  const Keystroke force = force_of(c.full);
  c.full_by_force = play(default_action(), force, study_tick(DriveKind::force), end);
  for (const Felts felts : kWays) {
    const ActionFile action = action_without(felts);
    FeltlessStroke s;
    s.felts = felts;
    s.by_force = play(action, force, study_tick(DriveKind::force), end);
    s.by_position = play(action, piston, study_tick(DriveKind::piston), end);
    const auto errors = [&](double until) {
      return FeltlessErrors{relative_error(c.full, s.by_force, until, key_position),
                            relative_error(c.full, s.by_position, until, finger_force)};
    };
    s.error = errors(end);
    s.descent = errors(c.full.event(EventKind::jack_meets_let_off).time);
    c.without.push_back(std::move(s));
  }
  return c;
}

double end_of_overlap(const PlayedStroke& stroke) {
  constexpr double kNothing = 1e-6;  // [m] a hundredth of what the felts give at rest
  double end = stroke.row.front().time;
  for (const Snapshot& row : stroke.row)
    if (row.time <= kSettled && *std::max_element(row.compression.begin(), row.compression.end()) > kNothing)
      end = row.time + kStudyStep;
  return end;
}

Section without_felts_section(const Pictures& pictures) {
  const std::vector<FeltlessComparison> both{compare_felts(kPiano), compare_felts(kForte)};
  draw_curves(pictures.folder / "without_felts.svg", both);
  const FeltlessComparison& piano = both[0];
  const FeltlessComparison& forte = both[1];
  const FeltlessStroke &p = piano.of(Felts::out), &f = forte.of(Felts::out);
  const std::string result =
      fmt::format("rigid surfaces for felts: the force is off by {} / {} % (piano / forte), the key by {} / {} %",
                  percent(p.error.force), percent(f.error.force), percent(p.error.key), percent(f.error.key));
  return {"Without felts (Figures 6.11, 6.12)",
          result,
          summary(piano, forte) +
              fmt::format("\n![Key driven by force above, force driven by position below, with and without felts]"
                          "({}/without_felts.svg)\n\n",
                          pictures.link) +
              key_table(both) + "\n" + force_table(both) + "\n" + rest_note(piano) + regulation_table(piano) + "\n" +
              lead_note(piano, forte) + rail_note() + rail_table(both),
          {}};
}

}  // namespace erard::study
