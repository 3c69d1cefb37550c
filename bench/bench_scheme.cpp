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

namespace {

using namespace erard;

struct Played {
  ForceCurve force;
  RunResult result;
};

Played play(const ActionFile& action, const Keystroke& keystroke, double theta, int substeps) {
  Played played;
  RunSettings settings;
  settings.tick.scheme.theta = theta;
  settings.tick.set_rate(2000, substeps);
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

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path references = argc > 1 ? argv[1] : "tests/reference";
  const ActionFile action = load_action(config_dir() / "grand_action.yaml");
  fmt::print("| stroke | theta | steps a period | eta % / RMS N / largest N, own converged run | eta % before the check | "
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
}
