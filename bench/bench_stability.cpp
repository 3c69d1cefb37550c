// The coupling of a device: where it is stable, what is chosen and what that costs. Writes docs/stability.md and its
// picture:
//   build/release/bin/bench_stability [FOLDER, docs]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>

#include "bench/stability_text.hpp"
#include "erard/device/config_dir.hpp"
#include "erard/device/device_file.hpp"
#include "erard/device/output_file.hpp"
#include "study/defaults.hpp"
#include "study/figure.hpp"
#include "study/section.hpp"
#include "study/stability.hpp"

namespace {

using namespace erard;
using namespace erard::study;
using namespace erard::bench;
using Rows = std::vector<std::vector<std::string>>;

constexpr FingerSettings kHand{1000, 5};
constexpr double kHoldTime = 10;  // [s]

std::string name_of(const Coupling& c) { return fmt::format("a = {:g}, b = {:g}", c.stiffness, c.damping); }
std::string grams(double mass) { return fmt::format("{:.0f} g", 1e3 * mass); }
std::string margin(double factor) { return factor > 0 ? fmt::format("{:.2f}", factor) : "unstable"; }

// ---- the map: lines are the linear model's, points are simulated
struct MapCount {
  int agree = 0, all = 0;
  double largest_margin = 1;  // of those that do not
};

struct Look {
  LoopSetting setting;
  const char* colour;
  double aside;  // factor of a, so that points of several estimators do not hide each other
};

Panel map_panel(const ActionFile& rigid, double mass, int delay, const std::vector<Look>& looks, MapCount& count) {
  Panel panel{fmt::format("lever {}, {} period{} of delay", grams(mass), delay, delay > 1 ? "s" : ""),
              {"a [N/m]", {500, 40000}, true},
              {"b [N s/m]", {0.3, 500}, true},
              {},
              "bottom left Left reverse samplen 2"};
  for (const auto& [setting, colour, aside] : looks) {
    Curve edge{setting.name, {}, {}, fmt::format("lines lw 1.6 lc rgb '{}'", colour)};
    Curve lower{"", {}, {}, edge.style}, quiet{"", {}, {}, fmt::format("points pt 7 ps 0.4 lc rgb '{}'", colour)},
        loud{"", {}, {}, fmt::format("points pt 2 ps 0.6 lw 1.2 lc rgb '{}'", colour)};
    LoopCase loop_case;
    loop_case.lever_mass = mass;
    loop_case.finger = kHand;
    loop_case.delay_periods = delay;
    const CouplingLoop loop(loop_case, kPeriod, setting.estimator(mass, delay));
    for (double a = 500; a < 41000; a *= 1.1) {
      const CouplingLoop::Band band = loop.stable_damping(a);
      if (band.largest == 0) continue;
      edge.x.push_back(a), edge.y.push_back(band.largest);
      lower.x.push_back(a), lower.y.push_back(band.least);
    }
    for (const double a : {700., 1500., 3000., 6500., 13000., 28000.})
      for (const double b : {3., 9., 20., 45., 90., 134., 200., 300.}) {
        const LoopSetting at = with_coupling(setting, {aside * a, b});
        const bool is_quiet = is_quiet_on_rigid_key(rigid, at, mass, delay);
        const double linear = loop.gain_margin(at.coupling);
        ++count.all;
        if (is_quiet == (linear > 0))
          ++count.agree;
        else
          count.largest_margin = std::max(count.largest_margin, linear);
        (is_quiet ? quiet : loud).x.push_back(aside * a);
        (is_quiet ? quiet : loud).y.push_back(b);
      }
    for (const Curve& curve : {edge, lower, quiet, loud})
      if (!curve.x.empty()) panel.curves.push_back(curve);
  }
  for (const LoopSetting& mark : {plain_setting(), cautious_setting(), observed_setting()})
    panel.curves.push_back(
        {"", {mark.coupling.stiffness}, {mark.coupling.damping}, "points pt 6 ps 1.4 lw 2 lc rgb '#000000'"});
  return panel;
}

// ---- tables
/// Margins of couplings that might be the safe one, over all fingers and rigid stops, levers and delays.
std::string safe_table(double damping) {
  std::vector<FingerSettings> holders(std::begin(kFingers), std::end(kFingers));
  holders.insert(holders.end(), std::begin(kStops), std::end(kStops));
  Rows rows;
  for (const double stiffness : {2000., 1400., 1000., 700., 500., 300.}) {
    std::vector<std::string> row{fmt::format("{:g}", stiffness)};
    for (const double b : {0.5, damping, 2., 4., 9.}) {
      const LoopSetting setting = with_coupling(cautious_setting(), {stiffness, b});
      double least = HUGE_VAL;
      for (const double mass : kLevers)
        for (const int delay : {1, 2}) least = std::min(least, least_margin(setting, mass, delay, holders));
      row.push_back(margin(least));
    }
    rows.push_back(row);
  }
  return table({"a [N/m]", "b = 0.5 N s/m", fmt::format("{:g}", damping), "2", "4", "9"}, rows);
}

std::string known_pair_table(const ActionFile& action, const ActionFile& rigid) {
  Rows rows;
  for (const double mass : kLevers)
    for (const int delay : {1, 2}) {
      const LoopSetting plain = plain_setting();
      const auto said = [](bool is_quiet) { return is_quiet ? "quiet" : "shakes"; };
      rows.push_back({grams(mass), fmt::format("{}", delay), margin(least_margin(plain, mass, delay, {&kHand, 1})),
                      said(is_quiet_on_rigid_key(rigid, plain, mass, delay)),
                      said(is_quiet_on_bottom(action, plain, mass, delay))});
    }
  return table({"lever", "delay [periods]", "gain margin, linear", "simulated, rigid key", "simulated, key bottom"},
               rows);
}

std::string margin_table(const std::vector<LoopSetting>& settings) {
  Rows rows;
  for (const LoopSetting& s : settings)
    for (const double mass : kLevers)
      for (const int delay : {1, 2})
        rows.push_back({s.name, name_of(s.coupling), grams(mass), fmt::format("{}", delay),
                        margin(least_margin(s, mass, delay, kFingers)), margin(least_margin_on_masses(s, mass, delay)),
                        margin(least_margin_misled(s, mass, delay, mass, 3 - delay)),
                        margin(least_margin_misled(s, mass, delay, 1.25 * mass, delay)),
                        margin(least_margin(s, mass, delay, kStops)), fixed(noise_force(s, mass, delay, kNoise), 2)});
  return table({"estimator", "coupling", "lever", "delay", "fingers, rigid key", "fingers, key a free mass",
                "told the other delay", "told a lever 25 % heavier", "rigid stop", "50 um make, N RMS"},
               rows);
}

std::string hold_table(const ActionFile& action, const std::vector<LoopSetting>& settings,
                       VirtualActuatorSettings actuator, double noise, std::span<const FingerSettings> fingers) {
  Rows rows;
  for (const LoopSetting& s : settings)
    for (const double mass : kLevers)
      for (const int delay : {1, 2}) {
        std::vector<std::string> row{s.name, name_of(s.coupling), grams(mass), fmt::format("{}", delay)};
        for (const Hold place : kHolds) {
          double ratio = 0, last = 0, finger_force = 0;
          for (const FingerSettings& finger : fingers) {
            ClosedLoopSettings loop = loop_of(s, mass, delay, finger);
            loop.rig.sensor.noise = noise;
            loop.rig.actuator = actuator;
            const HoldVerdict v = hold(action, loop, place, kHoldTime);
            ratio = std::max(ratio, v.last / std::max(v.before, HoldVerdict::kSilence));
            last = std::max(last, v.last);
            finger_force = std::max(finger_force, v.finger);
          }
          row.push_back(fmt::format("{:.2f} / {:.2f} / {:.2f}", ratio, last, finger_force));
        }
        rows.push_back(row);
      }
  return table(
      {"estimator", "coupling", "lever", "delay", "at rest", "at the let-off", "key bottom, 5 N", "key bottom, 15 N"},
      rows);
}

std::string fidelity_table(const ActionFile& action, const std::vector<std::pair<LoopSetting, double>>& settings) {
  const ReferenceStroke strokes[] = {reference_stroke(action, "piano", 0.22), reference_stroke(action, "forte", 0.142)};
  Rows rows;
  for (const auto& [s, mass] : settings)
    for (const bool is_brake : {false, true}) {
      std::vector<std::string> row{s.name, name_of(s.coupling), grams(mass), is_brake ? "MR brake" : "voice coil"};
      for (const bool is_lightened : {false, true})
        for (const ReferenceStroke& stroke : strokes) {
          ClosedLoopSettings loop = loop_of(s, mass, 1, kHand);
          if (is_brake) loop.rig.actuator = VirtualActuatorSettings::mr_brake();
          const Fidelity f = fidelity(is_lightened ? without_lever_mass(action, mass) : action, loop, stroke);
          row.push_back(fmt::format("{} / {:.2f} / {:+.0f}", percent(f.eta), f.rms, 100 * f.hammer_speed));
        }
      rows.push_back(row);
    }
  return table(
      {"estimator", "coupling", "lever", "actuator", "piano", "forte", "piano, lighter key", "forte, lighter key"},
      rows);
}

/// What the top of the page says of a choice: smallest margin of all, eta for a lever of 60 g.
struct Summary {
  double margin = HUGE_VAL, piano = 0, forte = 0;
};
Summary summarise(const ActionFile& action, const LoopSetting& s) {
  Summary summary;
  for (const double mass : kLevers)
    for (const int delay : {1, 2}) summary.margin = std::min(summary.margin, least_margin(s, mass, delay, kFingers));
  const ClosedLoopSettings loop = loop_of(s, 0.06, 1, kHand);
  summary.piano = fidelity(action, loop, reference_stroke(action, "piano", 0.22)).eta;
  summary.forte = fidelity(action, loop, reference_stroke(action, "forte", 0.142)).eta;
  return summary;
}

RenderSettings device_file() { return load_device(config_dir() / "device.yaml").rendering; }

const char* name_of(ActuatorKind kind) { return kind == ActuatorKind::mr_brake ? "MR brake" : "voice coil"; }

/// Whoever holds a lever, in the rows of the pipeline's tables.
struct Holder {
  const char* name;
  std::span<const FingerSettings> fingers;
};

/// Holds through the whole pipeline; cells are the worst of a holder's fingers.
std::string pipeline_table(const ActionFile& action, const RenderSettings& device,
                           const std::vector<ActuatorKind>& actuators, const std::vector<Holder>& holders,
                           double& largest_ratio) {
  Rows rows;
  for (const ActuatorKind actuator : actuators)
    for (const Holder& holder : holders)
      for (const double mass : kLevers)
        for (const int delay : {1, 2}) {
          std::vector<std::string> row{name_of(actuator), holder.name, grams(mass), fmt::format("{}", delay)};
          for (const Hold place : kHolds) {
            double ratio = 0, last = 0, finger_force = 0, guarded = 0;
            for (const FingerSettings& finger : holder.fingers) {
              const HoldVerdict v =
                  hold(action, pipeline_loop(device, actuator, mass, delay, finger), place, kHoldTime);
              ratio = std::max(ratio, v.last / std::max(v.before, HoldVerdict::kSilence));
              last = std::max(last, v.last);
              finger_force = std::max(finger_force, v.finger);
              guarded = std::max(guarded, v.guarded);
            }
            largest_ratio = std::max(largest_ratio, ratio);
            row.push_back(fmt::format("{:.2f} / {:.2f} / {:.2f} / {}", ratio, last, finger_force, percent(guarded)));
          }
          rows.push_back(row);
        }
  return table(
      {"actuator", "held by", "lever", "delay", "at rest", "at the let-off", "key bottom, 5 N", "key bottom, 15 N"},
      rows);
}

/// What a finger feels through the whole pipeline, as the file sets it.
std::string pipeline_fidelity_table(const ActionFile& action, const RenderSettings& device) {
  const ReferenceStroke strokes[] = {reference_stroke(action, "piano", 0.22), reference_stroke(action, "forte", 0.142)};
  Rows rows;
  for (const ActuatorKind actuator : {ActuatorKind::voice_coil, ActuatorKind::mr_brake})
    for (const double mass : kLevers)
      for (const int delay : {1, 2}) {
        std::vector<std::string> row{name_of(actuator), grams(mass), fmt::format("{}", delay)};
        for (const ReferenceStroke& stroke : strokes) {
          ClosedLoopSettings loop = pipeline_loop(device, actuator, mass, delay, kHand);
          auto& rendering = std::get<PipelineHost>(loop.host).rendering;
          rendering.track.still_zone = device.track.still_zone;
          rendering.actuator.voice_coil = device.actuator.voice_coil;
          const Fidelity f = fidelity(action, loop, stroke);
          row.push_back(fmt::format("{} / {:.2f} / {:+.0f} / {}", percent(f.eta), f.rms, 100 * f.hammer_speed,
                                    percent(f.guarded)));
        }
        rows.push_back(row);
      }
  return table({"actuator", "lever", "delay", "piano", "forte"}, rows);
}

/// What else makes room: largest b for a = 6500 with the backward difference, lever of 60 g.
std::string remedy_table() {
  struct Remedy {
    const char* name;
    double period, viscous, mass;
  };
  Rows rows;
  for (const Remedy& r : {Remedy{"none", 5e-4, 0.1, 0.06},
                          {"4 kHz, delays as many periods", 2.5e-4, 0.1, 0.06},
                          {"damper of 5 N s/m on the lever", 5e-4, 5, 0.06},
                          {"lever of 120 g", 5e-4, 0.1, 0.12}}) {
    std::vector<std::string> row{r.name};
    for (const int delay : {1, 2}) {
      LoopCase loop;
      loop.lever_mass = r.mass;
      loop.lever_viscous = r.viscous;
      loop.finger = kHand;
      loop.delay_periods = delay;
      const CouplingLoop::Band band =
          CouplingLoop(loop, r.period, SlidingPolynomial(r.period, 2, 1)).stable_damping(6500);
      row.push_back(band.largest > 0 ? fmt::format("{:.0f} to {:.0f}", band.least, band.largest) : "none");
    }
    rows.push_back(row);
  }
  return table({"remedy", "stable b [N s/m], one period", "two periods"}, rows);
}

}  // namespace

