// Several keys of a keyboard stepped at once, one in each lane of the CPU's vector registers.
#pragma once

#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "erard/haptics/keyboard.hpp"
#include "erard/lanes/instruction_set.hpp"

namespace erard {

/// Plays turns as erard::tick() does, with the same bits: what lanes would round otherwise is left to the scalar code, and
/// a lane whose sweeps do not converge is stepped by it anew.
///
/// Keys of one structure (bodies, contacts, rows) share batches, whatever their numbers. Stepped one by one are mechanisms
/// with felt bodies or contacts without felt, and the drive `key`. Once built: no heap, no exceptions, no locks. One thread
/// at a time.
class LanePlayer {
 public:
  using Observer = KeyboardPlayer::Observer;

  /// @param mechanisms  by Turn::model; they must outlive the player
  /// @param set         must be available
  LanePlayer(std::span<const Mechanism> mechanisms, int key_count, InstructionSet set);
  ~LanePlayer();
  LanePlayer(LanePlayer&&) noexcept;

  void play(const TickSettings& settings, std::span<Turn> turns, Observer observer, void* context) noexcept;

  /// Steps so far.
  struct Count {
    long in_lanes = 0, one_by_one = 0;
    long batches = 0;
  };
  const Count& count() const noexcept;

 private:
  struct Band;
  std::unique_ptr<Band> band_;
};

/// A Keyboard advanced in lanes, on one thread. The keyboard must outlive it and be advanced by nobody else meanwhile.
class KeyLanes final : public KeyboardPlayer {
 public:
  explicit KeyLanes(Keyboard& keyboard, InstructionSet set = best_instruction_set())
      : keyboard_(keyboard),
        player_(keyboard.mechanisms(), keyboard.size(), set),
        turns_(static_cast<std::size_t>(keyboard.size())) {}

  /// The observer sees the steps of each key in their order, keys mixed.
  std::span<const double> tick(std::span<const DriveSample> inputs, Observer observer,
                               void* context) noexcept override {
    keyboard_.begin_tick(inputs);
    keyboard_.tick_share_by(
        [&](std::span<Turn> turns) noexcept { player_.play(keyboard_.budget().settings(), turns, observer, context); },
        0, 1, inputs, turns_);
    keyboard_.end_tick();
    return keyboard_.forces();
  }
  template <typename Callee>
  std::span<const double> tick(std::span<const DriveSample> inputs, Callee&& observer) noexcept {
    const auto pass_on = [](void* context, int key, const State& state, const StepReport& report,
                            double force) noexcept {
      (*static_cast<std::remove_reference_t<Callee>*>(context))(key, state, report, force);
    };
    return tick(inputs, pass_on, const_cast<void*>(static_cast<const void*>(&observer)));
  }
  std::span<const double> tick(std::span<const DriveSample> inputs) noexcept {
    return tick(inputs, [](int, const State&, const StepReport&, double) noexcept {});
  }

  const LanePlayer::Count& count() const noexcept { return player_.count(); }

 private:
  Keyboard& keyboard_;
  LanePlayer player_;
  std::vector<Turn> turns_;
};

}  // namespace erard
