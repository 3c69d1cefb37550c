// The section of docs/validation.md on chapter 2: its picture and its tables.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "study/figure.hpp"
#include "study/simple_models.hpp"
#include "study/simple_models_parts.hpp"
#include "study/thesis_numbers.hpp"

namespace erard::study::simple {
namespace {

constexpr const char* kPicture = "simple_models.svg";

// ---- picture

enum class Quantity { motion, force };

/// Every `stride`-th row up to `end`, in ms and in mm or N.
Curve curve_of(const std::vector<double>& time, const std::vector<double>& values, double scale, double end,
               std::size_t stride) {
  Curve curve;
  for (std::size_t i = 0; i < time.size() && time[i] <= end; i += stride) {
    curve.x.push_back(1e3 * time[i]);
    curve.y.push_back(scale * values[i]);
  }
  return curve;
}

Curve styled(Curve curve, const char* label, const char* style) {
  curve.label = label;
  curve.style = style;
  return curve;
}

Curve upright(double time, std::pair<double, double> range, const char* label, const char* style) {
  return {label, {1e3 * time, 1e3 * time}, {range.first, range.second}, style};
}

Panel panel_of(const Stroke& stroke, const std::vector<SimpleAction>& models, Quantity quantity, double until,
               std::pair<double, double> range) {
  const KeyRecord& record = stroke.record;
  const std::vector<double>& time = record.motion.time;
  const bool is_motion = quantity == Quantity::motion;
  const double scale = is_motion ? 1e3 * models.front().arm : 1;
  const std::size_t stride = is_motion ? 4 : 1;  // a motion is smooth
  Panel panel;
  panel.title = record.name + (is_motion ? ": motion under the force, eta " : ": force under the motion, eta ");
  panel.x = {"time [ms]", {0, 1e3 * until}};
  panel.y = {is_motion ? "key y [mm]" : "finger force [N]", range};
  panel.key = is_motion ? "top left Left reverse" : "off";
  panel.curves.push_back(upright(record.let_off, range, "jack meets let-off", "lines lw 1 dt 3 lc rgb '#555555'"));
  panel.curves.push_back(upright(record.rail, range, "key meets front rail", "lines lw 1 dt 1 lc rgb '#999999'"));
  panel.curves.push_back(styled(curve_of(time, is_motion ? record.motion.angle : record.force, scale, until, stride),
                                "complete action", "lines lw 5 lc rgb '#b8b8b8'"));
  constexpr const char* kLabels[] = {"BH + SK, Table 2.2", "BH + SK, this action"};
  constexpr const char* kStyles[] = {"lines lw 1.5 lc rgb '#0060ad'", "lines lw 1.5 lc rgb '#c00000'"};
  for (std::size_t i = 0; i < models.size(); ++i) {
    const Keystroke force(KeystrokeQuantity::force, time, record.force);
    const Verdict verdict = judge(models[i], record, stroke.carried);
    panel.title += (i > 0 ? " / " : "") + percent((is_motion ? verdict.motion : verdict.force).whole.eta);
    const std::vector<double> values = is_motion ? move(models[i], force, time).angle : feel(models[i], record.motion);
    panel.curves.push_back(styled(curve_of(time, values, scale, until, stride), kLabels[i], kStyles[i]));
  }
  panel.title += " %";
  return panel;
}

void draw_picture(const SimpleModelsStudy& study, const std::filesystem::path& svg) {
  const std::vector<SimpleAction> models{thesis_action(), study.model};
  draw(svg,
       {panel_of(study.piano, models, Quantity::motion, 0.220, {0, 12}),
        panel_of(study.piano, models, Quantity::force, 0.220, {-8, 8}),
        panel_of(study.forte, models, Quantity::motion, 0.142, {0, 12}),
        panel_of(study.forte, models, Quantity::force, 0.142, {-20, 20})},
       2, 560, 380);
}

// ---- tables

std::vector<std::string> phase_row(const std::string& stroke, const std::string& what, const PhaseErrors& errors,
                                   double scale, const char* unit) {
  return {stroke,
          what,
          percent(errors.pick_up.eta),
          percent(errors.carried.eta),
          percent(errors.after.eta),
          "**" + percent(errors.whole.eta) + "**",
          fmt::format("{:.{}f} {}", scale * errors.whole.largest, scale > 1 ? 2 : 1, unit)};
}

std::string phase_table(const SimpleModelsStudy& study) {
  std::vector<std::vector<std::string>> rows;
  for (const Stroke* stroke : {&study.piano, &study.forte})
    for (const auto& [name, model] : {std::pair{"Table 2.2", thesis_action()}, std::pair{"this action", study.model}}) {
      const Verdict verdict = judge(model, stroke->record, stroke->carried);
      const std::string title = stroke->record.name + ", " + name;
      rows.push_back(phase_row(title, "motion under the force", verdict.motion, 1e3, "mm"));
      rows.push_back(phase_row("", "force under the motion", verdict.force, 1, "N"));
    }
  return table({"eta (6.3), %", "", "hammer picked up", "hammer carried", "let-off to release", "whole", "largest"},
               rows);
}

struct Variant {
  std::string name;
  Verdict piano, forte;
};

/// The punching with the losses of its felt alone.
SimpleAction with_felt_damping(SimpleAction model) {
  model.rail.damping = thesis::kFeltDamping;
  return model;
}

std::vector<Variant> variants(const SimpleModelsStudy& study) {
  const auto both = [&study](const std::string& name, const auto& judgement) {
    return Variant{name, judgement(study.piano), judgement(study.forte)};
  };
  const auto chain = [](const SimpleAction& model) {
    return [model](const Stroke& stroke) { return judge(model, stroke.record, stroke.carried); };
  };
  SimpleAction jumping = thesis_action();
  jumping.takeover = Takeover::keeps_velocity;
  const SimpleAction& model = study.model;
  const double down = study.parts.down_force;
  return {both("Table 2.2, weight of the static test", chain(thesis_action())),
          both("Table 2.2, C_w and spring as (2.6) prints them", chain(thesis_action_with_printed_spring())),
          both("Table 2.2, rate kept at the takeover", chain(jumping)),
          both("this action", chain(model)),
          both("this action, b of the punching 5e7 as in (4.10)", chain(with_felt_damping(model))),
          both("this action, SK alone from F_down on",
               [&](const Stroke& stroke) { return judge_alone(model, stroke.record, stroke.carried, down); }),
          both("control: SK alone in place of the complete action", [&](const Stroke& stroke) {
            return judge_alone(model, simple_record(model, stroke.record, down), stroke.carried, down);
          })};
}

std::string variant_table(const SimpleModelsStudy& study) {
  std::vector<std::vector<std::string>> rows;
  for (const Variant& variant : variants(study))
    rows.push_back({variant.name, percent(variant.piano.motion.whole.eta), percent(variant.piano.force.whole.eta),
                    percent(variant.forte.motion.whole.eta), percent(variant.forte.force.whole.eta)});
  return table({"eta to the release, %", "piano: motion", "force", "forte: motion", "force"}, rows);
}

std::string sensitivity_cell(const char* thesis, const SimpleModelsStudy& study, Path path,
                             double Sensitivity::*element) {
  const auto one = [&](const Stroke& stroke, double until) {
    return percent(sensitivity(path, study.model, stroke.record, study.parts.down_force, until).*element);
  };
  const KeyRecord &piano = study.piano.record, &forte = study.forte.record;
  return fmt::format("**{}** {} / {} ({} / {})", thesis, one(study.piano, piano.let_off),
                     one(study.forte, forte.let_off), one(study.piano, piano.release), one(study.forte, forte.release));
}

std::string table_2_3(const SimpleModelsStudy& study) {
  struct Row {
    const char* name;
    double Sensitivity::*element;
    std::array<const char*, 4> thesis;  // in the order of kPaths
  };
  const std::array printed{Row{"model", &Sensitivity::model, {"0", "+", "+", "+"}},
                           Row{"initial conditions", &Sensitivity::initial, {"+", "0", "0", "+"}},
                           Row{"noise", &Sensitivity::noise, {"0", "0", "+", "0"}}};
  std::vector<std::vector<std::string>> rows;
  for (const Row& row : printed) {
    rows.push_back({row.name});
    for (std::size_t i = 0; i < kPaths.size(); ++i)
      rows.back().push_back(sensitivity_cell(row.thesis[i], study, kPaths[i], row.element));
  }
  return table({"", "F -> y", "y'' and y -> F", "y -> F", "y'' -> F"}, rows);
}

std::string summary(const SimpleModelsStudy& study) {
  const SimpleAction table = thesis_action();
  const Verdict p = judge(study.model, study.piano.record, study.piano.carried);
  const Verdict f = judge(study.model, study.forte.record, study.forte.carried);
  const Verdict pt = judge(table, study.piano.record, study.piano.carried);
  const Verdict ft = judge(table, study.forte.record, study.forte.carried);
  const auto ratio = [](const Verdict& verdict) { return verdict.force.whole.eta / verdict.motion.whole.eta; };
  return fmt::format(
      R"(A model of one degree of freedom (blocked hammer, BH, then simplistic key, SK), given the force on the complete
action's key, follows the motion of that key to {} / {} % (piano / forte), at most {:.1f} / {:.1f} mm off; with the
numbers of Table 2.2 to {} / {} %. Given the motion, it misses the force by {} / {} % ({} / {} %), {:.0f} to {:.0f}
times as much. Who compares motions accepts a model that has no let-off; who compares forces does not.
)",
      percent(p.motion.whole.eta), percent(f.motion.whole.eta), 1e3 * p.motion.whole.largest,
      1e3 * f.motion.whole.largest, percent(pt.motion.whole.eta), percent(ft.motion.whole.eta),
      percent(p.force.whole.eta), percent(f.force.whole.eta), percent(pt.force.whole.eta), percent(ft.force.whole.eta),
      std::min({ratio(p), ratio(f), ratio(pt), ratio(ft)}), std::max({ratio(p), ratio(f), ratio(pt), ratio(ft)}));
}

/// Where the key begins to carry the hammer [mm].
double carried_position_mm(const Stroke& stroke, double arm) {
  const KeyMotion& motion = stroke.record.motion;
  std::size_t i = 0;
  while (motion.time[i] < stroke.carried) ++i;
  return 1e3 * arm * motion.angle[i];
}

std::string phase_text(const SimpleModelsStudy& study) {
  return fmt::format(
      R"(
While the key carries the hammer SK is at its best, its force about as far off as that of the thesis's complete
model from the measurement (21 and 13 %, 6.4.1). In the thesis the forces part from the let-off on; here they are
apart before as well, until y = {:.1f} / {:.1f} mm: the spring of the lever and the felt of the knuckle give way
until the hammer has caught up.
)",
      carried_position_mm(study.piano, study.parts.arm), carried_position_mm(study.forte, study.parts.arm));
}

