#include "bench/plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "erard/device/error.hpp"
#include "erard/haptics/tick.hpp"

namespace erard::bench {
namespace {

constexpr double kMainRate_Hz = 2000;
constexpr double kSharedRate_Hz = 10000;  // of the large keyboard, on two threads
constexpr int kLargeKeyboard = 88;

std::vector<std::string> all_names() {
  std::vector<std::string> names;
  for (const Scene& scene : scenes()) names.push_back(scene.name);
  return names;
}

/// Settings that are asked for at this rate, each number of steps once.
std::vector<Entrant> entrants_of(Engine engine, const Request& request, double rate_Hz) {
  TickSettings settings;
  settings.set_rate(rate_Hz);
  const bool is_split = engine == Engine::erard && settings.refinement > 1;
  if (settings.substeps == 1 && !is_split && request.cheapest && request.with_default)
    return {{engine, "both", 1, false}};
  std::vector<Entrant> entrants;
  if (request.cheapest) entrants.push_back({engine, "cheapest", 1, false});
  if (request.with_default) entrants.push_back({engine, "default", settings.substeps, is_split});
  return entrants;
}

/// Long enough for p99.9 of a stroke at the main rate; the default run stays below three minutes.
double seconds_of(const Scene& scene, double rate_Hz, const Request& request) {
  if (request.is_quick) return 0;
  const double once = scene.is_keyboard ? 1.5 : rate_Hz == kMainRate_Hz ? 3.5 : 0.7;
  return once * request.repeat;
}

/// One scene at one rate.
Match match_of(const Scene& scene, int keys, double rate_Hz, const Request& request) {
  Match match{&scene,
              keys,
              rate_Hz,
              scene.is_keyboard ? request.threads : 1,
              entrants_of(Engine::erard, request, rate_Hz),
              seconds_of(scene, rate_Hz, request)};
  for (Entrant& entrant : match.entrants) {
    entrant.may_sleep = scene.is_keyboard && request.may_sleep;
    if (scene.is_keyboard && match.threads == 1) entrant.lanes = request.lanes;
  }
  if (request.with_peers && match.threads == 1)
    for (const Entrant& peer : entrants_of(Engine::mujoco, request, rate_Hz)) match.entrants.push_back(peer);
  return match;
}

/// Whether the default plan goes beyond what one request asks of every scene.
bool has_extras(const Request& request) { return request.rates_Hz.empty() && !request.is_quick && request.cheapest; }

/// The large keyboard at the rate that takes two CPUs.
Match shared_match(const Scene& scene, const Request& request) {
  Request shared = request;
  shared.with_default = false;
  shared.threads = std::max(2, request.threads);
  return match_of(scene, kLargeKeyboard, kSharedRate_Hz, shared);
}

/// The action with the other kinds of felts, for the thesis's own figures (bench/thesis.hpp).
void add_other_felts(Match& match) {
  for (const FeltModel felts : {FeltModel::bodies, FeltModel::rigid})
    match.entrants.push_back({Engine::erard, "cheapest", 1, false, false, felts});
}

bool is_quick_scene(const Scene& scene) {
  return scene.is_keyboard || scene.name == "rest" || scene.name == "piano" || scene.name == "forte";
}

std::vector<const Scene*> chosen_scenes(const Request& request) {
  std::vector<const Scene*> chosen;
  for (const std::string& name : request.scenes) {
    if (find_scene(name) == nullptr)
      throw InputError(fmt::format("--scene {}: is not known, must be of {}", name, fmt::join(all_names(), ", ")));
    chosen.push_back(find_scene(name));
  }
  if (request.scenes.empty())
    for (const Scene& scene : scenes())
      if (!request.is_quick || is_quick_scene(scene)) chosen.push_back(&scene);
  return chosen;
}

/// Numbers of keys of this scene: those asked for that fit it.
std::vector<int> keys_of(const Scene& scene, const Request& request) {
  if (request.keys.empty())
    return !scene.is_keyboard ? std::vector{1} : request.is_quick ? std::vector{8} : std::vector{8, 44, 88};
  std::vector<int> fitting;
  for (const int keys : request.keys)
    if (scene.is_keyboard == (keys > 1)) fitting.push_back(keys);
  return fitting;
}

std::vector<double> rates_of(const Scene& scene, const Request& request) {
  if (!request.rates_Hz.empty()) return request.rates_Hz;
  if (scene.is_keyboard || request.is_quick) return {kMainRate_Hz};
  return {1000, 2000, 5000, 10000, 20000, 50000};
}

}  // namespace

const char* name_of(Engine engine) { return engine == Engine::erard ? "erard" : "mujoco"; }

const char* name_of(FeltModel felts) {
  return felts == FeltModel::rigid ? "rigid" : felts == FeltModel::bodies ? "bodies" : "massless";
}

std::vector<Match> make_plan(const Request& request) {
  if (request.threads > request.cpus)
    throw InputError(
        fmt::format("--threads = {}, must be 1 to {}: each takes a CPU of its own", request.threads, request.cpus));
  std::vector<Match> plan;
  for (const Scene* scene : chosen_scenes(request))
    for (const int keys : keys_of(*scene, request))
      for (const double rate : rates_of(*scene, request)) {
        plan.push_back(match_of(*scene, keys, rate, request));
        if (has_extras(request) && scene->name == "piano" && rate == kMainRate_Hz) add_other_felts(plan.back());
        if (has_extras(request) && scene->played == Played::all && keys == kLargeKeyboard && request.cpus >= 2)
          plan.push_back(shared_match(*scene, request));
      }
  if (plan.empty())
    throw InputError(
        "--scene and --keys leave nothing to measure: scenes of one key need --keys 1, those of a keyboard more");
  return plan;
}

}  // namespace erard::bench
