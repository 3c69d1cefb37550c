// Plays one scene for tools/count-instructions and tools/profile-step: valgrind counts what counted_tick() executes, and
// nothing else.
//   count_scene SCENE SETTING        prints the number of internal steps that were counted
//   count_scene SCENE --least-work   prints the operations that a cheapest step of it needs at least, by phase
//   count_scene --build              prints what the number of instructions depends on
// SCENE: a scene of one key; SETTING: cheapest or default, at 2 kHz. With the damper: all of the action.
#include <fmt/format.h>
#include <gnu/libc-version.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <string>

#include "bench/build.hpp"
#include "bench/contender.hpp"
#include "bench/least_work.hpp"
#include "erard/haptics/tick.hpp"
#include "erard/mechanics/rest.hpp"

namespace {

using namespace erard;

constexpr double kRate_Hz = 2000;
constexpr double kRest = 0.1;  // [s] of rest that are counted

/// One period. Not inlined: its name is what valgrind looks for.
[[gnu::noinline]] void counted_tick(bench::Contender& contender) { contender.tick({}); }

bench::Job job_of(const bench::Scene& scene, bool is_cheapest) {
  TickSettings settings;
  settings.set_rate(kRate_Hz, is_cheapest ? 1 : 0);
  return {&scene, 1, kRate_Hz, settings.substeps, settings.refinement > 1};
}

long ticks_of(const bench::Scene& scene) { return std::lround((scene.release > 0 ? scene.release : kRest) * kRate_Hz); }

/// "phase operations" a line, means over the steps of the scene.
int print_least_work(const bench::Scene& scene) {
  const bench::Stage stage = bench::load_stage(true);
  const Mechanism& mechanism = stage.mechanism();
  TickSettings settings;
  settings.set_rate(kRate_Hz, 1);
  State state = rest_state(mechanism, settings.scheme.time_step);
  const auto work = std::make_unique<Workspace>();
  const bench::Part part = bench::cast(scene, stage, 1).front();
  bench::Work sum{};
  const long ticks = ticks_of(scene);
  for (long i = 0; i < ticks; ++i) {
    tick(mechanism, settings, part, state, *work, [](auto&&...) noexcept {});
    const bench::Work least = bench::least_work(mechanism, state);
    for (std::size_t p = 0; p < least.size(); ++p) sum[p] += least[p];
  }
  for (int p = 0; p < bench::kPhases; ++p)
    fmt::print("{}\t{:.1f}\n", bench::name_of(static_cast<bench::Phase>(p)),
               sum[static_cast<std::size_t>(p)] / static_cast<double>(ticks));
  return 0;
}

int count(const bench::Scene& scene, bool is_cheapest) {
  const bench::Stage stage = bench::load_stage(true);
  const bench::Job job = job_of(scene, is_cheapest);
  const auto contender = bench::make_erard(stage, job);
  const long ticks = ticks_of(scene);
  for (long i = 0; i < ticks; ++i) counted_tick(*contender);
  fmt::print("{}\n", ticks * job.substeps);
  return 0;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string first = argc > 1 ? argv[1] : "", setting = argc > 2 ? argv[2] : "";
  if (argc == 2 && first == "--build") {
    fmt::print("{}; Eigen {}.{}.{}; glibc {}\n", bench::build_compiler(), EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION,
               EIGEN_MINOR_VERSION, gnu_get_libc_version());
    return 0;
  }
  const bench::Scene* scene = bench::find_scene(first);
  const bool is_known = setting == "cheapest" || setting == "default" || setting == "--least-work";
  if (scene == nullptr || scene->is_keyboard || !is_known) {
    fmt::print(stderr, "usage: count_scene SCENE cheapest|default|--least-work, or count_scene --build\n");
    return 2;
  }
  if (setting == "--least-work") return print_least_work(*scene);
  return count(*scene, setting == "cheapest");
} catch (const std::exception& error) {
  fmt::print(stderr, "count_scene: {}\n", error.what());
  return 1;
}
