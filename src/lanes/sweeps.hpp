// The lanes of a batch sweep together where the same rows are in play.
#pragma once

#include "gauss_seidel.hpp"

namespace erard::lanes {

/// Solves the one-step problems of some lanes, those with the same rows in play together. Rows out of play: 0.
template <typename T>
void sweep(const Batch& batch, const Mask<T>& is_wanted, Sweeps<T>& sweeps, Work<T>& work) noexcept {
  const int size = batch.plan->friction_row_count;
  for (int r = 0; r < size; ++r)
    work.row_impulse[r] = select(is_wanted & work.is_in_play[r], work.row_impulse[r], T(0.0));
  Mask<T> is_left = is_wanted;
  while (any(is_left)) {
    // those that have in play what the first of them has
    bool lanes[kMaxLanes], in_play[kMaxLanes];
    is_left.store_unaligned(lanes);
    int first = 0;
    while (!lanes[first]) ++first;
    RowsInPlay rows;
    unsigned tangents = 0;
    Mask<T> is_alike = is_left;
    for (int r = 0; r < size; ++r) {
      work.is_in_play[r].store_unaligned(in_play);
      if (in_play[first]) {
        rows.is_angular[rows.count] = batch.plan->friction_row[r].is_angular;
        rows.row[rows.count++] = r;
      }
      if (in_play[first] && batch.plan->friction_row[r].contact >= 0) tangents |= 1u << r;
      is_alike = is_alike & (in_play[first] ? work.is_in_play[r] : !work.is_in_play[r]);
    }
    sweep_alike(batch, rows, is_alike, sweeps, work);
    is_alike.store_unaligned(lanes);
    for (int l = 0; l < Work<T>::kLanes; ++l)
      if (lanes[l]) sweeps.tangents[l] = tangents;
    is_left = is_left & !is_alike;
  }
}

}  // namespace erard::lanes
