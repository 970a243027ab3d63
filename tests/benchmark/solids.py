#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the eight solids of configs/benchmark/any_side.yaml: binary STL in millimetres, z up, resting on 0.

    python3 tests/benchmark/solids.py configs/scene/solids

A solid of several parts is their union: closed surfaces that reach into each other. Only the standard library."""
import math
import struct
import sys


def revolved(profile, steps=48):
    """A closed profile of (radius, height), counter-clockwise seen with the radius to the right, turned about z."""
    def ring(radius, height):
        if radius == 0:
            return [(0.0, 0.0, height)] * steps
        return [(radius * math.cos(2 * math.pi * k / steps), radius * math.sin(2 * math.pi * k / steps), height)
                for k in range(steps)]
    rings = [ring(*point) for point in profile]
    out = []
    for here, there in zip(rings, rings[1:] + rings[:1]):
        for k in range(steps):
            out += quad(here[k], here[(k + 1) % steps], there[(k + 1) % steps], there[k])
    return out


def quad(a, b, c, d):
    """Two triangles, or the one that is left where corners are the same."""
    return [t for t in ((a, b, c), (a, c, d)) if len(set(t)) == 3]


def extruded(outline, low, high):
    """A convex or star-shaped outline (x, y), counter-clockwise, whose first corner sees all others, between two heights."""
    bottom = [(x, y, low) for x, y in outline]
    top = [(x, y, high) for x, y in outline]
    out = []
    for k in range(len(outline)):
        n = (k + 1) % len(outline)
        out += quad(bottom[k], bottom[n], top[n], top[k])
        if 0 < k < len(outline) - 1:
            out += [(bottom[0], bottom[n], bottom[k]), (top[0], top[k], top[n])]
    return out


def box(low, high):
    return extruded([(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])], low[2], high[2])


def tube(path, radius, steps=12):
    """A round bar along points in the plane of x and z, its ends closed."""
    rings = []
    for k, (x, z) in enumerate(path):
        before, after = path[max(k - 1, 0)], path[min(k + 1, len(path) - 1)]
        along = math.hypot(after[0] - before[0], after[1] - before[1])
        nx, nz = -(after[1] - before[1]) / along, (after[0] - before[0]) / along
        rings.append([(x + radius * math.cos(a) * nx, radius * math.sin(a), z + radius * math.cos(a) * nz)
                      for a in (2 * math.pi * s / steps for s in range(steps))])
    out = []
    for here, there in zip(rings, rings[1:]):
        for s in range(steps):
            n = (s + 1) % steps
            out += quad(here[s], here[n], there[n], there[s])
    for s in range(1, steps - 1):
        out += [(rings[0][0], rings[0][s + 1], rings[0][s]), (rings[-1][0], rings[-1][s], rings[-1][s + 1])]
    return out


def turned(triangles, angle, axis):
    """About x or y, radian."""
    c, s = math.cos(angle), math.sin(angle)
    if axis == "x":
        move = lambda p: (p[0], c * p[1] - s * p[2], s * p[1] + c * p[2])
    else:
        move = lambda p: (c * p[0] + s * p[2], p[1], c * p[2] - s * p[0])
    return [tuple(move(p) for p in t) for t in triangles]


def moved(triangles, by):
    return [tuple(tuple(p[i] + by[i] for i in range(3)) for p in t) for t in triangles]


def set_down(triangles):
    least = min(p[2] for t in triangles for p in t)
    return moved(triangles, (0, 0, -least))


def arc(centre, radius_x, radius_z, begin, end, steps):
    """Points of a handle, degrees."""
    return [(centre[0] + radius_x * math.cos(math.radians(begin + (end - begin) * k / steps)),
             centre[1] + radius_z * math.sin(math.radians(begin + (end - begin) * k / steps))) for k in range(steps + 1)]


def bowl():
    """A bowl, 16 cm wide and 7 cm high, its wall 4 mm."""
    def side(radius, depth, lowest):
        return [(radius * math.sin(a), lowest + depth * (1 - math.cos(a)))
                for a in (math.pi / 2 * k / 12 for k in range(3, 13))]
    outer = [(0.0, 0.0), (28.0, 0.0)] + side(80.0, 68.0, 2.0)
    inner = [(0.0, 5.0)] + side(76.0, 65.0, 5.0)
    return revolved(outer + inner[::-1])


def jug():
    """A jug, 19 cm high, wall 4 mm, with a handle."""
    outer = [(0, 0), (48, 0), (58, 30), (60, 60), (54, 100), (42, 140), (40, 160), (47, 190)]
    inner = [(43, 190), (36, 160), (38, 140), (50, 100), (56, 60), (54, 30), (44, 5), (0, 5)]
    return revolved(outer + inner) + tube(arc((48, 115), 46, 48, -65, 85, 14), 6.0)


def mug():
    """A mug, 10 cm high, wall 4 mm, with a handle: 12 cm from side to side."""
    body = revolved([(0, 0), (41, 0), (41, 100), (37, 100), (37, 5), (0, 5)])
    return body + tube(arc((37, 51), 38, 29, -85, 85, 14), 5.0)


def lidded_box():
    """A box of 18 x 12 x 7 cm, its wall 5 mm, the lid of 5 mm open by 110 degrees."""
    out = (box((-90, -60, 0), (90, 60, 5)) + box((-90, -60, 0), (90, -55, 70)) + box((-90, 55, 0), (90, 60, 70)) +
           box((-90, -60, 0), (-85, 60, 70)) + box((85, -60, 0), (90, 60, 70)))
    lid = moved(turned(box((-90, -120, 0), (90, 0, 5)), math.radians(-110), "x"), (0, 57, 66))
    return out + lid


def bottle():
    """A bottle that lies, 22 cm long, 7 cm thick, wall 3 mm, without its cap."""
    outer = [(0, 0), (33, 0), (35, 4), (35, 130), (31, 150), (20, 168), (14, 180), (14, 220)]
    inner = [(11, 220), (11, 180), (17, 167), (28, 149), (32, 130), (32, 6), (0, 4)]
    return set_down(moved(turned(revolved(outer + inner), math.pi / 2, "y"), (-110, 0, 0)))


def bracket():
    """An angle of 6 mm plate, 15 x 6 cm and 12 cm high, with a rib of 5 mm."""
    rib = extruded([(0, 0), (80, 0), (0, 80)], -2.5, 2.5)
    rib = moved(turned(rib, math.pi / 2, "x"), (-70, 0, 4))
    return box((-75, -30, 0), (75, 30, 6)) + box((-75, -30, 0), (-69, 30, 120)) + rib


def leaning():
    """A solid cylinder, 7 cm thick and 14 cm long, tilted by 25 degrees."""
    return set_down(turned(revolved([(0, 0), (35, 0), (35, 140), (0, 140)]), math.radians(25), "y"))


def two():
    """A block of 9 x 7 x 6 cm and a cylinder, 7 cm thick and 11 cm high, that touch."""
    cylinder = revolved([(0, 0), (35, 0), (35, 110), (0, 110)])
    return box((-80, -35, 0), (10, 35, 60)) + moved(cylinder, (45, 0, 0))


def write(path, triangles):
    with open(path, "wb") as file:
        file.write(b"palpate".ljust(80, b" ") + struct.pack("<I", len(triangles)))
        for triangle in triangles:
            file.write(struct.pack("<12fH", 0, 0, 0, *(x for p in triangle for x in p), 0))


if __name__ == "__main__":
    for make in (bowl, jug, mug, lidded_box, bottle, bracket, leaning, two):
        write(f"{sys.argv[1]}/{make.__name__}.stl", make())
