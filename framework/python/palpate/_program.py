# SPDX-License-Identifier: MIT
# mypy: ignore-errors
"""The program `palpate`: what it is told, and how Python has it run a sweep."""

import csv
import json
import os
import re
import signal
import subprocess
import sys

import numpy as np

from ._palpate import program


def plain(value):
    """What JSON has for a value of NumPy, or for a path."""
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a config cannot contain {value!r}")


def value_text(value):
    """As the program reads it behind KEY=. A text stays as it is, where quotes do not keep it from being read as several."""
    if not isinstance(value, str):
        return json.dumps(value, default=plain, ensure_ascii=False)
    several = re.sub(r"\([^()]*\)", "", value)  # range(0,10) is one
    if value[:1] in ("[", "{", '"', "'") or not re.search(r",|: | #", several):
        return value
    return json.dumps(value, ensure_ascii=False)


def values_text(value):
    """The same of a swept key: what is a list of several is swept."""
    if isinstance(value, range) and len(value) > 10**6:  # which the program refuses
        return f"range({value.start},{value.stop},{value.step})"
    if isinstance(value, np.ndarray):
        value = value.tolist()
    return ",".join(map(value_text, value)) if isinstance(value, (list, tuple, range)) else value_text(value)


def conduct(command, progress):
    """Runs a sweep; its exit status and its last line. It ends with this process, and reports each job to it."""
    # A session of its own: Ctrl-C in a terminal would reach it twice.
    child = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                             start_new_session=True, env={**os.environ, "PALPATE_PARENT": str(os.getpid())})
    said, told, interrupted = b"", None, None
    try:
        while True:
            try:
                some = os.read(child.stderr.fileno(), 65536)
            except KeyboardInterrupt as interrupt:
                interrupted = interrupt
                child.send_signal(signal.SIGINT)
                continue
            if not some:
                break
            said = (said + some)[-4096:]
            counts = re.findall(rb"(\d+) of (\d+) jobs done, \d+ running, (\d+) failed", said)
            if progress is not None and counts and interrupted is None:
                now = int(counts[-1][0]) + int(counts[-1][2]), int(counts[-1][1])
                if now != told:
                    told = now
                    progress(*now)
    except BaseException:
        child.send_signal(signal.SIGINT)
        raise
    finally:
        child.stderr.close()
        child.wait()
    if interrupted is not None:
        raise interrupted
    lines = [line for line in said.decode(errors="replace").splitlines()
             if line.strip() and not re.match(r"\s*\d+ of \d+ jobs done", line)]
    return child.returncode, lines[-1] if lines else ""


def curve_columns(file, keys):
    """The columns of a CSV of `palpate curves` as arrays, and lists of texts; `keys` are those that are swept."""
    with open(file, encoding="utf-8", newline="") as text:
        rows = list(csv.DictReader(text))
    whole = {"n", "units", "jobs", "left_out", "failed", "unfinished", "without_value", "ended"}
    out = []
    for name in rows[0]:
        cells = [row[name] for row in rows]
        if name in ("metric", "against"):
            continue
        if name in keys:
            out.append((name, cells))
        elif name in whole or name == "at" and rows[0]["against"] == "taps":
            out.append((name, np.array(cells, dtype=int)))
        else:
            out.append((name, np.array([float(cell) if cell else np.nan for cell in cells])))
    return out


def run_program():
    """The command `palpate` of `pip install`."""
    os.execv(program, [program, *sys.argv[1:]])
