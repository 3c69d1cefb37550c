// Which scenes are measured, at which rates and settings, for how long.
#pragma once

#include <string>
#include <vector>

#include "bench/scene.hpp"

namespace erard::bench {

enum class Engine { erard, mujoco };
const char* name_of(Engine engine);
const char* name_of(FeltModel felts);  // "massless", "bodies", "rigid"

/// What a user asks for; empty lists: the choice of the default run.
struct Request {
  std::vector<std::string> scenes;
  std::vector<int> keys;
  std::vector<double> rates_Hz;
  bool cheapest = true, with_default = true;  // settings
  bool may_sleep = true;                      // keys of a keyboard
  int threads = 1;                            // of a keyboard
  std::string lanes = "off";                  // of a keyboard on one thread: one of lane_names()
  int cpus = 1;                               // that there are for them
  bool with_peers = false;
  int repeat = 1;
  bool is_quick = false;
};

/// An engine at a number of internal steps a period.
struct Entrant {
  Engine engine = Engine::erard;
  std::string setting;  // "cheapest" (one step), "default", or "both" where they are the same
  int substeps = 1;
  bool is_split = false;   // of tick()'s default: at least so many steps
  bool may_sleep = false;  // keys that rest are left alone
  FeltModel felts = FeltModel::massless;
  std::string lanes = "off";
};

/// Entrants that play the same scene at the same rate, in turn, slice by slice: what the machine does meanwhile meets
/// all of them.
struct Match {
  const Scene* scene = nullptr;
  int keys = 1;
  double rate_Hz = 2000;
  int threads = 1;
  std::vector<Entrant> entrants;
  double seconds = 0;  // of timed play for each entrant; five passes at least, one when this is 0
};

/// One key on 1 to 50 kHz, longest on 2 kHz; 8, 44 and 88 keys on 2 kHz, and 88 on 10 kHz with two threads where there
/// are CPUs for them. On two threads the peer, which has one, does not play.
/// Throws InputError where the request does not fit: scenes that are not known, scenes of one key for many, more threads
/// than CPUs.
std::vector<Match> make_plan(const Request& request);

}  // namespace erard::bench
