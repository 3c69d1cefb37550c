// The section on published figures: text, tables, picture.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/figure.hpp"
#include "study/published_figures.hpp"
#include "study/repetition_limit.hpp"
#include "study/played_stroke.hpp"

namespace erard::study {
namespace {

constexpr double kMs = 1e3;  // [ms/s], [mm/m]

using Quantity = double (StrokeTimes::*)() const noexcept;
using PublishedBand = Band (*)(Touch, double);

struct PlayedFamily {
  StrokeFamily family;
  std::vector<FamilyPoint> points;
};

constexpr const char* kColours[] = {"#1f5fa8", "#3fa0a0", "#c8501e", "#d89a2b"};  // of the four families
constexpr const char* kRecorded[] = {"piano", "forte", "recorded_medium", "recorded_fast",
                                     "recorded_fast_free_release"};

/// One quantity of the published grands, but for the curve that its own paper does not bear out.
std::vector<Curve> published(std::array<TimingCurve, 2> PublishedGrand::*quantity) {
  std::vector<Curve> curves;
  for (const Touch touch : {Touch::pressed, Touch::struck})
    for (const PublishedGrand& grand : published_grands()) {
      const bool is_struck = touch == Touch::struck, is_first = &grand == published_grands().data();
      if (is_struck && quantity == &PublishedGrand::bottom && grand.name == std::string("Yamaha Disklavier")) continue;
      Curve& curve = curves.emplace_back();
      if (is_first) curve.label = is_struck ? "three grands, struck (2005)" : "three grands, pressed (2005)";
      curve.style = is_struck ? "lines lw 1 dashtype 2 lc rgb '#c8501e'" : "lines lw 1 lc rgb '#1f5fa8'";
      const double from = is_struck ? 0.6 : 0.3, to = is_struck ? 7 : 5;
      for (double v = from; v <= to * 1.001; v *= std::pow(to / from, 1 / 30.)) {
        curve.x.push_back(v);
        curve.y.push_back(kMs * (grand.*quantity)[static_cast<std::size_t>(touch)].at(v));
      }
    }
  return curves;
}

/// The same quantity of the families and of the keystrokes.
std::vector<Curve> ours(const std::vector<PlayedFamily>& played, const std::vector<StrokeTimes>& recorded,
                        Quantity quantity) {
  std::vector<Curve> curves(played.size() + 1);
  for (std::size_t i = 0; i < played.size(); ++i) {
    curves[i].label = played[i].family.name;
    curves[i].style = fmt::format("linespoints lw 1.5 pt {} ps 0.6 lc rgb '{}'", i < 2 ? 7 : 5, kColours[i]);
    for (const FamilyPoint& point : played[i].points) {
      curves[i].x.push_back(point.times.maximum_speed);
      curves[i].y.push_back(kMs * (point.times.*quantity)());
    }
  }
  curves.back().label = "config/keystrokes";
  curves.back().style = "points pt 2 ps 0.9 lw 1.5 lc rgb '#000000'";
  for (const StrokeTimes& times : recorded) {
    curves.back().x.push_back(times.maximum_speed);
    curves.back().y.push_back(kMs * (times.*quantity)());
  }
  return curves;
}

/// Key position of one stroke of each family, hammer at about 2 m/s.
Panel shapes_panel(const ActionFile& action, const std::vector<PlayedFamily>& played) {
  Panel panel;
  panel.title = "the four strokes with the hammer at 2 m/s";
  panel.x = {"time from the finger's touch [ms]", {0, 90}, false};
  panel.y = {"key position [mm]", {0, 11}, false};
  panel.key = "bottom right";
  for (std::size_t i = 0; i < played.size(); ++i) {
    const StrokeFamily& family = played[i].family;
    const auto nearest = std::min_element(
        played[i].points.begin(), played[i].points.end(), [](const FamilyPoint& a, const FamilyPoint& b) {
          return std::abs(a.times.maximum_speed - 2) < std::abs(b.times.maximum_speed - 2);
        });
    const StrokeTrace trace = trace_stroke(action, family.stroke(nearest->strength), family.drive).trace;
    Curve curve{family.name, {}, {}, fmt::format("lines lw 2 lc rgb '{}'", kColours[i])};
    for (std::size_t k = 0; k < trace.time.size() && trace.time[k] < nearest->times.key_bottom + 0.005; k += 4) {
      curve.x.push_back(kMs * (trace.time[k] - nearest->times.finger_key));
      curve.y.push_back(kMs * trace.key[k]);
    }
    panel.curves.push_back(curve);
  }
  return panel;
}

Panel timing_panel(const std::string& title, const Axis& y, std::vector<Curve> theirs, const std::vector<Curve>& own) {
  Panel panel;
  panel.title = title;
  panel.x = {"maximum hammer speed [m/s]", {0.3, 7}, true};
  panel.y = y;
  panel.curves = std::move(theirs);
  panel.curves.insert(panel.curves.end(), own.begin(), own.end());
  return panel;
}

void draw_timing(const Pictures& pictures, const ActionFile& action, const std::vector<PlayedFamily>& played,
                 const std::vector<StrokeTimes>& recorded) {
  std::vector<Curve> bottom = published(&PublishedGrand::bottom);
  Curve& askenfelt = bottom.emplace_back();
  askenfelt.label = "Askenfelt, Jansson 1990";
  askenfelt.style = "points pt 4 ps 1.2 lw 2 lc rgb '#000000'";
  for (const PublishedPoint& point : kAskenfeltBottom) {
    askenfelt.x.push_back(point.hammer_speed);
    askenfelt.y.push_back(kMs * point.time);
  }
  draw(pictures.folder / "published_timing.svg",
       {timing_panel("finger meets key to hammer meets string", {"travel time [ms]", {10, 300}, true},
                     published(&PublishedGrand::travel), ours(played, recorded, &StrokeTimes::travel)),
        timing_panel("key bottom after hammer meets string", {"[ms]", {-6, 30}}, bottom,
                     ours(played, recorded, &StrokeTimes::bottom)),
        timing_panel("hammer free, before the string", {"[ms]", {0.2, 60}, true}, published(&PublishedGrand::flight),
                     ours(played, recorded, &StrokeTimes::flight)),
        shapes_panel(action, played)},
       2, 560, 420);
}

std::string timing_table(const std::vector<PlayedFamily>& played, Quantity quantity, PublishedBand published) {
  std::vector<std::string> head{"hammer [m/s]", "three grands, pressed", "three grands, struck"};
  for (const PlayedFamily& p : played) head.push_back(p.family.name);
  std::vector<std::vector<std::string>> rows;
  for (const double speed : {0.5, 1.0, 2.0, 4.0}) {
    const Band pressed = published(Touch::pressed, speed), struck = published(Touch::struck, speed);
    std::vector<std::string> row{
        fmt::format("{:.1f}", speed), fmt::format("{:.1f} .. {:.1f}", kMs * pressed.low, kMs * pressed.high),
        speed < 0.6 ? "" : fmt::format("{:.1f} .. {:.1f}", kMs * struck.low, kMs * struck.high)};
    for (const PlayedFamily& p : played) row.push_back(milliseconds(at_speed(p.points, speed, quantity)));
    rows.push_back(row);
  }
  return table(head, rows);
}

/// Travel times against the nearer edge of the published band, 1 m/s and above: from .. to [%].
std::string distance_of_travel(const PlayedFamily& played) {
  double least = 1, greatest = -1;
  for (const FamilyPoint& point : played.points) {
    const double speed = point.times.maximum_speed;
    const Band band = published_travel(played.family.touch, speed);
    if (speed < 1) continue;
    const double time = point.times.travel();
    const double distance = time < band.low ? time / band.low - 1 : time > band.high ? time / band.high - 1 : 0;
    least = std::min(least, distance);
    greatest = std::max(greatest, distance);
  }
  return fmt::format("{:+.0f} to {:+.0f} %", 100 * least, 100 * greatest);
}

struct RepetitionCase {
  std::string what;
  RepetitionLimit limit;
};

std::vector<RepetitionCase> repetition_cases() {
  ActionOptions damper, soft;
  damper.damper = true;
  soft.settings = {{"kappa_LW", 0.1171 / 2}};
  const ActionFile nominal = default_action();
  return {{"finger lifted 2 mm above the key", find_repetition_limit(nominal, {-2e-3})},
          {"the same, with the damper", find_repetition_limit(default_action(damper), {-2e-3})},
          {"the same, spring of the lever halved", find_repetition_limit(default_action(soft), {-2e-3})},
          {"finger to the key's rest", find_repetition_limit(nominal, {0})},
          {"finger to 4 mm below it", find_repetition_limit(nominal, {4e-3})}};
}

constexpr const char kOpening[] =
    R"(Where this action lies among measured grands; nothing in it was fitted to them. From 1 m/s up its travel times
lie {} (pressed by a force), {} (pressed by a motion), {} (struck) and {} (struck and pressed) from the nearer edge of
what three grands do; a steady force takes longer at soft levels. Key bottom comes within a few milliseconds of
theirs, but for strokes that are struck and not followed up; the hammer flies freely for longer. The action repeats
up to {:.1f} times a second when the finger leaves the key and {:.1f} when it turns 4 mm below rest. Makers write 14
and about 15, and a roll of Rachmaninov's op. 17 asks for 12 to 13.

![Travel time, key bottom and free flight against hammer speed; the four strokes]({link}/published_timing.svg)

Curves: W. Goebl, R. Bresin, A. Galembo, J. Acoust. Soc. Am. 118(2), 1154 (2005), power curves through 2300 tones on
a Steinway C, a Yamaha Disklavier and a Boesendorfer SE290, as notes on the paper quote them. Key bottom of the
Yamaha, struck, is left out of the picture because that curve contradicts the zero crossings that the paper names.
Squares: A. Askenfelt, E. Jansson, J. Acoust. Soc. Am. 88(1), 52 (1990).
)";

constexpr const char kDefinitions[] = R"(
Strokes, and the range of what varies:
{}
Definitions: the finger meets the key when that has moved by 0.01 mm (with 0.1 mm travel times at 2 m/s are {:.1f}
ms shorter pressed by a motion, {:.1f} ms struck); hammer and string meet at the first force between them; key
bottom is the first force of the front rail punching, or "braked" where the key has lost half its speed in it,
{:.1f} to {:.1f} ms later; the hammer is free from its greatest speed on, or from its release by the jack
("released"). The abscissa is the hammer's greatest speed, as in the paper.
)";

