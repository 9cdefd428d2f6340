"""Writes the knot of 672,000 coloured triangles of docs/pictures/scene.png: knot.py FILE.ply

foveal prepare scene knot.ply --out knot.foveal
foveal simulate knot.foveal --gaze 10,7 --fov 40 --view 1000x1000 \
    --frames 1 --policy acuity --score --out acuity
"""

import math
import struct
import sys

ALONG, AROUND = 2400, 140


def curve(t):
    """A trefoil."""
    x, y = math.sin(t) + 2 * math.sin(2 * t), math.cos(t) - 2 * math.cos(2 * t)
    return x, y, -math.sin(3 * t)


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return [x / length for x in a]


def cross(a, b):
    return [a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3)]


def vertex(i, j):
    t, a, h = 2 * math.pi * i / ALONG, 2 * math.pi * j / AROUND, 1e-4
    tangent = unit([x - y for x, y in zip(curve(t + h), curve(t - h))])
    normal = unit(cross(tangent, (0.13, 0.2, 0.97)))
    binormal = cross(tangent, normal)
    waves = 0.035 * math.sin(60 * t + 6 * a) * math.sin(8 * a - 20 * t)
    r = 0.62 + waves + 0.012 * math.sin(360 * t) * math.sin(40 * a)
    c, s = r * math.cos(a), r * math.sin(a)
    place = [p + c * n + s * b for p, n, b in zip(curve(t), normal, binormal)]
    shade = [150 + 70 * math.sin(3 * t + k * 2.1) + 25 * math.sin(8 * a - 20 * t) for k in range(3)]
    return struct.pack("<fff3B", *place, *[int(max(0, min(255, it))) for it in shade])


def triangles(i, j):
    a, b = i * AROUND + j, (i + 1) % ALONG * AROUND + j
    c, d = ((i + 1) % ALONG * AROUND + (j + 1) % AROUND, i * AROUND + (j + 1) % AROUND)
    return struct.pack("<BiiiBiii", 3, a, b, c, 3, a, c, d)


cells = [(i, j) for i in range(ALONG) for j in range(AROUND)]
header = f"""ply
format binary_little_endian 1.0
element vertex {len(cells)}
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
element face {2 * len(cells)}
property list uchar int vertex_indices
end_header
"""
with open(sys.argv[1], "wb") as file:
    file.write(header.encode())
    file.writelines(vertex(i, j) for i, j in cells)
    file.writelines(triangles(i, j) for i, j in cells)
