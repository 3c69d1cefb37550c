// Without MuJoCo there is no peer.
#include "bench/contender.hpp"

namespace erard::bench {

std::string mujoco_version() { return {}; }
std::unique_ptr<Contender> make_mujoco(const Stage&, const Job&) { return nullptr; }

}  // namespace erard::bench
