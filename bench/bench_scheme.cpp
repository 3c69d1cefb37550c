// Which theta, how many internal steps: error of the finger force at 2 kHz against a converged run of this engine (100
// internal steps a period) and against the independent simulation, beside what a period costs. Writes the table of
// docs/accuracy.md:
//   build/release/bin/bench_scheme [FOLDER WITH piano.csv AND forte.csv OF THE INDEPENDENT SIMULATION]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "erard/device/config_dir.hpp"
#include "erard/device/results.hpp"
#include "erard/mechanics/rest.hpp"

namespace {

using namespace erard;

struct Played {
  ForceCurve force;
  RunResult result;
};

Played play(const ActionFile& action, const Keystroke& keystroke, double theta, int substeps) {
  Played played;
  RunSettings settings;
  settings.tick.set_rate(2000, substeps);
  settings.tick.scheme.theta = theta;
  settings.duration = keystroke.end();
  settings.on_row = [&](const Snapshot& row) {
    played.force.time.push_back(row.time);
    played.force.force.push_back(row.force);
  };
  played.result = run(action, keystroke, settings);
  return played;
}

struct Error {
  double eta = 0, rms = 0, largest = 0;
};

Error error_of(const ForceCurve& ours, const ForceCurve& truth, double end) {
  Error error{relative_error(truth, ours, end), 0, 0};
  int n = 0;
  for (std::size_t i = 0; i < std::min(ours.time.size(), truth.time.size()) && truth.time[i] <= end; ++i, ++n) {
    const double e = std::abs(ours.force[i] - truth.force[i]);
    error.rms += e * e;
    error.largest = std::max(error.largest, e);
  }
  error.rms = std::sqrt(error.rms / n);
  return error;
}

/// The action with the felts of these contacts on axes fixed in their carriers, along the normal at rest.
ActionFile fix_axes(ActionFile action, const std::vector<std::string>& names) {
  const Mechanism mechanism = build_mechanism(action.model);
  const State rest = rest_state(mechanism, 1e-4);
  Frames frames;
  ContactFrames contacts;
  place_bodies(action.model, rest.x, frames);
  locate_contacts(mechanism, rest.x, frames, contacts);
  for (const std::string& name : names) {
    const auto c = static_cast<std::size_t>(find_contact(action.model, name));
    Contact& contact = action.model.contacts[c];
    const Vector2 outwards = -contacts[c].felt_slide;
    contact.felt.axis = FeltAxis::fixed;
    contact.felt.direction = std::atan2(outwards.y(), outwards.x()) - frames.of(carrier(contact)).angle;
  }
  return action;
}

void print_axes(const ActionFile& action) {
  const std::vector<std::string> all{"KS+", "KW", "KS-", "KH", "WJ", "WL", "JG", "JL", "JH", "LG", "LH", "HG"};
  std::vector<std::string> all_but_knuckle = all;
  std::erase(all_but_knuckle, "JH");
  fmt::print("\n| felts on axes fixed in their carriers | piano, eta % | forte, eta % |\n|---|---|---|\n");
  for (const auto& [label, names] :
       {std::pair{"all", all}, {"all but JH", all_but_knuckle}, {"JH alone", {"JH"}}, {"KW alone", {"KW"}}}) {
    fmt::print("| {} |", label);
    for (const auto& [name, release] : {std::pair{"piano", 0.220}, {"forte", 0.142}}) {
      const Keystroke keystroke = read_keystroke(config_dir() / "keystrokes" / (std::string(name) + ".csv"));
      const ForceCurve normal = play(action, keystroke, 0.5, 16).force;
      fmt::print(" {:.2f} |",
                 100 * relative_error(normal, play(fix_axes(action, names), keystroke, 0.5, 16).force, release));
    }
    fmt::print("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path references = argc > 1 ? argv[1] : "tests/reference";
  const ActionFile action = load_action(config_dir() / "grand_action.yaml");
  fmt::print(
      "| stroke | theta | steps a period | eta % / RMS N / largest N, own converged run | eta % before the check | "
      "eta % independent | us a period |\n|---|---|---|---|---|---|---|\n");
  for (const auto& [name, release, check] : {std::tuple{"piano", 0.220, 0.139}, {"forte", 0.142, 0.088}}) {
    const Keystroke keystroke = read_keystroke(config_dir() / "keystrokes" / (std::string(name) + ".csv"));
    const ForceCurve reference = read_force_curve(references / (std::string(name) + ".csv"));
    const ForceCurve truth = play(action, keystroke, 0.5, 100).force;
    for (const double theta : {0.5, 0.52, 0.55, 0.6, 1.0})
      for (const int substeps : {1, 2, 4, 8}) {
        const Played played = play(action, keystroke, theta, substeps);
        const Error e = error_of(played.force, truth, release);
        fmt::print("| {} | {} | {} | {:.2f} / {:.4f} / {:.2f} | {:.2f} | {:.2f} | {:.0f} |\n", name, theta, substeps,
                   100 * e.eta, e.rms, e.largest, 100 * error_of(played.force, truth, check).eta,
                   100 * relative_error(reference, played.force, release),
                   1e6 * played.result.computing_time / static_cast<double>(played.result.periods));
      }
  }
  print_axes(action);
}
