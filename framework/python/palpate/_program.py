# SPDX-License-Identifier: MIT
# mypy: ignore-errors
"""The program `palpate`: conversion of values to its command line, sweeps as child processes, and its output files."""

import csv
import json
import os
import re
import signal
import subprocess
import sys
import tempfile

import numpy as np

from ._errors import make_error
from ._palpate import program


def plain(value):
    """Converts a NumPy value or a path to a JSON value."""
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a config cannot contain {value!r}")


def value_text(value):
    """Returns a value as the program reads it after KEY=. A text is quoted only if the program would read several values."""
    if not isinstance(value, str):
        return json.dumps(value, default=plain, ensure_ascii=False)
    several = re.sub(r"\([^()]*\)", "", value)  # the commas in range(0,10) do not separate values
    if value[:1] in ("[", "{", '"', "'") or not re.search(r",|: | #", several):
        return value
    return json.dumps(value, ensure_ascii=False)


def values_text(value):
    """Returns the values of a swept key, separated by commas. A value that is not a list stands alone."""
    if isinstance(value, range) and len(value) > 10**6:  # the program rejects such a long range with its own message
        return f"range({value.start},{value.stop},{value.step})"
    if isinstance(value, np.ndarray):
        value = value.tolist()
    return ",".join(map(value_text, value)) if isinstance(value, (list, tuple, range)) else value_text(value)


def override_texts(overrides, settings):
    return [*overrides, *(f"{key}={value_text(value)}" for key, value in settings.items())]


def conduct(command, progress):
    """Runs a sweep or a race. Returns its exit status, its last line on stderr, and the directory in its last line
    "record: DIR" on stdout, or None. It ends with this process. Calls progress(done, jobs)."""
    printed = tempfile.TemporaryFile()
    # The child process has a separate session. Otherwise, Ctrl-C in a terminal would reach it twice.
    child = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=printed, stderr=subprocess.PIPE,
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
            counts = re.findall(rb"(\d+) of (\d+) (?:jobs done, \d+ running, (\d+) failed|runs, )", said)
            if progress is not None and counts and interrupted is None:
                now = int(counts[-1][0]) + int(counts[-1][2] or 0), int(counts[-1][1])
                if now != told:
                    told = now
                    progress(*now)
    except BaseException:
        child.send_signal(signal.SIGINT)
        raise
    finally:
        child.stderr.close()
        child.wait()
        printed.seek(0)
        records = re.findall(rb"^record: (.*)$", printed.read(), re.MULTILINE)
        printed.close()
    if interrupted is not None:
        raise interrupted
    lines = [line for line in said.decode(errors="replace").splitlines()
             if line.strip() and not re.match(r"\s*\d+ of \d+ (jobs done|runs, )", line)]
    return child.returncode, lines[-1] if lines else "", os.fsdecode(records[-1]) if records else None


def curve_columns(file, keys):
    """Returns the columns of a CSV of `palpate curves`: arrays of numbers, and lists of texts for the swept `keys`."""
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


def importance_rows(directories, metric, where):
    """Returns the rows of `palpate compare --importance` as dicts. Raises InputError."""
    command = [program, "compare", *directories, "--importance", "--metric", metric, "--format", "json"]
    done = subprocess.run([*command, *(["--where", where] if where is not None else [])], capture_output=True, text=True)
    if done.returncode != 0:
        raise make_error("importance", done.stderr.strip().removeprefix("command line: "), "")
    return json.loads(done.stdout)


def race_columns(file):
    """Returns the columns of race.csv: lists of texts for the keys, which stand before `seeds`, and arrays of numbers."""
    with open(file, encoding="utf-8", newline="") as text:
        head, *rows = csv.reader(text)
    out = []
    for i, name in enumerate(head):
        cells = [row[i] for row in rows]
        if 0 < i < head.index("seeds"):
            out.append((name, np.array(cells, dtype=object)))
        elif name == "is_best":
            out.append((name, np.array([cell == "true" for cell in cells])))
        elif name in ("setting", "seeds", "fresh_seeds"):
            out.append((name, np.array(cells, dtype=int)))
        else:
            out.append((name, np.array([float(cell) if cell else np.nan for cell in cells])))
    return out


def run_program():
    """Replaces this process by the program. Entry point of the command `palpate` of `pip install`."""
    os.execv(program, [program, *sys.argv[1:]])
