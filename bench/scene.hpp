// What is played in front of the clock: rest, strokes on one key, keyboards.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "erard/device/action_file.hpp"
#include "erard/device/keystroke.hpp"
#include "erard/mechanics/mechanism.hpp"
#include "erard/solver/drive.hpp"

namespace erard::bench {

enum class Played { none, some, all };

/// One thing to play. Drive `piston` throughout; a key that is not played has the piston at Y = 0.
struct Scene {
  std::string name;
  std::string what;       // for people
  std::string keystroke;  // on one key, a file of config/keystrokes; empty: rest, or a keyboard
  double release = 0;     // of its last stroke: errors are told up to here [s]; 0: none
  bool is_keyboard = false;
  Played played = Played::none;  // of a keyboard
};

const std::vector<Scene>& scenes();

/// The scene of that name, or null.
const Scene* find_scene(std::string_view name);

/// What moves one key, as input of tick().
struct Part {
  const Keystroke* keystroke = nullptr;  // null: piston at 0
  double period = 0;                     // the keystroke starts anew after this [s]; 0: never
  double delay = 0;                      // the piston is at 0 before [s]
  DriveSample at(double time) const noexcept;
};

/// All that scenes need, loaded once.
struct Stage {
  std::map<FeltModel, Mechanism> mechanisms;
  bool has_damper = true;
  std::map<std::string, Keystroke> keystrokes;

  const Mechanism& mechanism(FeltModel felts = FeltModel::massless) const { return mechanisms.at(felts); }
};

/// The grand action, with felts of each kind, and the keystrokes of all scenes. Throws InputError.
Stage load_stage(bool with_damper);

/// How many of a keyboard's keys are played: all; eight, but at most half of them; none.
int played_keys(Played played, int keys);

/// Simulated time after which a scene begins anew [s]: the keystroke, or 0.6 s of rest or of a keyboard.
double duration_of(const Scene& scene, const Stage& stage);

/// What each key plays. On a keyboard the played keys are spread evenly; forte and piano in turn, again and again. After
/// duration_of() every key has begun.
std::vector<Part> cast(const Scene& scene, const Stage& stage, int keys);

/// When the part of this key of a keyboard begins, a share of its period: multiples of the golden ratio, so that no two
/// keys are in phase and every moment of a stroke is on some key at any time.
double phase_of(int key);

}  // namespace erard::bench
