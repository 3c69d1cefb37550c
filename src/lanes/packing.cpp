#include "packing.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "calls.hpp"

namespace erard::lanes {
namespace {

template <typename Numbers>
constexpr std::size_t kCount = sizeof(Numbers) / sizeof(double);

constexpr int kTimeStep = offsetof(StateNumbers<double>, time_step) / sizeof(double);

/// Visits the numbers of a State, each with its place in StateNumbers.
template <typename AnyState, typename Visit>
void each_number(const Plan& plan, AnyState& state, Visit&& visit) noexcept {
  constexpr int kX = offsetof(StateNumbers<double>, x) / sizeof(double);
  constexpr int kV = offsetof(StateNumbers<double>, v) / sizeof(double);
  constexpr int kAcceleration = offsetof(StateNumbers<double>, acceleration) / sizeof(double);
  constexpr int kCompression = offsetof(StateNumbers<double>, compression) / sizeof(double);
  constexpr int kImpulse = offsetof(StateNumbers<double>, impulse) / sizeof(double);
  for (int i = 0; i < plan.body_count; ++i) {
    visit(kX + i, state.x[i]);
    visit(kV + i, state.v[i]);
    visit(kAcceleration + i, state.acceleration[i]);
  }
  for (int c = 0; c < plan.contact_count; ++c) visit(kCompression + c, state.compression[plan.contact[c].number]);
  for (int k = 0; k < plan.row_count; ++k) visit(kImpulse + k, state.impulse[k]);
}

}  // namespace

Packing::Packing(std::span<const Mechanism> mechanisms, const Kernel& kernel)
    : kernel_(kernel),
      calls_(calls()),
      action_(kCount<ActionNumbers<double>> * kMaxLanes),
      state_(kCount<StateNumbers<double>> * kMaxLanes),
      drive_(kCount<DriveNumbers<double>> * kMaxLanes),
      work_(kernel.work_size / sizeof(double)) {
  std::fill(std::begin(loaded_), std::end(loaded_), -1);
  for (const Mechanism& mechanism : mechanisms) {
    const std::optional<Plan> plan = lanes::plan_of(mechanism);
    numbers_.push_back(plan ? numbers_of(mechanism, *plan) : ActionNumbers<double>{});
    if (!plan) {
      plan_of_.push_back(-1);
      continue;
    }
    const auto same = std::find(plans_.begin(), plans_.end(), *plan);
    plan_of_.push_back(static_cast<int>(same - plans_.begin()));
    if (same == plans_.end()) plans_.push_back(*plan);
  }
}

void Packing::load_numbers(std::span<const Passenger> passengers, const Plan& plan) noexcept {
  constexpr int kBody = offsetof(ActionNumbers<double>, body) / sizeof(double);
  constexpr int kContact = offsetof(ActionNumbers<double>, contact) / sizeof(double);
  const int body_end = kBody + plan.body_count * static_cast<int>(kCount<BodyNumbers<double>>);
  const int contact_end = kContact + plan.contact_count * static_cast<int>(kCount<ContactNumbers<double>>);
  for (int l = 0; l < kernel_.lanes; ++l) {
    const int model = passengers[l < static_cast<int>(passengers.size()) ? l : 0].model;
    if (loaded_[l] == model) continue;
    loaded_[l] = model;
    const double* const from = reinterpret_cast<const double*>(&numbers_[model]);
    double* const to = action_.data() + l;
    for (int i = 0; i < body_end; ++i) to[i * kernel_.lanes] = from[i];
    for (int i = kContact; i < contact_end; ++i) to[i * kernel_.lanes] = from[i];
  }
}

void Packing::load(std::span<const Passenger> passengers, const Plan& plan) noexcept {
  const int lanes = kernel_.lanes;
  for (int l = 0; l < lanes; ++l) {
    const Passenger& passenger = passengers[l < static_cast<int>(passengers.size()) ? l : 0];
    double* const to = state_.data() + l;
    each_number(plan, std::as_const(*passenger.state), [&](int i, double value) noexcept { to[i * lanes] = value; });
    to[kTimeStep * lanes] = passenger.state->time_step;
    const Drive& drive = *passenger.drive;
    double* const drives = drive_.data() + l;
    drives[0] = drive.from.value;
    drives[lanes] = drive.from.rate;
    drives[2 * lanes] = drive.to.value;
    drives[3 * lanes] = drive.to.rate;
  }
}

void Packing::store(std::span<const Passenger> passengers, const Plan& plan) const noexcept {
  for (int l = 0; l < static_cast<int>(passengers.size()); ++l) {
    if (!outcome_.is_taken[l]) continue;
    const double* const from = state_.data() + l;
    each_number(plan, *passengers[l].state, [&](int i, double& value) noexcept { value = from[i * kernel_.lanes]; });
  }
}

const Outcome& Packing::step(std::span<const Passenger> passengers, const Settings& settings) noexcept {
  const Plan& plan = plans_[plan_of_[passengers.front().model]];
  load_numbers(passengers, plan);
  load(passengers, plan);
  bool is_used[kMaxLanes] = {};
  for (std::size_t l = 0; l < passengers.size(); ++l) is_used[l] = passengers[l].is_driven_by_numbers;
  kernel_.step(
      {&plan, &settings, &calls_, action_.data(), drive_.data(), state_.data(), is_used, &outcome_, work_.data()});
  store(passengers, plan);
  return outcome_;
}

}  // namespace erard::lanes
