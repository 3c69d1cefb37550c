#include "bench/row.hpp"

namespace erard::bench {

const Row* find_row(const std::vector<Row>& rows, const RowKey& key) {
  for (const Row& row : rows)
    if (row.engine == key.engine && row.scene == key.scene && row.keys == key.keys && row.rate_Hz == key.rate_Hz &&
        (row.setting == key.setting || row.setting == "both") && row.threads == key.threads && row.felts == key.felts)
      return &row;
  return nullptr;
}

void compare_with_peers(std::vector<Row>& rows) {
  for (Row& ours : rows)
    for (const Row& peer : rows) {
      const bool is_pair = ours.engine == Engine::erard && peer.engine != Engine::erard && ours.scene == peer.scene &&
                           ours.keys == peer.keys && ours.rate_Hz == peer.rate_Hz && ours.substeps == peer.substeps &&
                           ours.threads == peer.threads;
      if (!is_pair) continue;
      ours.times_peer_median = ours.tick.median / peer.tick.median;
      if (ours.undisturbed.count > 0 && peer.undisturbed.count > 0)
        ours.times_peer_undisturbed = ours.undisturbed.total / peer.undisturbed.total;
    }
}

}  // namespace erard::bench
