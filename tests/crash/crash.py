#!/usr/bin/python3 -B
# SPDX-License-Identifier: MIT
"""Fails every call on files that a command makes, one at a time, and checks what that leaves behind.

faulty_calls.cpp counts the calls of a command and fails the n-th in one of its modes. Then must hold:

  hangs    the command ends
  exit     a failed call: exit status 1, or 0 and the whole record; a kill: 137, or the same where another process went on
  words    of status 1: one line on stderr, with a path or the reason of the system
  silent   status 0 with anything but the whole record
  half     no file under its final name is a part of one; a summary that says done is that of the whole record
  stuck    the next command ends with status 0
  differs  after it the record is that of the unbroken run but for clocks
  leftover no *.tmp remains
  lost     (robot) every tap is in the record, and none was made twice

The short form draws points; the long form takes all. known.txt lists the failures that are known, a line each: "COMMAND
MODE CALL FILE: SYMPTOM", and of a power cut "COMMAND power: SYMPTOM". Any other failure fails the harness, and so does a known one that does not occur any more.
"""
import argparse
import concurrent.futures
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile

from records import cut_power, differing, halves, tree

HERE = os.path.dirname(os.path.realpath(__file__))
CONFIGS = os.path.realpath(os.path.join(HERE, "..", "..", "configs"))
TAPS = 4

# Calls that need room, and those that change something.
ROOM = {"create", "write", "sync", "rename", "mkdir", "link"}
CHANGES = ROOM | {"unlink", "cut"}
MODES = {
    "eio": None, "eio+": None,  # every call
    "enospc": {"create", "write", "rename", "mkdir"}, "enospc+": {"create", "write", "rename", "mkdir"},
    "edquot": ROOM | {"close"}, "edquot+": ROOM,
    "short": {"write"}, "short+": {"write"}, "lossclose": {"write"}, "losssync": {"sync"},
    "before": CHANGES, "after": CHANGES, "torn": {"write"}, "power": CHANGES,
}
KILLS = {"before", "after", "torn", "power"}
REASONS = ("No space left", "Input/output error", "quota exceeded", "No locks available", "was killed")


class Call:
    """A line of the trace."""

    def __init__(self, line):
        number, self.name, result, self.path, self.to, detail = line.rstrip("\n").split("\t")
        self.number, self.result, self.detail = int(number), int(result), int(detail)