std::string variant_text(const SimpleModelsStudy& study) {
  const InertiaScan piano = scan_inertia(study.model, study.piano.record);
  const InertiaScan forte = scan_inertia(study.model, study.forte.record);
  const SimpleAction thesis = thesis_action(), felt = with_felt_damping(study.model);
  const auto bounce_mm = [&](const Stroke& stroke) {
    return 1e3 * judge(felt, stroke.record, stroke.carried).motion.after.largest;
  };
  return fmt::format(
      R"(
- **Takeover.** The thesis interpolates J(theta) between the two models in J theta''. Over a short way that keeps
  the rate while the inertia grows {:.1f}-fold: momentum from nothing. Here J theta' is kept, which forces inside
  the action cannot change. SK takes over where BH has reached F_down: at y = {:.2f} mm with Table 2.2 (the text
  says about 0.8), {:.2f} mm in this action.
- **Damping.** b = 2e9 of the punching is the one number that the thesis chose "somewhat arbitrarily", for the
  losses in the backcheck. With that of the felt the model's key bounces off the punching, up to {:.1f} / {:.1f} mm
  from the action's.
- **Inertia.** No other would do: from 0.1 to 1.5 J the force is never nearer than {} / {} %, while the motion is
  nearest at {:.2f} / {:.2f} J, within a step of the scan from the J of the parts.
- **Control.** Where SK itself stands for the complete action its motion is that of the model by construction, and
  its force comes back from the motion, sampled and differentiated in the same way: what the others miss is the
  model's fault.
)",
      thesis.key.inertia / thesis.blocked.inertia, 1e3 * thesis.arm * thesis.takeover_angle,
      1e3 * study.model.arm * study.model.takeover_angle, bounce_mm(study.piano), bounce_mm(study.forte),
      percent(piano.least_force), percent(forte.least_force), piano.best_factor, forte.best_factor);
}