constexpr const char kComment[] = R"(
- **Exponents** of travel time against hammer speed, 1 to 5 m/s: {:.2f} (pressed by a force), {:.2f} (by a motion),
  {:.2f} (struck), {:.2f} (struck and pressed). With rigid levers and strokes of one shape it would be -1. The
  grands have -0.56 to -0.71 pressed, -0.73 to -0.77 struck: a family here keeps its shape at all strengths, a
  pianist need not.
- **Pressed softly.** Below 0.7 m/s the steady force comes so close to the touch weight of 0.54 N that the time
  grows beyond all bounds, and under 1.2 N the key does not pass the let-off, so there is no key bottom: soft tones
  are guided, not left to a steady force.
- **Struck.** A key thrown into motion throws the hammer ahead. At 1 m/s it is fastest {:.0f} ms before the string,
  half of its way, and slows down from there; and as the finger does not hurry after it, the key comes late. On
  grands a struck key halts at a third of its way because the shank bends and swings back (Askenfelt and Jansson);
  here the shank is rigid and the finger so heavy that nothing slows it. The finger that follows up comes nearer in
  key bottom and flight.
- **Free flight** at 4 m/s: the jack lets go {:.1f} mm before the string (pressed by a motion), {:.1f} mm in the
  piano stroke, and the hammer stays 1.9 mm away in a slow press. The faster the stroke, the more the hammer lags
  behind the key by what the felts yield, and let-off is where the key is. Felts are the thesis's; the let-off's
  geometry is reconstructed.
