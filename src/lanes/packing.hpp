// Keys into lanes and back.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "kernels.hpp"
#include "plan.hpp"
#include "erard/solver/step.hpp"

namespace erard::lanes {

/// Memory for vectors of any instruction set.
class AlignedDoubles {
 public:
  explicit AlignedDoubles(std::size_t count) : storage_(count + kAlignment / sizeof(double)) {
    void* begin = storage_.data();
    std::size_t room = storage_.size() * sizeof(double);
    data_ = static_cast<double*>(std::align(kAlignment, count * sizeof(double), begin, room));
  }
  double* data() const noexcept { return data_; }

 private:
  static constexpr std::size_t kAlignment = 64;
  std::vector<double> storage_;
  double* data_;
};

/// One key in its lane.
struct Passenger {
  int model;  // by Turn::model
  const Drive* drive;
  State* state;
  bool is_driven_by_numbers;  // else its step is not taken
};

/// Buffers of one batch. A lane without a key repeats the first.
class Packing {
 public:
  Packing(std::span<const Mechanism> mechanisms, const Kernel& kernel);

  /// Number of the structure of a model, or -1 where lanes cannot step it.
  int plan_of(int model) const noexcept { return plan_of_[model]; }
  int plan_count() const noexcept { return static_cast<int>(plans_.size()); }

  /// Steps up to kernel.lanes keys of one structure. The states of those taken are at the end of the step.
  const Outcome& step(std::span<const Passenger> passengers, const Settings& settings) noexcept;

 private:
  void load_numbers(std::span<const Passenger> passengers, const Plan& plan) noexcept;
  void load(std::span<const Passenger> passengers, const Plan& plan) noexcept;
  void store(std::span<const Passenger> passengers, const Plan& plan) const noexcept;

  const Kernel& kernel_;
  const Calls& calls_;
  std::vector<Plan> plans_;
  std::vector<int> plan_of_;                    // of each model
  std::vector<ActionNumbers<double>> numbers_;  // of each model
  int loaded_[kMaxLanes];                       // model whose numbers stand in each lane
  AlignedDoubles action_, state_, drive_, work_;
  Outcome outcome_;
};

}  // namespace erard::lanes