constexpr const char* kTable23Text = R"(
**Table 2.3.** In bold what the thesis prints (0 not or little sensitive, + sensitive), then eta in % for piano /
forte up to the let-off, in brackets up to the release. SK of this action alone, from F_down on. Model: against the
complete action. Initial conditions: 0.1 mm and 10 mm/s more. Noise: what is given rounded to 1/200 of its largest
value, as the laser's 50 um are of the dip.

)";

constexpr const char* kTable23Reading = R"(
Ten cells read as printed, two in part. The model's 0 under F -> y holds for the whole stroke; up to the let-off the
motion depends on the model too, less than half as much as the forces. The + of the initial conditions under
y'' -> F comes from the front rail alone, where a key that has drifted by a millimetre is pressed into the punching; before it the
force of an inertia hardly depends on where the key is.

In words the thesis says both: its overview of the chapter calls the comparison of forces under a given motion "not
sufficient", its abstract and its conclusion call it the only one to be used. What is measured here is the second.
)";

}  // namespace

}  // namespace erard::study::simple

namespace erard::study {

Section simple_models_section(const Pictures& pictures) {
  using namespace simple;
  const SimpleModelsStudy study = study_simple_models();
  draw_picture(study, pictures.folder / kPicture);
  Section section;
  section.title = "One degree of freedom: why forces have to be compared (chapter 2)";
  const Verdict piano = judge(study.model, study.piano.record, study.piano.carried);
  const Verdict forte = judge(study.model, study.forte.record, study.forte.carried);
  section.result = fmt::format(
      "one degree of freedom meets the key's motion to {} / {} % (piano / forte) and misses the force by {} / {} %",
      percent(piano.motion.whole.eta), percent(forte.motion.whole.eta), percent(piano.force.whole.eta),
      percent(forte.force.whole.eta));
  section.text = summary(study);
  section.text += fmt::format(
      R"(
![Left: the key's motion under the force on the complete action. Right: the force under its motion]({}/{})

Complete action: `config/grand_action.yaml` under `piano.csv` and `forte.csv`, 2 kHz, its acceleration the central
difference of its rate. Forces are cut off at the frame; how far they go is in the table.

)",
      pictures.link, kPicture);
  section.text += phase_table(study) + phase_text(study);
  section.text += '\n' + variant_table(study) + variant_text(study);
  section.text += kTable23Text + table_2_3(study) + kTable23Reading;
  section.contradictions = contradictions();
  section.text += "\n**Parts and equivalents.**\n\n" + parts_table(study) +
                  "\n**Printed numbers that others contradict by more than 2 %.**\n\n" + table(section.contradictions);
  return section;
}

}  // namespace erard::study
