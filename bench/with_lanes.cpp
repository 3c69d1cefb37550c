#include "bench/lanes.hpp"
#include "erard/lanes/key_lanes.hpp"

namespace erard::bench {
namespace {

/// As people call it: the baseline of every x86-64 is SSE2.
std::string lane_name(InstructionSet set) { return set == InstructionSet::baseline ? "sse2" : name_of(set); }

class InLanes : public Lanes {
 public:
  InLanes(Keyboard& keyboard, InstructionSet set) : lanes_(keyboard, set) {}
  void tick(std::span<const DriveSample> inputs) noexcept override { lanes_.tick(inputs); }

 private:
  KeyLanes lanes_;
};

}  // namespace

std::vector<std::string> lane_names() {
  std::vector<std::string> names;
  for (const InstructionSet set : kInstructionSets)
    if (is_available(set)) names.push_back(lane_name(set));
  return names;
}

std::unique_ptr<Lanes> make_lanes(Keyboard& keyboard, const std::string& name) {
  for (const InstructionSet set : kInstructionSets)
    if (lane_name(set) == name) return std::make_unique<InLanes>(keyboard, set);
  return nullptr;
}

}  // namespace erard::bench
