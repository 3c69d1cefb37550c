#include "bench/row.hpp"

namespace erard::bench {

void compare_with_peers(std::vector<Row>& rows) {
  for (Row& ours : rows)
    for (const Row& peer : rows) {
      const bool is_pair = ours.engine == Engine::erard && peer.engine != Engine::erard && ours.scene == peer.scene &&
                           ours.keys == peer.keys && ours.rate_Hz == peer.rate_Hz && ours.substeps == peer.substeps;
      if (!is_pair) continue;
      ours.times_peer_median = ours.tick.median / peer.tick.median;
      if (ours.undisturbed.count > 0 && peer.undisturbed.count > 0)
        ours.times_peer_undisturbed = ours.undisturbed.total / peer.undisturbed.total;
    }
}

}  // namespace erard::bench