int main(int argc, char** argv) try {
  const std::filesystem::path docs = argc > 1 ? argv[1] : "docs";
  const ActionFile action = default_action(), rigid = with_rigid_key(action);
  const LoopSetting plain = plain_setting(), cautious = cautious_setting(), observed = observed_setting();
  const std::vector<LoopSetting> chosen{cautious, observed};

  fmt::print(stderr, "map ...\n");
  MapCount count;
  std::vector<Panel> panels;
  for (const double mass : kLevers)
    for (const int delay : {1, 2})
      panels.push_back(map_panel(
          rigid, mass, delay, {{plain, "#1050a0", 0.9}, {cautious, "#b05010", 1}, {observed, "#107040", 1.11}}, count));
  std::filesystem::create_directories(docs / "images");
  draw(docs / "images" / "stability.svg", panels, 2, 520, 400);

  fmt::print(stderr, "tables ...\n");
  const Summary a = summarise(action, cautious), b = summarise(action, observed);
  const RenderSettings device = device_file();
  constexpr ActuatorKind kCoil = ActuatorKind::voice_coil, kBrake = ActuatorKind::mr_brake;
  const std::span<const FingerSettings> stops(kStops);
  double largest_ratio = 0, not_told = 0;
  const std::string pipeline = pipeline_table(
      action, device, {kCoil, kBrake},
      {{"fingers", kFingers}, {"stop, 20 N s/m", stops.subspan(1)}, {"stop, 1 N s/m", stops.first(1)}}, largest_ratio);
  RenderSettings unguarded = device;
  unguarded.passivity.is_on = false;
  const std::string without_passivity =
      pipeline_table(action, unguarded, {kCoil}, {{"stop, 1 N s/m", stops.first(1)}}, not_told);
  std::string text =
      fmt::format(fmt::runtime(kHead), cautious.coupling.stiffness, cautious.coupling.damping, cautious.name, a.margin,
                  percent(a.piano), percent(a.forte), observed.coupling.stiffness, observed.coupling.damping, b.margin,
                  percent(b.piano), percent(b.forte), count.agree, count.all, count.largest_margin, largest_ratio);
  text += known_pair_table(action, rigid) + kMargins + margin_table(chosen);
  fmt::print(stderr, "holds ...\n");
  text += kHolding + hold_table(action, chosen, VirtualActuatorSettings::voice_coil(), kNoise, kFingers);
  text += kHoldingBrake + hold_table(action, {cautious}, VirtualActuatorSettings::mr_brake(), kNoise, kFingers);
  text += kHoldingStop + hold_table(action, chosen, VirtualActuatorSettings::voice_coil(), kNoise, kStops);
  fmt::print(stderr, "fidelity ...\n");
  text += kFidelity +
          fidelity_table(action, {{plain, 0.2}, {cautious, 0.06}, {observed, 0.06}, {cautious, 0.2}, {observed, 0.2}});
  text += kPipeline + pipeline + kWithoutPassivity + without_passivity + kSafe +
          safe_table(device.passivity.safe_coupling.damping) + kPipelineFidelity +
          pipeline_fidelity_table(action, device) + kRemedies + remedy_table() + kLimits;
  OutputFile file(docs / "stability.md");
  file.write(text);
  file.commit();
} catch (const std::exception& error) {
  fmt::print(stderr, "bench_stability: {}\n", error.what());
  return 1;
}
