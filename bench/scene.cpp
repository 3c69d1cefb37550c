#include "bench/scene.hpp"

#include <algorithm>
#include <cmath>

#include "erard/device/action_file.hpp"
#include "erard/device/config_dir.hpp"

namespace erard::bench {
namespace {

constexpr double kPeriod = 0.6;  // of a keyboard's strokes, the length of piano and forte; of rest [s]
constexpr int kSome = 8;

}  // namespace

const std::vector<Scene>& scenes() {
  // Releases: piano and forte as in docs/accuracy.md; the others where Y has left its plateau by less than 1 %.
  static const std::vector<Scene> all{
      {"rest", "one key at rest", "", 0, false, Played::none},
      {"piano", "one key, a piano stroke", "piano", 0.220, false, Played::none},
      {"forte", "one key, a forte stroke", "forte", 0.142, false, Played::none},
      {"repetition", "one key, two strokes, the second from half-way up", "repetition", 0.440, false, Played::none},
      {"recorded_fast", "one key, a fast strike recorded on a grand", "recorded_fast", 0.900, false, Played::none},
      {"keyboard_none", "many keys at rest", "", 0, true, Played::none},
      {"keyboard_some", "many keys, eight of them played (half of them, if fewer)", "", 0, true, Played::some},
      {"keyboard_all", "many keys, all of them played", "", 0, true, Played::all},
  };
  return all;
}

const Scene* find_scene(std::string_view name) {
  const auto& all = scenes();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Scene& scene) { return scene.name == name; });
  return found == all.end() ? nullptr : &*found;
}

DriveSample Part::at(double time) const noexcept {
  if (keystroke == nullptr || time < delay) return {};
  const double since = time - delay;
  const Sample sample = keystroke->at(period > 0 ? std::fmod(since, period) : since);
  return {sample.value, sample.rate};
}

Stage load_stage(bool with_damper) {
  ActionOptions options;
  options.damper = with_damper;
  Stage stage{{}, with_damper, {}};
  for (const FeltModel felts : {FeltModel::massless, FeltModel::bodies, FeltModel::rigid}) {
    options.felts = felts;
    stage.mechanisms.emplace(felts, build_mechanism(load_action(config_dir() / "grand_action.yaml", options).model));
  }
  for (const Scene& scene : scenes())
    if (!scene.keystroke.empty())
      stage.keystrokes.emplace(scene.keystroke,
                               read_keystroke(config_dir() / "keystrokes" / (scene.keystroke + ".csv")));
  return stage;
}

int played_keys(Played played, int keys) {
  if (played == Played::none) return 0;
  return played == Played::all ? keys : std::min(kSome, keys / 2);
}

double duration_of(const Scene& scene, const Stage& stage) {
  return scene.keystroke.empty() ? kPeriod : stage.keystrokes.at(scene.keystroke).end();
}

std::vector<Part> cast(const Scene& scene, const Stage& stage, int keys) {
  std::vector<Part> parts(static_cast<std::size_t>(keys));
  if (!scene.is_keyboard) {
    if (!scene.keystroke.empty()) parts[0].keystroke = &stage.keystrokes.at(scene.keystroke);
    return parts;
  }
  const int played = played_keys(scene.played, keys);
  for (int i = 0; i < played; ++i) {
    const int key = i * keys / played;
    parts[static_cast<std::size_t>(key)] = {&stage.keystrokes.at(i % 2 == 0 ? "forte" : "piano"), kPeriod,
                                            phase_of(key) * kPeriod};
  }
  return parts;
}

double phase_of(int key) {
  constexpr double kGolden = 0.61803398874989485;  // (sqrt 5 - 1) / 2
  return std::fmod((key + 1) * kGolden, 1.0);
}

}  // namespace erard::bench
