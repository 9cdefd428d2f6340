"""Which pictures stand side by side in one? side_by_side.py OUT.png PICTURE..

`/` begins another row. A PICTURE is a PNG of 8 bits, without palette or interlace, and may end in
options, as a.png:half:crop=400x300+50+20:ring=200,150,40 - in their order: half its size by means
of four pixels; cut to WIDTHxHEIGHT+LEFT+TOP; a white ring with a dark edge round X,Y of a radius.
Needs Python alone.
"""

import struct
import sys
import zlib

GAP = 8


def read(path):
    """Rows of red, green and blue of a picture."""
    with open(path, "rb") as file:
        data = file.read()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        sys.exit(f"{path}: not a PNG")
    at, packed, head = 8, b"", None
    while at < len(data):
        (length,) = struct.unpack_from(">I", data, at)
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            head = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    width, height, bits, colour, _, _, interlace = head
    if bits != 8 or colour not in (2, 6) or interlace:
        sys.exit(f"{path}: not red, green and blue of 8 bits without interlace")
    step = 3 if colour == 2 else 4
    raw, rows, before = zlib.decompress(packed), [], bytearray(width * step)
    for y in range(height):
        start = y * (width * step + 1)
        row = bytearray(raw[start + 1 : start + 1 + width * step])
        unfilter(raw[start], row, before, step)
        before = row
        if step == 4:
            row = bytearray(b for x in range(width) for b in row[4 * x : 4 * x + 3])
        rows.append(row)
    return rows


def unfilter(kind, row, above, step):
    """Undoes a filter of PNG in place."""
    for i in range(len(row)):
        left = row[i - step] if i >= step else 0
        corner = above[i - step] if i >= step else 0
        guess = (0, left, above[i], (left + above[i]) // 2, None)[kind]
        if guess is None:
            guess = paeth(left, above[i], corner)
        row[i] = (row[i] + guess) & 255


def paeth(left, up, corner):
    estimate = left + up - corner
    a, b, c = abs(estimate - left), abs(estimate - up), abs(estimate - corner)
    return left if a <= b and a <= c else up if b <= c else corner


def halved(rows):
    width = len(rows[0]) // 6 * 6
    return [
        bytearray(
            (a[i] + a[i + 3] + b[i] + b[i + 3] + 2) // 4
            for x in range(0, width, 6)
            for i in (x, x + 1, x + 2)
        )
        for a, b in zip(rows[::2], rows[1::2])
    ]


def cropped(rows, size):
    size, left, top = size.split("+")
    width, height = size.split("x")
    left, top, width, height = map(int, (left, top, width, height))
    return [row[3 * left : 3 * (left + width)] for row in rows[top : top + height]]


def ringed(rows, ring):
    x, y, radius = map(float, ring.split(","))
    for j, row in enumerate(rows):
        for i in range(len(row) // 3):
            away = abs(((i - x) ** 2 + (j - y) ** 2) ** 0.5 - radius)
            if away < 3:
                row[3 * i : 3 * i + 3] = bytes([255 if away < 1.7 else 30] * 3)
    return rows


def picture(named):
    path, *options = named.split(":")
    rows = read(path)
    for option in options:
        name, _, value = option.partition("=")
        if name == "half":
            rows = halved(rows)
        elif name == "crop":
            rows = cropped(rows, value)
        elif name == "ring":
            rows = ringed(rows, value)
        else:
            sys.exit(f"{named}: there is no option {name}")
    return rows


def joined(pictures):
    height = max(len(rows) for rows in pictures)
    lines = []
    for y in range(height):
        parts = [
            rows[y] if y < len(rows) else bytearray(b"\xff" * len(rows[0])) for rows in pictures
        ]
        lines.append((b"\xff" * (3 * GAP)).join(parts))
    return lines


def packed(lines):
    """The lines, each under the filter with the smallest differences."""
    out, above = bytearray(), bytes(len(lines[0]))
    for line in lines:
        best = None
        for kind in (1, 2, 4):
            body = bytearray(len(line))
            for i, value in enumerate(line):
                left = line[i - 3] if i >= 3 else 0
                corner = above[i - 3] if i >= 3 else 0
                guess = left if kind == 1 else above[i]
                if kind == 4:
                    guess = paeth(left, above[i], corner)
                body[i] = (value - guess) & 255
            cost = sum(min(b, 256 - b) for b in body)
            if best is None or cost < best[0]:
                best = (cost, kind, body)
        out.append(best[1])
        out += best[2]
        above = line
    return zlib.compress(bytes(out), 9)


def write(path, lines):
    def part(name, data):
        checksum = struct.pack(">I", zlib.crc32(name + data))
        return struct.pack(">I", len(data)) + name + data + checksum

    head = struct.pack(">IIBBBBB", len(lines[0]) // 3, len(lines), 8, 2, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + part(b"IHDR", head))
        file.write(part(b"IDAT", packed(lines)) + part(b"IEND", b""))


if len(sys.argv) < 3:
    sys.exit(__doc__)
lines, row = [], []
for named in [*sys.argv[2:], "/"]:
    if named != "/":
        row.append(picture(named))
        continue
    if lines:
        lines += [b"\xff" * len(lines[0])] * GAP
    lines += joined(row)
    row = []
write(sys.argv[1], lines)