class Bench:
    """A folder in which a command runs, with its record below `runs`."""

    def __init__(self, build):
        self.build = build
        self.folder = os.path.realpath(tempfile.mkdtemp(prefix="palpate-crash-"))
        self.runs = os.path.join(self.folder, "runs")
        self.state = os.path.join(self.folder, "state")
        os.mkdir(self.state + ".old")

    def remove(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def palpate(self, words, fault=None):
        env = dict(os.environ, PALPATE_ARM_TAPS=os.path.join(self.folder, "taps"),
                   PALPATE_PLUGIN_PATH=os.path.join(self.build, "tests/bad_plugins/arm"))
        if fault:
            with open(self.state, "wb") as state:
                state.write(bytes(64))
            env.update(LD_PRELOAD=os.path.join(self.build, "tests/libfaulty_calls.so"), PALPATE_FAULT=fault,
                       PALPATE_FAULT_BELOW=self.runs, PALPATE_FAULT_STATE=self.state)
        return subprocess.run([os.path.join(self.build, "palpate")] + words, cwd=self.folder, env=env, text=True,
                              stdin=subprocess.DEVNULL, capture_output=True, timeout=300)

    def trace(self):
        if not os.path.exists(self.state + ".trace"):
            return []
        with open(self.state + ".trace") as lines:
            return [Call(line) for line in lines]

    def directory(self):
        """The run or sweep; None if there is none that was published."""
        for root, folders, files in os.walk(self.runs):
            if os.path.relpath(root, self.runs).count("/") == 1:
                return root
            folders[:] = [one for one in folders if not one.startswith(".")]
        return None

    def noted_taps(self):
        try:
            with open(os.path.join(self.folder, "taps")) as lines:
                return [int(line) for line in lines]
        except FileNotFoundError:
            return []


# ---- commands ----

class Command:
    """What is run, from which beginning, and how it is carried on."""
    name = ""
    many = False  # many runs, each with a line about its failure
    children = False  # a process other than the one that was begun may be killed, and told of

    def prepare(self, bench):
        pass

    def words(self, bench):
        raise NotImplementedError

    def again(self, bench):
        """Words that go on after a failure or a kill."""
        return self.words(bench)

    def resume(self, bench, *more):
        directory = bench.directory()
        begun = directory and os.path.exists(os.path.join(directory, "config.yaml"))
        return ["resume", directory, "--retry-failed", "--quiet", *more] if begun else self.words(bench)


class Run(Command):
    name = "run"

    def words(self, bench):
        return ["run", CONFIGS + "/paper/object_i.yaml", f"taps={TAPS}", "--quiet", "--runs", bench.runs]

    def again(self, bench):
        return self.resume(bench)


class Robot(Run):
    name = "robot"

    def words(self, bench):
        return ["run", CONFIGS + "/process.yaml", "backend=arm", "log.sync=tap", f"taps={TAPS}", "--quiet", "--runs",
                bench.runs]


class Sweep(Command):
    name = "sweep"
    many = children = True

    def words(self, bench):
        return ["sweep", CONFIGS + "/paper/object_i.yaml", f"taps={TAPS}", "acquisition=[weighted,uncertainty]", "-j", "1", "--quiet",
                "--runs", bench.runs]

    def again(self, bench):
        return self.resume(bench, "-j", "1")


class Job(Sweep):
    """One job of a sweep that has begun none."""
    name = "job"

    def prepare(self, bench):
        bench.palpate(Sweep.words(self, bench))
        for root, _, files in os.walk(bench.directory()):
            for name in files:
                if name not in ("config.yaml", "manifest.jsonl", "lock"):
                    os.remove(os.path.join(root, name))

    def words(self, bench):
        return ["resume", bench.directory(), "--jobs", "0", "-j", "1", "--quiet", "--retry-failed"]

    again = words


class Half(Job):
    """The same of a record in which a kill left half a line."""
    name = "half"

    def prepare(self, bench):
        super().prepare(bench)
        with open(os.path.join(bench.directory(), "manifest.jsonl")) as lines:
            job = next(row["id"] for row in map(json.loads, lines) if row.get("job") == 0)
        with open(os.path.join(bench.directory(), "jobs", job, "record.jsonl"), "w") as record:
            record.write('{"manifest": 1, "na')


class Report(Run):
    name = "report"

    def prepare(self, bench):
        bench.palpate(Run.words(self, bench))

    def words(self, bench):
        return ["report", bench.directory()]

    again = words


class Compare(Sweep):
    name = "compare"
    many = False

    def prepare(self, bench):
        bench.palpate(Sweep.words(self, bench))

    def words(self, bench):
        return ["compare", bench.directory(), "--by", "acquisition", "--metric", "rmse_m", "--at", str(TAPS - 1), "-j", "1"]

    again = words


COMMANDS = [Run(), Robot(), Job(), Half(), Sweep(), Report(), Compare()]


# ---- points ----

class Point:
    """The n-th call of a command, in a mode."""

    def __init__(self, command, mode, call, bench):
        self.command, self.mode, self.number = command, mode, call.number
        name = os.path.relpath(call.to or call.path, bench.runs)
        name = re.sub(r"\.[0-9a-f]{16}\.tmp$", ".tmp", name)
        name = re.sub(r"\.sweep-\w{6}", "DRAFT", name)
        name = "/".join(re.sub(r"^[0-9a-f]{12}$", "ID", part) for part in name.split("/")[1:]) or "."
        # A child that was killed is told of; a place that keeps no locks is wrong usage.
        self.statuses = {137, 1 if command.children else 137} if mode in KILLS else {1, 2 if call.name == "lock" else 1}
        # What a power cut takes away is drawn: by any of them the same may happen.
        self.kind = f"{command.name} power" if mode == "power" else f"{command.name} {mode} {call.name} {name}"

    def failures(self, build, whole, seed):
        """The symptoms, each with what shows it."""
        bench = Bench(build)
        try:
            self.command.prepare(bench)
            return self.check(bench, whole, random.Random(f"{seed} {self.kind} {self.number}"))
        except subprocess.TimeoutExpired as trouble:
            return {"hangs": str(trouble)}
        finally:
            bench.remove()

    def check(self, bench, whole, rng):
        ended = bench.palpate(self.command.words(bench), f"{self.mode} {self.number}")
        said = ended.stderr.strip()
        out = {}
        status = 137 if ended.returncode == -9 else ended.returncode
        if self.mode == "power":
            cut_power(bench, rng)
        elif status == 0:
            difference = differing(tree(bench.runs), whole)
            if difference:
                out["silent"] = difference
        elif status not in self.statuses:
            out["exit"] = f"{status}: {said}"
        elif status == 1:
            lines = [line for line in said.split("\n") if line and not re.match(r"\d+ of \d+ jobs done", line)]
            told = bench.folder in said + ended.stdout or any(one in said + ended.stdout for one in REASONS)
            if not told or (len(lines) != 1 and not self.command.many) or "terminate" in said:
                out["words"] = said
        if self.mode != "power":  # which may leave the name of a file without its content
            half = halves(bench.runs, whole)
            if half:
                out["half"] = ", ".join(half)
        last = bench.palpate(self.command.again(bench))
        if last.returncode != 0:
            out["stuck"] = last.stderr.strip()
            return out
        found = tree(bench.runs)
        if any(path.endswith(".tmp") for path in found):
            out["leftover"] = ", ".join(path for path in found if path.endswith(".tmp"))
        if isinstance(self.command, Robot):
            lost = lost_taps(bench)
            if lost:
                out["lost"] = lost
        else:
            difference = differing({path: kept for path, kept in found.items() if not path.endswith(".tmp")}, whole)
            if difference:
                out["differs"] = difference
        return out


def lost_taps(bench):
    made = bench.noted_taps()
    if len(set(made)) != len(made):
        return f"made {made}"
    with open(os.path.join(bench.directory(), "record.jsonl")) as lines:
        rows = [json.loads(line) for line in lines]
    taps = [row for row in rows if "tap" in row]
    if [row["tap"] for row in taps] != list(range(1, TAPS + 1)):
        return f"recorded {[row['tap'] for row in taps]}"
    told = [row["tap"] for row in taps if row["outcome"] != "unknown"]
    return "" if set(told) <= set(made) <= set(range(1, TAPS + 1)) else f"recorded {told}, made {made}"


def unbroken(command, build):
    """The record of the command without a fault, and its calls."""
    bench = Bench(build)
    command.prepare(bench)
    ended = bench.palpate(command.words(bench), "count 0")
    if ended.returncode != 0:
        sys.exit(f"{command.name}: ends with {ended.returncode}: {ended.stderr}")
    calls = bench.trace()
    points = [Point(command, mode, call, bench) for call in calls for mode, names in MODES.items()
              if names is None or call.name in names]
    whole = tree(bench.runs)
    bench.remove()
    return whole, points


def read_known(file):
    with open(file) as lines:
        return [line.strip() for line in lines if line.strip() and not line.startswith("#")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=os.path.realpath, help="folder of a build")
    parser.add_argument("--long", action="store_true", help="all points")
    parser.add_argument("--points", type=int, default=60, help="points that are drawn")
    parser.add_argument("--seed", default="1", help="by which they are drawn")
    parser.add_argument("--only", default="", help="points whose kind begins with this")
    parser.add_argument("--write", action="store_true", help="writes that list anew")
    parser.add_argument("--known", default=os.path.join(HERE, "known.txt"), help="list of known failures")
    parser.add_argument("-j", type=int, default=2, help="points at a time")
    arguments = parser.parse_args()

    wholes, points = {}, []
    for command in COMMANDS:
        wholes[command.name], more = unbroken(command, arguments.build)
        points += more
    points = [point for point in points if point.kind.startswith(arguments.only)]
    known = [] if arguments.write else [one for one in read_known(arguments.known) if one.startswith(arguments.only)]
    total = len(points)
    kinds = {}
    for point in points:
        kinds.setdefault(point.kind, []).append(point)
    occurred, unknown = {}, []

    def note(point, symptoms):
        for symptom, shown in symptoms.items():
            name = f"{point.kind}: {symptom}"
            occurred[name] = occurred.get(name, 0) + 1
            if name not in known:
                unknown.append(f"{name}\n    at call {point.number}: {shown[:300]}")

    def fail(point):
        return point.failures(arguments.build, wholes[point.command.name], arguments.seed)

    drawn = points if arguments.long else random.Random(arguments.seed).sample(points, min(arguments.points, total))
    with concurrent.futures.ThreadPoolExecutor(arguments.j) as pool:
        for point, symptoms in zip(drawn, pool.map(fail, drawn)):
            note(point, symptoms)

        def look_for(kind):
            """The points of a kind until all that is known of it has occurred."""
            wanted = {one for one in known if one.rsplit(": ", 1)[0] == kind}
            found = []
            for point in kinds.get(kind, []):
                symptoms = fail(point)
                found.append((point, symptoms))
                wanted -= {f"{kind}: {symptom}" for symptom in symptoms}
                if not wanted:
                    break
            return found

        missing = sorted({one.rsplit(": ", 1)[0] for one in known if one not in occurred})
        for found in pool.map(look_for, missing):
            for point, symptoms in found:
                note(point, symptoms)
    gone = [one for one in known if one not in occurred]
    if arguments.write:
        with open(arguments.known, "w") as out:
            out.write("# Failures that are known: COMMAND MODE CALL FILE: SYMPTOM. This list may only shrink.\n")
            out.writelines(one + "\n" for one in sorted(occurred))
    print(f"{len(drawn)} of {total} points, {sum(occurred.values())} failures of {len(occurred)} kinds, "
          f"{len(unknown)} unknown, {len(gone)} known ones do not occur any more")
    for one in unknown:
        print("unknown: " + one)
    for one in gone:
        print("does not occur any more, take it from known.txt: " + one)
    return 1 if (unknown and not arguments.write) or gone else 0


if __name__ == "__main__":
    sys.exit(main())