- **Keystrokes** of `config/keystrokes` (crosses): piano and forte among the pressed, the two fast recorded ones
  among the struck. The recorded medium stroke takes longer than all: of recordings the first 0.5 mm, and so the
  beginning, is uncertain by some milliseconds, and what was measured was the key, not the finger.
)";

constexpr const char kRepetitionText[] = R"(
The piston swings as a raised cosine between 11.2 mm and where the line says; ten strokes from rest; a stroke counts
when the hammer meets the string in its period with 0.18 m/s, the softest tone of the 2005 measurements. The rate
goes up from 8 Hz by 0.5 Hz until a stroke stays silent, then the step is halved five times. It is a limit of this
stroke: single rates above it work again, and another stroke has another. "Jack late": silent strokes just beyond
the limit for which the jack was not yet back under the knuckle when the key came down.

When the finger leaves the key, the hammer falls {:.0f} mm past its rest at the limit, and at 16 Hz it slips past
jack and lever and is lost, {:.0f} mm from the string: the thesis's action has no rail under the shanks, a grand
has.
)";

}  // namespace

Section published_figures_section(const Pictures& pictures) {
  const ActionFile action = default_action();
  std::vector<PlayedFamily> played;
  for (const StrokeFamily& family : stroke_families()) played.push_back({family, play_family(action, family)});
  std::vector<StrokeTimes> recorded;
  for (const char* name : kRecorded) {
    const Keystroke keystroke = default_keystroke(name);
    const TracedStroke stroke = trace_stroke(action, keystroke, DriveKind::piston);
    recorded.push_back(time_stroke(stroke.trace, stroke.events));
  }
  draw_timing(pictures, action, played, recorded);
  const std::vector<RepetitionCase> repetition = repetition_cases();

  std::string text = fmt::format(kOpening, distance_of_travel(played[0]), distance_of_travel(played[1]),
                                 distance_of_travel(played[2]), distance_of_travel(played[3]), repetition[0].limit.rate,
                                 repetition.back().limit.rate, fmt::arg("link", pictures.link));
  std::string shapes;
  double least = 1, greatest = 0;
  for (const PlayedFamily& p : played) {
    shapes += fmt::format("- {}: {}, {:.3g} to {:.3g}\n", p.family.name, p.family.what, p.family.strengths.front(),
                          p.family.strengths.back());
    for (const FamilyPoint& point : p.points)
      if (const double later = point.times.key_braked - point.times.key_bottom; !std::isnan(later)) {
        least = std::min(least, later);
        greatest = std::max(greatest, later);
      }
  }
  const auto later_start = [&](std::size_t family) {
    const auto late = play_family(action, played[family].family, 1e-4);
    return at_speed(played[family].points, 2, &StrokeTimes::travel) - at_speed(late, 2, &StrokeTimes::travel);
  };
  text += fmt::format(kDefinitions, shapes, kMs * later_start(1), kMs * later_start(2), kMs * least, kMs * greatest);

  text += "\n### Travel time [ms]\n" + timing_table(played, &StrokeTimes::travel, published_travel);
  text += "\n### Key bottom after hammer meets string [ms]\n" +
          timing_table(played, &StrokeTimes::bottom, published_bottom);
  text += "\nThe same, key braked\n\n" + timing_table(played, &StrokeTimes::braked, published_bottom);
  text += "\n### Free flight [ms]\n" + timing_table(played, &StrokeTimes::flight, published_flight);
  text += "\nThe same, released by the jack\n\n" + timing_table(played, &StrokeTimes::release, published_flight);
  text += fmt::format(kComment, travel_exponent(played[0].points), travel_exponent(played[1].points),
                      travel_exponent(played[2].points), travel_exponent(played[3].points),
                      kMs * at_speed(played[2].points, 1, &StrokeTimes::flight),
                      kMs * at_speed(played[1].points, 4, &StrokeTimes::free_hammer_way), kMs * recorded[0].free_way);

  std::vector<std::vector<std::string>> rows;
  for (const auto& [what, limit] : repetition)
    rows.push_back({what, fmt::format("{:.1f}", limit.rate), fmt::format("{:.0f}", kMs / limit.rate),
                    fmt::format("{:.0f}", kMs * limit.at.farthest),
                    fmt::format("{} of {}", limit.failing.late_jack, kRepeatedStrokes - limit.failing.sounding)});
  text += "\n### Repetition\n" +
          table({"piston", "limit [Hz]", "period [ms]", "hammer from string at most [mm]", "jack late"}, rows);
  constexpr double kBlow = 0.046;  // hammer from string at rest [m]
  text += fmt::format(kRepetitionText, kMs * (repetition[0].limit.at.farthest - kBlow),
                      kMs * play_repeated(action, {-2e-3}, 16, kRepeatedStrokes).farthest);
  const std::string result = fmt::format(
      "travel times {} (pressed by a motion) and {} (struck) from those of three grands; repeats {:.1f} times a second",
      distance_of_travel(played[1]), distance_of_travel(played[2]), repetition[0].limit.rate);
  return {"Beside published measurements of grands", result, text, {}};
}

}  // namespace erard::study
