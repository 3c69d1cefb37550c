// What is timed: an engine that plays a scene, period by period.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bench/clock.hpp"
#include "bench/scene.hpp"

namespace erard::bench {

/// Of one period, all keys and internal steps together.
struct Effort {
  long iterations = 0;     // Newton linearisations; of a peer the iterations of its solver
  long sweeps = 0;         // of the solver inside; 0 when a peer has none
  long steps = 0;          // internal, taken; 0: not counted, nor are the two above
  long not_converged = 0;  // periods of a key with a step that reached a limit
  long asleep = 0;         // keys that were left alone
  bool is_finite = true;

  Effort& operator+=(const Effort& other) noexcept {
    iterations += other.iterations;
    sweeps += other.sweeps;
    steps += other.steps;
    not_converged += other.not_converged;
    asleep += other.asleep;
    is_finite = is_finite && other.is_finite;
    return *this;
  }
};

/// Looks at the clock after every internal step, when there is somebody who wants to know.
class StepClock {
 public:
  StepClock() = default;
  explicit StepClock(std::int64_t* ends) : next_(ends) {}
  void mark() noexcept {
    if (next_ != nullptr) *next_++ = now();
  }

 private:
  std::int64_t* next_ = nullptr;
};

class Contender {
 public:
  virtual ~Contender() = default;

  /// Strokes: rest, time 0. Keyboards: every key has begun its part, one whole period of it has been played since rest.
  /// From here on every call with the same number does the same, to the bit.
  virtual void start() = 0;

  /// Gets ready what a host would hand over for the next period.
  virtual void prepare() {}

  /// One period of every key: what is timed.
  virtual void tick(StepClock steps) = 0;

  /// What that period took.
  virtual Effort effort() const = 0;

  /// Of the finger on the first key at the end of the period [N].
  virtual double force() const = 0;
};

/// What a contender is to play, and how.
struct Job {
  const Scene* scene = nullptr;
  int keys = 1;
  double rate_Hz = 2000;
  int substeps = 1;
  bool is_split = false;           // into shorter ones where the motion is not as guessed; the peer has no such steps
  bool may_sleep = false;          // keys of a keyboard that rest are left alone; the peer has nothing like that
  std::vector<int> worker_cpus{};  // of a keyboard: that many threads more, each on a CPU of its own; the peer has none
  std::string lanes = "off";       // of a keyboard on one thread: one of lane_names(); of the peer: off
  FeltModel felts = FeltModel::massless;  // of the peer: always bodies
};

/// Both keep references to the stage.
std::unique_ptr<Contender> make_erard(const Stage& stage, const Job& job);
std::unique_ptr<Contender> make_mujoco(const Stage& stage, const Job& job);  // null when it is not installed

/// Name and version of the peer; empty when it is not installed.
std::string mujoco_version();

}  // namespace erard::bench
