"""Every message type and both kinds of log between Python's LCM and erard, with the LCM library erard was linked to and
with that of the Python package. Runs in a network of its own (in_own_network); exit code 77: the package is missing."""
import argparse
import os
import pathlib
import random
import re
import socket
import struct
import subprocess
import sys
import tempfile
import time

DEVICE_GROUP, HOST_GROUP = ("239.255.76.67", 7667), ("239.255.76.68", 7668)
ROOT = pathlib.Path(__file__).resolve().parent.parent
PYTHON = ROOT / "build/python/bin/python"  # of tools/install-python-lcm
INTEGERS = {"int8_t": 7, "int32_t": 31, "int64_t": 63}  # bits of value


def url(group):
    return "udpm://%s:%d?ttl=0" % group


def draw(kind, generator):
    """A value of an LCM type that uses all of its bits."""
    if kind == "double":
        return generator.uniform(-1e3, 1e3)
    if kind == "boolean":
        return generator.random() < 0.5
    return generator.randrange(-2 ** INTEGERS[kind], 2 ** INTEGERS[kind])


def fields_of(message_type):
    """Type, name and length (None: one value) of each field, from the .lcm file: older lcm-gen writes no types."""
    text = (ROOT / f"messages/{message_type.__name__}.lcm").read_text()
    fields = re.findall(r"^    (\w+) (\w+)(?:\[(\d+)\])?;", text, re.MULTILINE)
    assert [name for _, name, _ in fields] == list(message_type.__slots__)
    return fields


def filled(message_type, generator):
    message = message_type()
    for kind, name, length in fields_of(message_type):
        value = [draw(kind, generator) for _ in range(int(length))] if length else draw(kind, generator)
        setattr(message, name, value)
    return message


def values(message):
    return {name: list(value) if isinstance(value, (list, tuple)) else value
            for name, value in ((name, getattr(message, name)) for name in message.__slots__)}


def send_the_deadly_pair(channel):
    """The two fragments that kill subscribers of LCM 1.3.1's library."""
    raw = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    raw.sendto(struct.pack(">4sIIIHH", b"LC03", 7, 100, 0, 0, 2) + channel.encode() + b"\0abc", DEVICE_GROUP)
    raw.sendto(struct.pack(">4sIIIHH", b"LC03", 7, 100, 0xFFFFFFF0, 1, 2) + 40 * b"x", DEVICE_GROUP)


def check_echo(program, environment, wanted_library):
    """Python encodes, erard decodes and encodes, Python decodes: all fields of all types as they were."""
    generator = random.Random(1)
    echo = subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment, text=True)
    try:
        assert echo.stdout.readline() == "ready\n"
        libraries = [line.split()[-1] for line in open(f"/proc/{echo.pid}/maps") if "liblcm" in line]
        assert wanted_library in libraries[0], f"{libraries[0]} is not {wanted_library}"
        inlet, outlet = lcm.LCM(url(HOST_GROUP)), lcm.LCM(url(DEVICE_GROUP))
        for message_type in TYPES:
            name = message_type.__name__
            received = []
            subscription = inlet.subscribe(name, lambda channel, data: received.append(data))
            sent = filled(message_type, generator)
            send_the_deadly_pair(name)
            outlet.publish(name, sent.encode())
            assert inlet.handle_timeout(30000) > 0, f"{name}: no answer"
            assert values(message_type.decode(received[0])) == values(sent), name
            inlet.unsubscribe(subscription)
        print(f"{len(TYPES)} types there and back through {libraries[0]}")
    finally:
        echo.communicate(timeout=30)
    assert echo.returncode == 0


def check_logs(replay, folder):
    """Python reads what erard-replay wrote, and erard-replay what Python wrote."""
    keystroke, log, copy = folder / "keystroke.csv", folder / "python.lcm", folder / "erard.lcm"
    keystroke.write_text("t_s,position_m\n0,0\n0.1,0.001\n")
    subprocess.run([replay, keystroke, "--rate", "100", "--keys", "88", "--url", f"file://{copy}?mode=w"], check=True,
                   stdout=subprocess.DEVNULL)
    messages = [erard.positions_t.decode(event.data) for event in lcm.EventLog(str(copy), "r")]
    assert [message.sequence for message in messages] == list(range(1, 12))
    assert list(messages[-1].position_m) == 88 * [0.001]

    written = [filled(erard.positions_t, random.Random(i)) for i in range(5)]
    with_log = lcm.EventLog(str(log), "w", overwrite=True)
    for i, message in enumerate(written):
        message.publisher_id, message.device_time_ns = 1, i * 1000000
        with_log.write_event(i * 1000, "ERARD_POSITIONS", message.encode())
    with_log.close()
    inlet = lcm.LCM(url(DEVICE_GROUP))
    received = []
    inlet.subscribe("ERARD_POSITIONS", lambda channel, data: received.append(erard.positions_t.decode(data)))
    subprocess.run([replay, log], check=True, stdout=subprocess.DEVNULL)
    end = time.monotonic() + 30
    while len(received) < len(written) and time.monotonic() < end:
        inlet.handle_timeout(100)
    assert [list(message.position_m) for message in received] == [list(message.position_m) for message in written]
    assert all(message.publisher_id > 1 for message in received)
    print("logs of Python and of erard-replay read by the other")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--echo", required=True)
    parser.add_argument("--replay", required=True)
    parser.add_argument("--messages", required=True)
    options = parser.parse_args()
    try:
        import lcm
    except ImportError:
        if PYTHON.exists() and sys.executable != str(PYTHON):
            os.execv(PYTHON, [str(PYTHON), *sys.argv])
        print("SKIPPED: Python has no package lcm; run tools/install-python-lcm")
        sys.exit(77)
    sys.path.insert(0, options.messages)
    import erard

    TYPES = [erard.positions_t, erard.forces_t, erard.actuator_commands_t, erard.host_status_t, erard.hammer_event_t,
             erard.action_state_t]
    check_echo(options.echo, dict(os.environ), "liblcm")
    newer = pathlib.Path(lcm.__file__).parent.parent / "lib"
    check_echo(options.echo, dict(os.environ, LD_LIBRARY_PATH=str(newer)), f"{newer}/")
    with tempfile.TemporaryDirectory() as temporary:
        check_logs(options.replay, pathlib.Path(temporary))
