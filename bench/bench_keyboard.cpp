// What a keyboard costs a period: keys, how many of them are played, steps, threads; beside a fixed amount of arithmetic,
// which shows what the machine itself adds. Writes the tables of docs/keyboard.md:
//   build/release/bin/bench_keyboard [SECONDS OF PLAY, 4] [CPU OF THE CALLER, 0] [CPU OF THE WORKER, 1]
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <vector>

#ifdef __linux__
#include <sched.h>
#endif

#include "erard/device/action_file.hpp"
#include "erard/device/config_dir.hpp"
#include "erard/device/duration_histogram.hpp"
#include "erard/device/key_pool.hpp"
#include "erard/device/keystroke.hpp"

namespace {

using namespace erard;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// What this thread has computed so far [s]: other processes do not count.
double computed() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void bind_caller(int cpu) {
#ifdef __linux__
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(cpu, &set);
  if (sched_setaffinity(0, sizeof set, &set) != 0) fmt::print("cannot bind to CPU {}\n", cpu);
#else
  static_cast<void>(cpu);
#endif
}

std::string row_of(const DurationHistogram& time) {
  return fmt::format("{:.1f} | {:.1f} | {:.1f} | {:.1f}", 1e6 * time.quantile(0.5), 1e6 * time.quantile(0.99),
                     1e6 * time.quantile(0.999), 1e6 * time.worst());
}

/// The same arithmetic over and over, about 100 us: whatever varies is not ours.
DurationHistogram measure_noise(double duration) {
  DurationHistogram histogram;
  volatile double seed = 1;  // read and written anew: nothing can be worked out beforehand
  const auto begin = Clock::now();
  while (seconds_since(begin) < duration) {
    const auto start = Clock::now();
    double x = seed;
    for (int i = 0; i < 40000; ++i) x = x * 0.999999 + 1e-6;
    seed = x;
    histogram.add(seconds_since(start));
  }
  return histogram;
}

/// Every `nth` key plays a forte stroke every 0.7 s, each a little later than the one before; 0: nobody plays.
struct Scene {
  const Keystroke* keystroke;
  int nth;
  static constexpr double kEvery = 0.7;  // [s]

  DriveSample at(int key, double time) const noexcept {
    if (nth == 0 || key % nth != 0) return {};
    const double since = time - 0.0079 * key;
    if (since < 0) return {};
    const Sample sample = keystroke->at(std::fmod(since, kEvery));
    return {sample.value, sample.rate};
  }
};

struct Cost {
  DurationHistogram time, own;  // of the clock on the wall; computed by the caller, with its waiting for the others
  double awake = 0;             // keys, mean
};

template <typename Tick>
Cost measure(const Scene& scene, Keyboard& keyboard, double duration, Tick&& advance) {
  constexpr double kWarmUp = 0.2;  // [s]
  Cost cost;
  std::vector<DriveSample> inputs(static_cast<std::size_t>(keyboard.size()));
  long periods = 0;
  while (keyboard.time() < duration + kWarmUp) {
    for (int k = 0; k < keyboard.size(); ++k)
      inputs[static_cast<std::size_t>(k)] = scene.at(k, keyboard.time() + keyboard.settings().period);
    const double computed_before = computed();
    const auto start = Clock::now();
    advance(inputs);
    const double spent = seconds_since(start);
    const double own = computed() - computed_before;
    if (keyboard.time() < kWarmUp) continue;
    cost.own.add(own);
    cost.time.add(spent);
    cost.awake += keyboard.size() - keyboard.asleep_count();
    ++periods;
  }
  cost.awake /= static_cast<double>(periods);
  return cost;
}

void print_costs(const Model& model, const Keystroke& keystroke, double duration, int worker_cpu) {
  fmt::print(
      "\n| keys | played | steps a period | threads | awake | p50 us | p99 us | p99.9 us | max us | computed p99 us | "
      "p99.9 us |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const int keys : {8, 44, 88})
    for (const auto& [played, nth] : {std::pair{"none", 0}, {"one in seven", 7}, {"all", 1}})
      for (const int steps : {1, 0})
        for (const int threads : {1, 2}) {
          TickSettings settings;
          settings.set_rate(2000, steps);
          Keyboard keyboard(model, keys, settings, SleepSettings::eager());
          const Scene scene{&keystroke, nth};
          Cost cost;
          if (threads == 1) {
            cost = measure(scene, keyboard, duration, [&](const auto& inputs) { keyboard.tick(inputs); });
          } else {
            KeyPool pool(keyboard, {worker_cpu}, 1e-3);
            cost = measure(scene, keyboard, duration, [&](const auto& inputs) { pool.tick(inputs); });
          }
          fmt::print("| {} | {} | {} | {} | {:.1f} | {} | {:.1f} | {:.1f} |\n", keys, played,
                     steps == 0 ? "default" : "1", threads, cost.awake, row_of(cost.time),
                     1e6 * cost.own.quantile(0.99), 1e6 * cost.own.quantile(0.999));
          std::fflush(stdout);
        }
}

/// A period of sleepers is shorter than a look at the clock: a thousand at a time.
void print_sleepers(const Model& model) {
  constexpr int kBatch = 1000, kBatches = 2000;
  fmt::print("\n| keys at rest | p50 ns a key | p99 | p99.9 |\n|---|---|---|---|\n");
  for (const int keys : {1, 8, 44, 88}) {
    Keyboard keyboard(model, keys, {});
    const std::vector<DriveSample> inputs(static_cast<std::size_t>(keys));
    for (int i = 0; i < 100; ++i) keyboard.tick(inputs);
    DurationHistogram time;
    for (int i = 0; i < kBatches; ++i) {
      const auto start = Clock::now();
      for (int j = 0; j < kBatch; ++j) keyboard.tick(inputs);
      time.add(seconds_since(start));
    }
    const double unit = 1e9 / kBatch / keys;
    fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} |\n", keyboard.asleep_count(), unit * time.quantile(0.5),
               unit * time.quantile(0.99), unit * time.quantile(0.999));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const double duration = argc > 1 ? std::atof(argv[1]) : 4;
  bind_caller(argc > 2 ? std::atoi(argv[2]) : 0);
  const int worker_cpu = argc > 3 ? std::atoi(argv[3]) : 1;
  const Model model = load_action(config_dir() / "grand_action.yaml").model;
  const Keystroke keystroke = read_keystroke(config_dir() / "keystrokes" / "forte.csv");
  fmt::print("Mechanism {} bytes, State {}, Workspace {}\n\n", sizeof(Mechanism), sizeof(State), sizeof(Workspace));
  fmt::print("| fixed arithmetic | p50 us | p99 us | p99.9 us | max us |\n|---|---|---|---|---|\n");
  fmt::print("| before | {} |\n", row_of(measure_noise(2)));
  print_sleepers(model);
  print_costs(model, keystroke, duration, worker_cpu);
  fmt::print("\n| fixed arithmetic | p50 us | p99 us | p99.9 us | max us |\n|---|---|---|---|---|\n");
  fmt::print("| after | {} |\n", row_of(measure_noise(2)));
}
