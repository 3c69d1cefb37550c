// lcm_echo: takes every message type from the device's address and sends it on to the host's, on the channel of its
// name. Says "ready" when it listens, ends with its standard input.
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <tuple>

#include "erard/device/link.hpp"

namespace {

template <typename Message>
struct Echo {
  erard::Receiver<Message> receiver{erard::kDeviceUrl, Message::getTypeName(), erard::ListenerSettings{0}};

  bool pass_on(erard::Sender& sender) {
    for (Message message; receiver.take(message);)
      if (!sender.publish(Message::getTypeName(), message)) return false;
    return true;
  }
};

}  // namespace

int main() {
  using namespace erard;
  Sender sender(kHostUrl);
  std::tuple<Echo<positions_t>, Echo<forces_t>, Echo<actuator_commands_t>, Echo<host_status_t>, Echo<hammer_event_t>,
             Echo<action_state_t>>
      echoes;
  std::puts("ready");
  std::fflush(stdout);
  for (pollfd input{STDIN_FILENO, POLLIN, 0}; poll(&input, 1, 1) == 0;)
    if (!std::apply([&](auto&... echo) { return (echo.pass_on(sender) && ...); }, echoes)) return 1;
  return 0;
}
