// What lanes gain: the same keys played by the scalar engine and in the lanes of every instruction set of this CPU, turn by
// turn in every period, so that other work on the machine meets all of them alike. Writes the table of docs/keyboard.md:
//   build/release/bin/bench_lanes [SECONDS OF PLAY, 3] [KEYS, 88] [CPU, 0]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#ifdef __linux__
#include <sched.h>
#endif

#include "erard/device/action_file.hpp"
#include "erard/device/config_dir.hpp"
#include "erard/device/keystroke.hpp"
#include "erard/lanes/key_lanes.hpp"

namespace {

using namespace erard;
using Clock = std::chrono::steady_clock;

/// A keyboard and who plays it.
struct Contender {
  Contender(const std::string& name_, const Model& model, int keys, const TickSettings& settings)
      : name(name_), keyboard(model, keys, settings, SleepSettings::eager()) {}

  std::string name;
  Keyboard keyboard;
  std::unique_ptr<KeyLanes> lanes;  // none: the scalar engine
  std::vector<double> time;         // of each period [s]
  double worst = 0;                 // difference of any force from the scalar engine's [N]

  void tick(const std::vector<DriveSample>& inputs, bool is_counted) {
    const auto start = Clock::now();
    if (lanes)
      lanes->tick(inputs);
    else
      keyboard.tick(inputs);
    if (is_counted) time.push_back(std::chrono::duration<double>(Clock::now() - start).count());
  }
};

double quantile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

/// Median over the periods of what the scalar engine took in each, by what this one took in the same.
double gain(const Contender& one, const Contender& scalar) {
  std::vector<double> ratio;
  for (std::size_t i = 0; i < one.time.size(); ++i) ratio.push_back(scalar.time[i] / one.time[i]);
  return quantile(ratio, 0.5);
}

void print(const std::string& scene, const Contender& one, const Contender& scalar) {
  const double alone = one.lanes ? static_cast<double>(one.lanes->count().one_by_one) : 0;
  const double all = one.lanes ? alone + static_cast<double>(one.lanes->count().in_lanes) : 1;
  fmt::print("| {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.2f} | {:.1e} | {} |\n", scene, one.name,
             1e6 * quantile(one.time, 0), 1e6 * quantile(one.time, 0.5), 1e6 * quantile(one.time, 0.99),
             gain(one, scalar), one.worst, one.lanes ? fmt::format("{:.3f} %", 100 * alone / all) : "");
}

/// All keys repeat the keystroke every 0.7 s, each a little later than the one before.
void play(const Model& model, const std::string& name, int steps, int keys, double duration) {
  constexpr double kEvery = 0.7, kApart = 0.0079;  // [s]
  const Keystroke keystroke = read_keystroke(config_dir() / "keystrokes" / (name + ".csv"));
  TickSettings settings;
  settings.set_rate(2000, steps);
  std::vector<std::unique_ptr<Contender>> contenders;
  contenders.push_back(std::make_unique<Contender>("scalar", model, keys, settings));
  for (const InstructionSet set : kInstructionSets) {
    if (!is_available(set)) continue;
    contenders.push_back(std::make_unique<Contender>(name_of(set), model, keys, settings));
    contenders.back()->lanes = std::make_unique<KeyLanes>(contenders.back()->keyboard, set);
  }
  Contender& scalar = *contenders.front();
  std::vector<DriveSample> inputs(static_cast<std::size_t>(keys));
  while (scalar.keyboard.time() < duration + kEvery) {  // counted when all of them play
    const double end = scalar.keyboard.time() + settings.period;
    const bool is_counted = end > kEvery;
    for (int k = 0; k < keys; ++k) {
      const double since = end - kApart * k;
      const Sample sample = since < 0 ? Sample{} : keystroke.at(std::fmod(since, kEvery));
      inputs[static_cast<std::size_t>(k)] = {sample.value, sample.rate};
    }
    for (const auto& one : contenders) one->tick(inputs, is_counted);
    for (const auto& one : contenders)
      for (std::size_t k = 0; k < inputs.size(); ++k)
        one->worst = std::max(one->worst, std::abs(one->keyboard.forces()[k] - scalar.keyboard.forces()[k]));
  }
  for (const auto& one : contenders) print(name + (steps == 0 ? ", default" : ", 1 step"), *one, scalar);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const double duration = argc > 1 ? std::atof(argv[1]) : 3;
  const int keys = argc > 2 ? std::atoi(argv[2]) : 88;
#ifdef __linux__
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(argc > 3 ? std::atoi(argv[3]) : 0, &set);
  if (sched_setaffinity(0, sizeof set, &set) != 0) fmt::print("cannot bind to that CPU\n");
#endif
  const Model model = load_action(config_dir() / "grand_action.yaml").model;
  fmt::print(
      "{} keys, all played\n\n"
      "| keystroke, steps | engine | least us | p50 us | p99 us | gain | difference N | one by one |\n"
      "|---|---|---|---|---|---|---|---|\n",
      keys);
  for (const char* name : {"forte", "piano", "repetition", "recorded_fast"})
    for (const int steps : {1, 0}) play(model, name, steps, keys, duration);
}
