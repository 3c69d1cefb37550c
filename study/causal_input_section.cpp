// What the cost of a causal input looks like in the document.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/causal_input.hpp"
#include "study/defaults.hpp"
#include "study/figure.hpp"

namespace erard::study {
namespace {

constexpr double kNoises[] = {0, 5e-6, 50e-6};  // [m] rms
constexpr int kSeeds = 3;
int seeds_of(double noise) { return noise > 0 ? kSeeds : 1; }

/// One estimator at one noise, interpolated, on the two strokes of the thesis.
struct Trial {
  Candidate candidate;
  InputCost piano, forte;
  double rms() const { return std::sqrt(piano.rms * forte.rms); }  // what "best" means here
};

const Trial& smallest(const std::vector<Trial>& trials) {
  return *std::min_element(trials.begin(), trials.end(),
                           [](const Trial& a, const Trial& b) { return a.rms() < b.rms(); });
}

struct Trials {
  OfflineRun piano, forte;
  std::vector<std::vector<Trial>> at_noise;  // in the order of kNoises

  const Trial& best(std::size_t noise) const { return smallest(at_noise[noise]); }
  /// The best of those whose window does not follow the key.
  Trial best_fixed(std::size_t noise) const {
    std::vector<Trial> fixed = at_noise[noise];
    std::erase_if(fixed, [](const Trial& trial) { return trial.candidate.family == Family::adaptive_line; });
    return smallest(fixed);
  }
  std::vector<Trial> of(std::size_t noise, Family family) const {
    std::vector<Trial> trials;
    for (const Trial& trial : at_noise[noise])
      if (trial.candidate.family == family) trials.push_back(trial);
    return trials;
  }
};

Trials try_all(const ActionFile& action) {
  Trials trials{
      play_offline(action, "piano", 0, 0.220), play_offline(action, "forte", 0, 0.142), {}};  // to the release
  for (const double noise : kNoises) {
    std::vector<Trial>& at_noise = trials.at_noise.emplace_back();
    for (const Candidate& c : all_candidates())
      at_noise.push_back({c, causal_cost(action, trials.piano, c, Between::interpolated, noise, seeds_of(noise)),
                          causal_cost(action, trials.forte, c, Between::interpolated, noise, seeds_of(noise))});
  }
  return trials;
}

constexpr Family kFamilies[] = {Family::sliding_line, Family::sliding_parabola, Family::fading_line,
                                Family::fading_parabola, Family::adaptive_line};

struct Look {
  const char* label;
  const char* style;
};
Look look_of(Family family) {
  switch (family) {
    case Family::sliding_line: return {"line", "linespoints pt 7 ps 0.4 lw 1.3 lc rgb '#1050a0'"};
    case Family::sliding_parabola: return {"parabola", "linespoints pt 7 ps 0.4 lw 1.3 lc rgb '#b05010'"};
    case Family::fading_line: return {"alpha-beta", "linespoints pt 6 ps 0.4 dt 2 lc rgb '#1050a0'"};
    case Family::fading_parabola: return {"alpha-beta-gamma", "linespoints pt 6 ps 0.4 dt 2 lc rgb '#b05010'"};
    case Family::adaptive_line: break;
  }
  return {"adaptive line, the best band", "lines lw 2 lc rgb '#107040'"};
}

double delay_of(const Candidate& candidate) {
  return std::visit([](const auto& e) { return e.delay(); }, make_estimator(candidate, 0));
}
double gain_of(const Candidate& candidate) {
  return std::visit([](const auto& e) { return e.noise_gain(); }, make_estimator(candidate, 0));
}

/// rms of the force without noise over the delay of the estimators that have one.
Panel delay_panel(const Trials& trials, const char* name, InputCost Trial::*stroke) {
  Panel panel{fmt::format("{}, no noise", name), {"delay [ms]"}, {"force error [N RMS]"}, {}, "top left"};
  for (const Family family : {Family::sliding_line, Family::fading_line}) {
    Curve curve{look_of(family).label, {}, {}, look_of(family).style};
    for (const Trial& trial : trials.of(0, family)) {
      curve.x.push_back(delay_of(trial.candidate) * 1e3);
      curve.y.push_back((trial.*stroke).rms);
    }
    panel.curves.push_back(curve);
  }
  return panel;
}

/// rms of the force with noise over the noise gain: what is too long on the left, what is too noisy on the right.
Panel noise_panel(const Trials& trials, std::size_t noise, const char* name, InputCost Trial::*stroke) {
  Panel panel{fmt::format("{}, {:.0f} um of noise", name, kNoises[noise] * 1e6),
              {"noise gain [1/s]", {20, 6000}, true},
              {"force error [N RMS]", {0.003, 30}, true},
              {},
              "bottom left Left reverse samplen 2"};
  for (const Family family : kFamilies) {
    Curve curve{look_of(family).label, {}, {}, look_of(family).style};
    double best = std::numeric_limits<double>::infinity();
    for (const Trial& trial : trials.of(noise, family)) {
      curve.x.push_back(gain_of(trial.candidate));
      curve.y.push_back((trial.*stroke).rms);
      best = std::min(best, (trial.*stroke).rms);
    }
    if (family == Family::adaptive_line) curve.x = {20, 6000}, curve.y = {best, best};
    panel.curves.push_back(curve);
  }
  return panel;
}

Panel force_panel(const ActionFile& action, const OfflineRun& truth, const Candidate& causal) {
  const double noise = kNoises[2];
  Panel panel{fmt::format("{}, {:.0f} um of noise", truth.name, noise * 1e6),
              {"time [ms]"},
              {"finger force [N]"},
              {},
              "top left Left reverse samplen 2"};
  Curve spline{"offline, spline", {}, {}, "lines lw 1.6 lc rgb '#444444'"};
  for (std::size_t i = 0; i < truth.force.size(); ++i) {
    spline.x.push_back((truth.from + static_cast<double>(i + 1) * 5e-4) * 1e3);
    spline.y.push_back(truth.force[i]);
  }
  const ForceCurve force = play_causal(action, truth, causal, Between::interpolated, noise, 1);
  panel.curves = {{name_of(causal), spline.x, force.force, "lines lc rgb '#107040'"}, spline};
  return panel;
}

std::string newton(double force) { return fmt::format("{:.{}f}", force, force < 0.1 ? 3 : 2); }
std::string four(const InputCost& cost) {
  return fmt::format("{} / {} / {} / {}", cost.eta > 0 ? fmt::format("{:.1f}", cost.eta * 100) : "-", newton(cost.rms),
                     newton(cost.largest),
                     std::isfinite(cost.hammer_speed) ? fmt::format("{:.0f}", cost.hammer_speed * 1e3) : "-");
}

std::string estimator_table(const Trials& trials, double b) {
  std::vector<std::vector<std::string>> rows;
  for (const Candidate& c : {Candidate{Family::sliding_line, 2},
                             {Family::sliding_parabola, 3},
                             {Family::sliding_line, 10},
                             {Family::sliding_parabola, 12},
                             {Family::fading_line, 0.7},
                             {Family::fading_parabola, 0.7}})
    rows.push_back({name_of(c), milliseconds(delay_of(c), 2), fmt::format("{:.0f}", gain_of(c)),
                    newton(b * rate_error(trials.piano, c)), newton(b * rate_error(trials.forte, c)),
                    newton(b * gain_of(c) * kNoises[1]), newton(b * gain_of(c) * kNoises[2])});
  return table({"estimator", "delay [ms]", "noise gain [1/s]", "b x error without noise, piano [N RMS]", "forte",
                "b x 5 um [N RMS]", "b x 50 um"},
               rows);
}

std::string family_table(const Trials& trials) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t n = 0; n < std::size(kNoises); ++n)
    for (const Family family : kFamilies) {
      const Trial best = smallest(trials.of(n, family));
      const bool is_fixed = family != Family::adaptive_line;
      rows.push_back({fmt::format("{:.0f}", kNoises[n] * 1e6), name_of(best.candidate),
                      is_fixed ? milliseconds(delay_of(best.candidate), 2) : "0.25 to 15.75", four(best.piano),
                      four(best.forte)});
    }
  return table(
      {"noise [um]", "best of its kind", "delay [ms]", "piano: eta % / RMS N / largest N / hammer mm/s", "forte"},
      rows);
}

