#include "erard/lanes/key_lanes.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "packing.hpp"

namespace erard {
namespace {

/// A turn while it is played.
struct Player {
  Turn* turn;
  Drive drive;      // up to the end of its last step
  double from;      // start of the step of the period that it is in [s]
  bool is_refused;  // that step
  bool is_over;     // it met a number that is not finite

  const Mechanism& mechanism(std::span<const Mechanism> all) const noexcept { return all[turn->model]; }
};

/// A scheme, as the scalar engine and the lanes are told of it.
struct LaneScheme {
  LaneScheme(const Scheme& s, DriveKind drive) noexcept
      : scheme(s),
        settings{s.time_step,
                 s.theta,
                 s.surprise_limit,
                 s.newton_limit,
                 s.newton_tolerance,
                 s.placement_tolerance,
                 s.is_friction_recalled,
                 s.sweep_limit,
                 s.sweep_tolerance,
                 drive == DriveKind::piston  ? lanes::Push::piston
                 : drive == DriveKind::force ? lanes::Push::force
                                             : lanes::Push::none} {}
  Scheme scheme;
  lanes::Settings settings;
};

/// What a step was like: lanes wait for the slowest of a batch, and are swept together where the same rows are in play, so
/// keys whose last steps were alike go together.
constexpr int kTangents = 8;  // patterns told apart: those of the first three
constexpr int kEfforts = 2 * (1 + kTangents);
int effort_of(const StepReport& stepped, unsigned tangents) noexcept {
  const int swept = stepped.sweeps > 0 ? 1 + static_cast<int>(tangents % kTangents) : 0;
  return 2 * swept + (stepped.linearisations > 1 ? 1 : 0);
}

}  // namespace

struct LanePlayer::Band {
  Band(std::span<const Mechanism> all, int key_count, const lanes::Kernel& kernel)
      : mechanisms(all),
        lane_count(kernel.lanes),
        packing(all, kernel),
        players(static_cast<std::size_t>(key_count)),
        going(players.size()),
        sorted(players.size()),
        effort(players.size(), 0),
        begin(static_cast<std::size_t>(kEfforts * packing.plan_count()) + 2) {}

  /// What the steps of a period are to be.
  void set(const TickSettings& tick) noexcept {
    settings = tick;
    whole = LaneScheme(tick.scheme, tick.drive);
    split = LaneScheme(busy_scheme(tick), tick.drive);
  }
  int class_of(const Player& player) const noexcept;
  void sort(std::size_t number) noexcept;
  void step_all(std::size_t number, const LaneScheme& scheme, double after) noexcept;
  void step_batch(std::span<Player* const> batch, const LaneScheme& scheme, double after) noexcept;
  void step_alone(Player& player, const LaneScheme& scheme, const Drive& next) noexcept;
  void enter(Player& player, const Drive& next, const StepReport& stepped) noexcept;

