# SPDX-License-Identifier: MIT
"""Records as crash.py compares them: without clocks, and as a power cut leaves them."""
import csv
import io
import json
import os
import shutil

CLOCKS = {"wall_seconds", "compute_seconds", "compute", "peak_rss_bytes", "at", "command_line", "of_summary",
          "attempt", "robot", "fit", "infer", "acquire", "log"}
# Of a record that was broken off and carried on there may be more, or fewer, of these.
ATTEMPTS = {"attempt", "setup", "timing", "note"}


def without_clocks(value):
    if isinstance(value, dict):
        return {key: without_clocks(one) for key, one in value.items() if key not in CLOCKS}
    return [without_clocks(one) for one in value] if isinstance(value, list) else value


def lasting(path):
    """What must be equal in the record of a run that was broken off; raises ValueError for a part of a file."""
    name = os.path.basename(path)
    with open(path, "rb") as file:
        text = file.read().decode(errors="replace")
    if name == "record.jsonl":
        # The last line may be a half one: readers pass over it.
        rows = [json.loads(line) for line in text.split("\n")[:-1]]
        rows = [row for row in rows if next(iter(row)) not in ATTEMPTS]
        # Only the last end and the last objects hold.
        rows = [row for i, row in enumerate(rows)
                if next(iter(row)) not in ("end", "objects") or all(next(iter(row)) not in other for other in rows[i + 1:])]
        return str([without_clocks(row) for row in rows])
    if name.endswith(".json"):
        return str(without_clocks(json.loads(text)))
    if name == "summaries.jsonl":
        if not text.endswith("\n"):
            raise ValueError("half a line")
        return str([without_clocks(json.loads(line)) for line in text.splitlines()])
    if name.endswith(".csv"):
        rows = list(csv.reader(io.StringIO(text)))
        if text and not text.endswith("\n") or any(len(row) != len(rows[0]) for row in rows):
            raise ValueError("half a table")
        kept = [i for i, key in enumerate(rows[0] if rows else []) if key.split(".")[0] not in CLOCKS]
        return [[row[i] for i in kept] for row in rows]
    if name == "report.html":
        if not text.rstrip().endswith("</html>"):
            raise ValueError("half a page")
        return "a page"
    return text


def tree(folder):
    """Path below `folder` -> what is lasting of the file."""
    out = {}
    for root, folders, files in os.walk(folder):
        # A sweep that was never published: the next sweep after a minute removes it (tests/sweep/draft_test.cpp).
        folders[:] = [one for one in folders if not one.startswith(".sweep-")]
        for name in files:
            path = os.path.join(root, name)
            try:
                out[os.path.relpath(path, folder)] = lasting(path)
            except ValueError as trouble:
                out[os.path.relpath(path, folder)] = f"half: {trouble}"
    return out


def halves(folder, whole):
    """Files under their final names that are parts, or whose summary says more than there is."""
    found = tree(folder)
    out = []
    for path, kept in found.items():
        name = os.path.basename(path)
        if name.endswith((".tmp", ".jsonl", "lock")) and name != "manifest.jsonl":
            continue  # on its way, or growing
        wrong = isinstance(kept, str) and kept.startswith("half: ")
        if name in ("config.yaml", "surface.csv", "manifest.jsonl"):
            wrong = kept != whole.get(path)
        if name == "summary.json" and not wrong and "'status': 'done'" in kept:
            run = os.path.dirname(path)
            wrong = kept != whole.get(path) or any(
                found.get(other) != whole[other] for other in whole
                if os.path.dirname(other) == run and os.path.basename(other) in ("record.jsonl", "taps.csv", "surface.csv"))
        if wrong:
            out.append(name)
    return out


def cut_power(bench, rng):
    """Takes away what no sync has promised: names in any order, contents behind the last synced length.

    Files keep a part of what is not synced, or zeros in its place."""
    # The folder of all runs itself lies in one whose syncs are not counted.
    calls = [call for call in bench.trace() if call.result >= 0 and call.path != bench.runs or call.name == "sync"]
    undo = []  # changes of names, youngest last
    synced, size = {}, {}  # of files by their present names
    for call in calls:
        if call.name in ("create", "mkdir", "unlink"):
            undo.append(call)
        if call.name == "create":
            synced[call.path] = size[call.path] = 0
        elif call.name == "write":
            size[call.path] = call.detail
        elif call.name == "rename":
            undo.append(call)
            for lengths in (synced, size):
                if call.path in lengths:
                    lengths[call.to] = lengths.pop(call.path)
        elif call.name == "sync" and os.path.isdir(call.path):
            undo = [one for one in undo if os.path.dirname(one.to or one.path) != call.path]
        elif call.name == "sync":
            synced[call.path] = size.get(call.path, 0)
    for path, length in size.items():
        first = synced.get(path, length)
        if length <= first or not os.path.isfile(path):
            continue
        os.truncate(path, rng.choice([first, rng.randint(first, length)]))
        if rng.random() < 0.3:
            os.truncate(path, length)  # zeros
    for call in reversed(undo):
        if rng.random() < 0.5:
            continue
        kept = f"{bench.state}.old/{call.number}"
        if call.name == "rename" and os.path.exists(call.to) and not os.path.exists(call.path):
            os.rename(call.to, call.path)
            if os.path.exists(kept):
                os.link(kept, call.to)
        elif call.name == "unlink" and os.path.exists(kept) and not os.path.exists(call.path):
            os.makedirs(os.path.dirname(call.path), exist_ok=True)
            os.link(kept, call.path)
        elif call.name == "mkdir":
            shutil.rmtree(call.path, ignore_errors=True)
        elif call.name == "create" and os.path.isfile(call.path):
            os.remove(call.path)


def differing(found, whole):
    """Paths that are in one of them only, or not alike."""
    return ", ".join(path for path in sorted(set(found) | set(whole)) if found.get(path) != whole.get(path))
