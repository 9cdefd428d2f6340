"""Sends the gaze of Pupil Core to Foveal, as lines of JSON over UDP (docs/formats/gaze.md).

    pip install pyzmq msgpack
    python3 pupil_core.py --pupil 127.0.0.1:50020 --to 127.0.0.1:5005 --field 100x56
"""

import argparse
import json
import math
import socket

SEEN = 0.6  # Least confidence at which Pupil Labs call a gaze good.


def record_from_gaze(gaze: dict, *, field_deg: tuple[float, float]) -> dict:
    """The record of a gaze datum: norm_pos is (0, 0) bottom left to (1, 1) top right of the scene
    camera, a pinhole that sees field_deg (width, height) and sits on the head."""
    across, up = ((2 * at - 1) * math.tan(math.radians(full / 2))
                  for at, full in zip(gaze["norm_pos"], field_deg))
    return {"t_s": gaze["timestamp"], "space": "head", "valid": gaze["confidence"] >= SEEN,
            "yaw_deg": math.degrees(math.atan(across)),
            "pitch_deg": math.degrees(math.atan2(up, math.hypot(1, across)))}


def main() -> None:
    import msgpack
    import zmq
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--pupil", default="127.0.0.1:50020", help="HOST:PORT of Pupil Remote")
    options.add_argument("--to", default="127.0.0.1:5005", help="HOST:PORT of foveal's udp:PORT")
    options.add_argument("--field", default="100x56", help="WxH of the scene camera in degrees")
    args = options.parse_args()
    (host, port), field = args.to.rsplit(":", 1), tuple(map(float, args.field.split("x")))
    out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    remote = zmq.Context.instance().socket(zmq.REQ)
    remote.connect(f"tcp://{args.pupil}")
    remote.send_string("SUB_PORT")
    gazes = zmq.Context.instance().socket(zmq.SUB)
    gazes.connect(f"tcp://{args.pupil.rsplit(':', 1)[0]}:{remote.recv_string()}")
    gazes.subscribe("gaze.")
    while True:
        _topic, payload, *_more = gazes.recv_multipart()
        record = record_from_gaze(msgpack.unpackb(payload), field_deg=field)
        out.sendto(json.dumps(record).encode(), (host, int(port)))


if __name__ == "__main__":
    main()
