"""An algorithm that misbehaves, in the protocol's bare bytes and with no library: `peer.py HOW [SECONDS]`.

Up to frame 3 (or 30) all of them are good; HOW says what then goes wrong.
"""

import json
import os
import signal
import struct
import subprocess
import sys
import time

START, FRAME, STOP, READY, POSE, OBJECT, STATE, DONE, ERROR, NOTE = 1, 2, 3, 16, 17, 18, 19, 20, 21, 22


def get(size):
    data = b""
    while len(data) < size:
        part = os.read(0, size - len(data))
        if not part:
            sys.exit(0)
        data += part
    return data


def put(kind, payload=b""):
    data = struct.pack("<IB", len(payload), kind) + payload
    while data:
        data = data[os.write(1, data) :]


def message():
    length, kind = struct.unpack("<IB", get(5))
    return kind, get(length)


def pose(k, frame, **changes):
    numbers = list(struct.unpack("<176d", frame[: 176 * 8])) + [1.0] * 44 + [0.0] * 40
    numbers[0] = k
    for place, value in changes.items():
        numbers[int(place[1:])] = value
    return struct.pack("<260d", *numbers)


def forever():
    while True:
        time.sleep(60)


def compute(seconds):
    """So much of a processor's time, as one of two that want the same processor, the other with 70 times its weight."""
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    if not os.fork():
        while True:
            pass
    os.nice(19)
    until = time.process_time() + seconds
    while time.process_time() < until:
        pass


def misbehave(how, k, frame):
    """True where it has answered in its own way."""
    if how == "crashes" and k == 30:
        print("the reason is in this line", file=sys.stderr, flush=True)
        os.abort()
    elif how == "exits" and k == 30:
        sys.exit(7)
    elif how == "hangs" and k == 3:
        forever()
    elif how == "loops" and k == 3:
        while True:
            pass
    elif how == "stops" and k == 3:
        os.kill(os.getpid(), signal.SIGSTOP)
    elif how == "is_starved" and k == 3:
        compute(0.03)
        return False
    elif how == "writes_garbage" and k == 3:
        os.write(1, bytes(range(256)) * 16)
    elif how == "prints" and k == 3:
        os.write(1, b"hello, I am a print statement\n")
    elif how == "wrong_size" and k == 3:
        put(POSE, b"\0" * 8 * 259)
    elif how == "half_a_way" and k == 3:
        put(POSE, pose(k, frame) + struct.pack("<6d", *[0.5] * 6))
    elif how == "way_to_nowhere" and k == 3:
        put(POSE, pose(k, frame) + struct.pack("<12d", *[0.5] * 7, float("nan"), *[0.5] * 4))
    elif how == "not_a_number" and k == 3:
        put(POSE, pose(k, frame, n100=float("nan")))
    elif how == "infinite_root" and k == 3:
        put(POSE, pose(k, frame, n2=float("inf")))
    elif how == "length_two" and k == 3:
        put(POSE, pose(k, frame, n4=2 * 0.7071067811865476, n6=-2 * 0.7071067811865476))
    elif how == "negative_importance" and k == 3:
        put(POSE, pose(k, frame, n219=-1.0))
    elif how == "heavy_target" and k == 3:
        put(POSE, pose(k, frame, n227=2.0))
    elif how == "wrong_frame" and k == 3:
        put(POSE, pose(7, frame))
    elif how == "too_eager" and k == 3:
        put(POSE, pose(3, frame))
        put(POSE, pose(4, frame))
    elif how == "wrong_kind" and k == 3:
        put(OBJECT, struct.pack("<8d", k, 0, 0, 0, 1, 0, 0, 0))
    elif how == "bad_state" and k == 3:
        put(STATE, b'{"object": "cup"}')
    elif how == "half_a_message" and k == 3:
        os.write(1, struct.pack("<IB", 2080, POSE) + b"\0" * 100)
        sys.exit(0)
    elif how == "closes_output" and k == 3:
        os.close(1)
        forever()
    elif how == "says_error" and k == 3:
        put(ERROR, b"the cup is\nout of reach")
        sys.exit(1)
    elif how == "floods_log":
        os.write(2, b"still here\n" * 100_000)
        return False
    elif how == "leaves_child" and k == 3:
        child = subprocess.Popen(["sleep", "600"])
        print(child.pid, file=sys.stderr, flush=True)
        os._exit(3)
    elif how == "notes" and k < 3:
        put(NOTE, b"a note\nof two lines")
        put(NOTE, b"" if k == 1 else b"another")
        return False
    elif how == "floods_notes":
        for i in range(1000):
            put(NOTE, b"note %d" % i)
        return False
    else:
        return False
    return True


def main():
    how = sys.argv[1]
    if how == "ignores_sigterm":
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
    if how == "starts_slowly":
        time.sleep(float(sys.argv[2]))
    if how == "silent":
        forever()
    kind, payload = message()
    assert kind == START
    start = json.loads(payload)
    put(READY, json.dumps({"version": 99 if how == "other_version" else 1}).encode())
    while True:
        kind, payload = message()
        if kind == STOP and how == "ignores_sigterm":
            forever()
        if kind == STOP:
            return
        k = int(struct.unpack("<d", payload[:8])[0])
        if misbehave(how, k, payload):
            continue
        put(POSE, pose(k, payload))
        if k == start["frames"] and how != "no_done":
            put(DONE)
        if k == start["frames"]:
            return


main()