/// A key that nobody touches.
OfflineRun rest_run(const ActionFile& action) {
  OfflineRun run = play_offline(action, "piano", 0, 0.0005);
  run.keystroke = Keystroke(KeystrokeQuantity::position, {0, 0.25}, {0, 0});
  run.name = "at rest";
  run.until = 0.25;
  run.force.assign(500, 0);
  return run;
}

std::string stroke_table(const ActionFile& action, const Trials& trials) {
  // from 20 ms before the key moves to 50 ms after the hammer's arrival, or to the fourth strike
  const OfflineRun runs[] = {rest_run(action),
                             trials.piano,
                             trials.forte,
                             play_offline(action, "recorded_very_slow", 1.930, 4.700),
                             play_offline(action, "recorded_medium", 0.254, 0.475),
                             play_offline(action, "recorded_fast", 0.126, 0.240),
                             play_offline(action, "recorded_fast_free_release", 0.130, 0.240),
                             play_offline(action, "recorded_repeated", 0.171, 0.850)};
  std::vector<std::vector<std::string>> rows;
  for (const OfflineRun& run : runs)
    for (std::size_t n = 0; n < std::size(kNoises); ++n) {
      const Candidate& best = trials.best(n).candidate;
      const InputCost late = causal_cost(action, run, best, Between::interpolated, kNoises[n], seeds_of(kNoises[n]));
      const InputCost ahead = causal_cost(action, run, best, Between::extrapolated, kNoises[n], seeds_of(kNoises[n]));
      const double peak = *std::max_element(run.force.begin(), run.force.end());
      rows.push_back({n == 0 ? fmt::format("{}, peak {} N", run.name, newton(peak)) : "",
                      fmt::format("{:.0f}", kNoises[n] * 1e6), four(late), newton(late.rms_in_step), four(ahead)});
    }
  return table({"stroke", "noise [um]", "interpolated: eta % / RMS N / largest N / hammer mm/s",
                "less the period [N RMS]", "extrapolated"},
               rows);
}

