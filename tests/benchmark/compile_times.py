#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""How long the compiler takes over each translation unit of a build tree, one after another, in seconds of CPU time.

  python3 tests/benchmark/compile_times.py [PRESET [PART]]

PRESET is a build that is complete (its precompiled headers are used): release, if none is named. PART: only units that
have it in their path. Prints the sum and the longest; on an idle machine none is to take more than 15 s.
"""
import json
import os
import re
import resource
import subprocess
import sys
import time


def seconds(command, folder):
    """CPU seconds of a compilation whose object goes nowhere, and of what it starts."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, shell=True, cwd=folder, check=True, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def name_of(path, root):
    """The path from the root; of a batch, of all that it includes."""
    if "/Unity/" not in path:
        return os.path.relpath(path, root)
    with open(path) as file:
        return " ".join(os.path.relpath(included, root) for included in re.findall(r'#include "(.*)"', file.read()))


def main():
    preset, part = (sys.argv[1:] + ["release", ""][len(sys.argv) - 1:])[:2]
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    with open(os.path.join(root, "build", preset, "compile_commands.json")) as file:
        units = [unit for unit in json.load(file) if part in unit["file"] and "_pch.hxx" not in unit["file"]]
    begun = time.time()
    taken = []
    for unit in units:
        name = name_of(unit["file"], root)
        command = re.sub(r" -o \S+", " -o /dev/null", unit["command"])
        try:
            taken.append((seconds(command, unit["directory"]), name))
        except subprocess.CalledProcessError:
            sys.exit(f"{name}: does not compile; build the preset first: ninja -C build/{preset}")
    print(f"{sum(s for s, _ in taken):.0f} s of CPU time for {len(taken)} units, {time.time() - begun:.0f} s by the clock")
    for s, name in sorted(taken, reverse=True)[:20]:
        print(f"{s:6.1f} s  {name}")


if __name__ == "__main__":
    main()
