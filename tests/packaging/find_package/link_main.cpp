// A host that listens to LCM, at a free port of this machine.
#include <erard/device/link.hpp>

#include <cstdio>

int main() {
  const erard::Receiver<erard::positions_t> receiver("udpm://127.0.0.1:0", erard::kPositionsChannel);
  std::printf("listening at %s\n", receiver.listener().address().to_string().c_str());
  return receiver.listener().address().port != 0 && receiver.counts().accepted == 0 ? 0 : 1;
}
