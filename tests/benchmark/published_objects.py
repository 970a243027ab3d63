#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""palpate on the nine objects on which GPAtlasRRT (RIL 2016) was published, from a folder that you have downloaded:

    git clone https://github.com/pacman-project/pacman-object-database
    python3 tests/benchmark/published_objects.py pacman-object-database --palpate ./palpate

Writes scenes and a sweep below --out (published_objects), runs the sweep there and compares the rules. Of each object
it takes NAME.stl, NAME.ply or NAME.obj, in whichever folder; a cloud of points (NAME.pcd, NAME_cloud.ply, a PLY
without faces) is no scene, because a line passes between its points, and an object of which nothing else is there is
refused. The SHA-256 of each file is kept in --checksums (published_objects.sha256) at the first use; another content
later is refused. Only the standard library."""
import argparse
import hashlib
import math
import os
import pathlib
import struct
import subprocess
import sys

NAMES = ["bowlA", "bowlB", "containerA", "containerB", "jug", "kettle", "kitchenUtensilB", "mugD", "pot"]
ENDINGS = [".stl", ".ply", ".obj"]
SIZES = {"char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H", "uint16": "H",
         "int": "i", "int32": "i", "uint": "I", "uint32": "I", "float": "f", "float32": "f", "double": "d",
         "float64": "d"}


class Refused(Exception):
    pass


def of_stl(data):
    """The corners, and how many triangles."""
    if len(data) >= 84 and len(data) == 84 + 50 * struct.unpack_from("<I", data, 80)[0]:
        count = struct.unpack_from("<I", data, 80)[0]
        corners = [struct.unpack_from("<3f", data, 84 + 50 * i + 12 * k) for i in range(count) for k in (1, 2, 3)]
        return corners, count
    corners = [tuple(map(float, line.split()[1:4])) for line in data.decode("ascii", "replace").splitlines()
               if line.split()[:1] == ["vertex"]]
    return corners, len(corners) // 3


def of_obj(data):
    lines = [line.split() for line in data.decode("utf-8", "replace").splitlines()]
    return [tuple(map(float, w[1:4])) for w in lines if w[:1] == ["v"]], sum(w[:1] == ["f"] for w in lines)


def of_ply(data):
    head, _, body = data.partition(b"end_header\n" if b"end_header\n" in data else b"end_header\r\n")
    form, elements = "ascii", []
    for words in (line.split() for line in head.decode("ascii", "replace").splitlines()):
        if words[:1] == ["format"]:
            form = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append(words[1:])
    faces = sum(count for name, count, _ in elements if name in ("face", "tristrips"))
    if not elements or elements[0][0] != "vertex":
        raise Refused("its first element is not vertex")
    _, count, properties = elements[0]
    names = [p[-1] for p in properties]
    at = [names.index(axis) for axis in "xyz"]
    if form == "ascii":
        rows = [line.split() for line in body.decode("ascii", "replace").splitlines()[:count]]
        return [tuple(float(row[i]) for i in at) for row in rows], faces
    row = struct.Struct((">" if form == "binary_big_endian" else "<") + "".join(SIZES[p[0]] for p in properties))
    points = (row.unpack_from(body, i * row.size) for i in range(count))
    return [tuple(point[i] for i in at) for point in points], faces


READERS = {".stl": of_stl, ".ply": of_ply, ".obj": of_obj}


def find_mesh(folder, name):
    """The file, its corners; Refused where there is only a cloud, or nothing."""
    clouds = []
    for ending in ENDINGS:
        for file in sorted(folder.rglob(name + ending)):
            try:
                corners, faces = READERS[ending](file.read_bytes())
            except (ValueError, IndexError, struct.error, KeyError, Refused) as error:
                raise Refused(f"{file} is not to be understood: {error}")
            if faces and corners:
                return file, corners
            clouds.append(file)
    clouds += sorted(folder.rglob(name + "_cloud.*")) + sorted(folder.rglob(name + ".pcd"))
    if clouds:
        raise Refused(f"{clouds[0]} is a cloud of points, and a scene needs a mesh")
    raise Refused(f"no file {name}.stl, .ply or .obj below {folder}")


def check_sums(files, kept):
    """Compares with what was kept, and keeps what is new."""
    known = {}
    if kept.exists():
        known = dict(reversed(line.split(None, 1)) for line in kept.read_text().splitlines() if line.strip())
    for name, file in files.items():
        found = hashlib.sha256(file.read_bytes()).hexdigest()
        label = name + file.suffix
        if known.setdefault(label, found) != found:
            raise Refused(f"{file} has the SHA-256 {found}, at first use it was {known[label]} ({kept})")
    kept.write_text("".join(f"{sums}  {label}\n" for label, sums in sorted(known.items())))


def scene_of(name, file, corners, up):
    """The text of a scene, its object turned as the seed says in an area in which it fits however it is turned."""
    extents = [max(c[i] for c in corners) - min(c[i] for c in corners) for i in range(3)]
    unit = 1.0 if max(extents) < 2.0 else 0.001  # metres, or millimetres: no object of these is larger than 2 m
    level = (0, 1) if up == "z" else (0, 2)
    side = max(0.26, unit * math.hypot(extents[level[0]], extents[level[1]]) + 0.02)
    quoted = str(file.resolve()).replace("'", "''")
    return (f"# {name}, largest side {unit * max(extents) * 100:.1f} cm, turned as the seed says.\n"
            "scene:\n"
            f"  area: {{width: {side:.3f} m, depth: {side:.3f} m}}\n  desk: 0 cm\n  objects:\n    draw:\n      least: 1\n"
            f"      most: 1\n      of:\n        - {{type: mesh, file: '{quoted}', unit: {unit:g} m, up: {up}, "
            f"holes: allow,\n           at: [{side / 2:.4f} m, {side / 2:.4f} m], "
            'rotation: "uniform(0 deg, 360 deg)"}\n')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="that was downloaded")
    parser.add_argument("--palpate", default="palpate", help="the program")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("published_objects"))
    parser.add_argument("--checksums", type=pathlib.Path, default=pathlib.Path("published_objects.sha256"))
    parser.add_argument("--objects", default=",".join(NAMES), help="some of them")
    parser.add_argument("--up", choices=["z", "y"], default="z", help="axis of the files that points up")
    parser.add_argument("--no-run", action="store_true", help="only write the scenes and the sweep")
    parser.add_argument("more", nargs="*", help="KEY=VALUE for the sweep, as taps=19")
    options = parser.parse_intermixed_args()
    if not options.folder.is_dir():
        raise Refused(f"{options.folder} is no folder")
    objects = options.objects.split(",")
    strangers = sorted(set(objects) - set(NAMES))
    if strangers:
        raise Refused(f"{strangers[0]} is none of {', '.join(NAMES)}")
    found = {name: find_mesh(options.folder, name) for name in objects}
    check_sums({name: file for name, (file, _) in found.items()}, options.checksums)
    scenes = options.out / "scene"
    scenes.mkdir(parents=True, exist_ok=True)
    for name, (file, corners) in found.items():
        (scenes / f"published_{name}.yaml").write_text(scene_of(name, file, corners, options.up))
    config = options.out / "published_objects.yaml"
    config.write_text(
        "# The nine published objects, seen from one side, then touched. Written by published_objects.py.\n"
        "name: published_objects\ndefaults:\n  - strategy: any_side\n  - backend: simulator\nbelief: {view: {}}\n"
        "taps: 40\nsweep:\n  grid:\n    acquisition: [random, uncertainty, discovery]\n"
        f"    scene: [{', '.join('published_' + name for name in objects)}]\n    seed: range(15000,15010)\n")
    print(f"{len(found)} scenes and {config}")
    if options.no_run:
        return 0
    program = options.palpate if os.sep not in options.palpate else os.path.abspath(options.palpate)
    runs = options.out / "runs"
    sweep = subprocess.run([program, "sweep", str(config), "--runs", str(runs), *options.more], check=False)
    if sweep.returncode:
        return sweep.returncode
    made = max((runs / "published_objects").iterdir(), key=lambda one: one.stat().st_mtime)
    return subprocess.run([program, "compare", str(made), "--by", "acquisition,scene", "--metric",
                           "surface_distance_m,f_score,volume_iou", "--format", "markdown"], check=False).returncode


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Refused as refusal:
        print(f"published_objects: {refusal}", file=sys.stderr)
        sys.exit(2)