  std::span<const Mechanism> mechanisms;
  TickSettings settings;
  int lane_count;
  lanes::Packing packing;
  LaneScheme whole{settings.scheme, settings.drive},
      split = whole;  // steps of the scheme, and the shorter ones of those that it refuses
  std::vector<Player> players;
  std::vector<Player*> going, sorted;
  std::vector<int> effort;  // of each key's last step
  std::vector<int> begin;   // of each class among the sorted; those that no lane can step last
  Count count;
  std::unique_ptr<Workspace> work = std::make_unique<Workspace>();
  Observer observer = nullptr;
  void* context = nullptr;
};

int LanePlayer::Band::class_of(const Player& player) const noexcept {
  const int alone = kEfforts * packing.plan_count();
  const int plan = packing.plan_of(player.turn->model);
  const bool is_driven = settings.drive != DriveKind::none;
  if (plan < 0 || settings.drive == DriveKind::key) return alone;
  if (is_driven && player.mechanism(mechanisms).model.finger.body == kGround) return alone;
  return kEfforts * plan + effort[player.turn->key];
}

/// Players of a kind side by side: by structure, then by effort.
void LanePlayer::Band::sort(std::size_t number) noexcept {
  std::fill(begin.begin(), begin.end(), 0);
  for (std::size_t i = 0; i < number; ++i) ++begin[static_cast<std::size_t>(class_of(*going[i])) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  for (std::size_t i = 0; i < number; ++i) sorted[begin[class_of(*going[i])]++] = going[i];
}

/// One step of each of the first `number` of those going.
/// @param after  end of the step, from the start of the step of the period [s]
void LanePlayer::Band::step_all(std::size_t number, const LaneScheme& scheme, double after) noexcept {
  sort(number);
  // begin[c] is now where class c ends: that of a structure where its last class does
  std::size_t first = 0;
  for (int plan = 0; plan < packing.plan_count(); ++plan)
    for (const std::size_t end = begin[kEfforts * (plan + 1) - 1]; first < end;) {
      const std::size_t size = std::min(static_cast<std::size_t>(lane_count), end - first);
      step_batch({&sorted[first], size}, scheme, after);
      first += size;
    }
  for (; first < number; ++first) {
    Player& player = *sorted[first];
    step_alone(player, scheme, {settings.drive, player.drive.to, player.turn->input.at(player.from + after)});
  }
}

void LanePlayer::Band::step_batch(std::span<Player* const> batch, const LaneScheme& scheme, double after) noexcept {
  std::array<Drive, lanes::kMaxLanes> next;
  std::array<lanes::Passenger, lanes::kMaxLanes> passengers;
  for (std::size_t l = 0; l < batch.size(); ++l) {
    const Player& player = *batch[l];
    next[l] = {settings.drive, player.drive.to, player.turn->input.at(player.from + after)};
    passengers[l] = {player.turn->model, &next[l], player.turn->state, is_finite(next[l])};
  }
  ++count.batches;
  const lanes::Outcome& outcome = packing.step({passengers.data(), batch.size()}, scheme.settings);
  for (std::size_t l = 0; l < batch.size(); ++l) {
    if (!outcome.is_taken[l] && !outcome.is_refused[l]) {
      step_alone(*batch[l], scheme, next[l]);
      continue;
    }
    StepReport stepped{!outcome.is_taken[l]     ? StepStatus::refused
                       : outcome.is_at_limit[l] ? StepStatus::not_converged
                                                : StepStatus::converged,
                       outcome.linearisations[l],
                       outcome.sweeps[l],
                       outcome.newton_change[l],
                       outcome.surprise[l],
                       outcome.sweep_error[l],
                       outcome.is_taken[l] ? outcome.finger_force[l] : 0};
    if (outcome.is_taken[l]) {
      State& state = *batch[l]->turn->state;
      state.time_step = scheme.scheme.time_step;
      state.time += scheme.scheme.time_step;
    }
    ++count.in_lanes;
    effort[batch[l]->turn->key] = effort_of(stepped, outcome.tangents[l]);
    enter(*batch[l], next[l], stepped);
  }
}

void LanePlayer::Band::step_alone(Player& player, const LaneScheme& scheme, const Drive& next) noexcept {
  ++count.one_by_one;
  enter(player, next, step(player.mechanism(mechanisms), scheme.scheme, next, *player.turn->state, *work));
}

void LanePlayer::Band::enter(Player& player, const Drive& next, const StepReport& stepped) noexcept {
  Turn& turn = *player.turn;
  player.is_refused = stepped.status == StepStatus::refused;
  if (enter_step(player.mechanism(mechanisms), next, *turn.state, stepped, player.drive, turn.report))
    observer(context, turn.key, *turn.state, stepped, turn.report.force);
  else
    player.is_over = !player.is_refused;
}

LanePlayer::LanePlayer(std::span<const Mechanism> mechanisms, int key_count, InstructionSet set)
    : band_(std::make_unique<Band>(mechanisms, key_count, lanes::kernel_for(set))) {}
LanePlayer::~LanePlayer() = default;
LanePlayer::LanePlayer(LanePlayer&&) noexcept = default;

const LanePlayer::Count& LanePlayer::count() const noexcept { return band_->count; }

void LanePlayer::play(const TickSettings& settings, std::span<Turn> turns, Observer observer, void* context) noexcept {
  Band& band = *band_;
  band.set(settings);
  band.observer = observer;
  band.context = context;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    Turn& turn = turns[i];
    turn.report = {};
    band.players[i] = {
        &turn, {band.settings.drive, {}, turn.input.at(turn.state->time)}, turn.state->time, false, false};
  }
  const auto choose = [&](auto&& is_chosen) noexcept {
    std::size_t number = 0;
    for (std::size_t i = 0; i < turns.size(); ++i)
      if (!band.players[i].is_over && is_chosen(band.players[i])) band.going[number++] = &band.players[i];
    return number;
  };
  const Scheme &whole = band.whole.scheme, &split = band.split.scheme;
  for (int i = 0; i < band.settings.substeps; ++i) {
    for (std::size_t k = 0; k < turns.size(); ++k) band.players[k].from = turns[k].input.start + i * whole.time_step;
    band.step_all(choose([](const Player&) { return true; }), band.whole, whole.time_step);
    std::size_t number = choose([](const Player& player) { return player.is_refused; });
    for (int j = 1; j <= band.settings.refinement && number > 0; ++j) {
      band.step_all(number, band.split, j * split.time_step);
      const auto end = std::remove_if(band.going.begin(), band.going.begin() + static_cast<std::ptrdiff_t>(number),
                                      [](const Player* player) { return player->is_over; });
      number = static_cast<std::size_t>(end - band.going.begin());
    }
  }
}

}  // namespace erard
