// Does a recorded session give its forces again?
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

namespace erard {

/// What came out.
struct Verification {
  std::int64_t periods = 0;            // that were computed again
  std::int64_t messages = 0;           // positions that went in
  std::int64_t differing = 0;          // periods with a force of other bits
  std::int64_t first_difference = -1;  // number of the first of them; -1: none
  int key = 0;                         // and its first key, what was recorded and what was computed there [N]
  double recorded = 0, computed = 0;
  double largest = 0;         // difference of any force [N]
  bool has_gap = false;       // the recorder lost events: nothing can be told from there on
  bool is_cut_short = false;  // the file ends within an event, or without its end

  bool is_same() const noexcept { return periods > 0 && differing == 0; }
};

/// Feeds the recorded positions to the renderer, with the host times of the recorded periods, and compares its forces
/// with those recorded, bit by bit.
/// @param goes_on  asked after every period; no: the result is that of the periods so far
/// Throws InputError when the file is no recording of erard-device, or is damaged.
Verification verify_session(const std::filesystem::path& file, const std::function<bool(const Verification&)>& goes_on);

}  // namespace erard