std::string describe(const Trials& trials, const ActionFile& action) {
  const double a = action.model.finger.stiffness, b = action.model.finger.damping;
  const Trial &clean = trials.best(0), &fine = trials.best(1), &coarse = trials.best(2);
  const Trial fine_fixed = trials.best_fixed(1), coarse_fixed = trials.best_fixed(2);
  const auto both = [](const Trial& t) { return newton(t.piano.rms) + " and " + newton(t.forte.rms); };
  const InputCost ahead = causal_cost(action, trials.forte, clean.candidate, Between::extrapolated, 0, 1);
  return fmt::format(
             "A device knows the piston in samples up to now, 2000 a second. Against the offline run, whose samples "
             "are\n"
             "joined by a spline, its finger force is off by {} N RMS (piano and forte) without noise ({}),\n"
             "by {} N with 5 um of white noise ({}) and by {} N with 50 um\n"
             "({}): the best that was found of each. The best windows of fixed length leave {} N at\n"
             "5 um ({}) and {} N at 50 um ({}); the hammer speed in forte is then off by\n"
             "{:.0f} mm/s at 50 um, with the best by {:.0f} mm/s.\n\n",
             both(clean), name_of(clean.candidate), both(fine), name_of(fine.candidate), both(coarse),
             name_of(coarse.candidate), both(fine_fixed), name_of(fine_fixed.candidate), both(coarse_fixed),
             name_of(coarse_fixed.candidate), coarse_fixed.forte.hammer_speed * 1e3, coarse.forte.hammer_speed * 1e3) +
         fmt::format(
             "b = {:.0f} N s/m is the reason: through it a backward difference makes {} N RMS of 50 um ({} N of a "
             "single\n"
             "step of 50 um), while a = {:.0f} N/m makes {} N. With a sample begins the tick of a period, at whose end "
             "its\n"
             "force is due. *Interpolated*: the piston goes from the sample before to the newest on straight lines in "
             "position\n"
             "and rate, and is one period late throughout. *Extrapolated*: it goes on from the newest at the newest "
             "rate; it\n"
             "is in time, but its rate is stale by up to a period: {} N RMS in forte without noise, interpolated {}.\n"
             "The finger's motion is given here; a real finger would also answer the force.\n\n",
             b, newton(b * gain_of({Family::sliding_line, 2}) * kNoises[2]), newton(b * kNoises[2] / 5e-4), a,
             newton(a * kNoises[2]), newton(ahead.rms), newton(clean.forte.rms));
}

}  // namespace

Section causal_input_section(const Pictures& pictures) {
  const ActionFile action = default_action();
  const Trials trials = try_all(action);
  const Candidate& best = trials.best(2).candidate;
  draw(pictures.folder / "causal_input.svg",
       {delay_panel(trials, "piano", &Trial::piano), noise_panel(trials, 1, "piano", &Trial::piano),
        noise_panel(trials, 2, "piano", &Trial::piano), delay_panel(trials, "forte", &Trial::forte),
        noise_panel(trials, 1, "forte", &Trial::forte), noise_panel(trials, 2, "forte", &Trial::forte)},
       3, 400, 330);
  draw(pictures.folder / "causal_force.svg",
       {force_panel(action, trials.piano, best), force_panel(action, trials.forte, best)}, 2, 560, 340);
  const auto both = [](const Trial& t) { return newton(t.piano.rms) + " / " + newton(t.forte.rms); };
  const std::string result = fmt::format(
      "samples alone instead of a spline cost {} N RMS (piano / forte) without noise, {} N with 5 um, {} N "
      "with 50 um",
      both(trials.best(0)), both(trials.best(1)), both(trials.best(2)));
  return {"A causal input: what a device without a spline pays",
          result,
          describe(trials, action) +
              fmt::format("![Force error over delay and noise gain]({0}/causal_input.svg)\n"
                          "![Finger force from noisy samples]({0}/causal_force.svg)\n\n",
                          pictures.link) +
              "The estimators on the samples alone; b times their error is the force on a key that is held:\n\n" +
              estimator_table(trials, action.model.finger.damping) +
              fmt::format(
                  "\nThe best of each kind through the action, interpolated, {} noises each; best has the smallest\n"
                  "product of both RMS. Sigma is the rms of the noise, 1 um where there is less:\n\n",
                  kSeeds) +
              family_table(trials) +
              "\nThe best of all, chosen on piano and forte, on every stroke. The recordings are those of a key; as a "
              "piston\n"
              "they hold blows of a few milliseconds, of which a period of delay is a large part:\n\n" +
              stroke_table(action, trials),
          {}};
}

}  // namespace erard::study
