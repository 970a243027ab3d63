# SPDX-License-Identifier: MIT
# mypy: ignore-errors
"""HTML tables, images and figures of runs, sweeps and experiments for notebooks. Only figures need matplotlib."""

import base64
import html
import io
import struct
import zlib

import numpy as np

# Colours of Viridis (matplotlib, CC0) at the positions 0, 1/8, ..., 1.
_COLOURS = np.array([(68, 1, 84), (71, 44, 122), (59, 81, 139), (44, 113, 142), (33, 144, 141), (39, 173, 129),
                     (92, 200, 99), (170, 220, 50), (253, 231, 37)], dtype=float)


def png(values):
    """Returns a PNG image with one pixel per cell, from dark for the lowest value to bright for the highest; y points up."""
    values = np.asarray(values, dtype=float)[::-1]
    low, high = values.min(), values.max()
    share = (values - low) / (high - low) if high > low else np.zeros_like(values)
    at = np.arange(len(_COLOURS)) / (len(_COLOURS) - 1)
    pixels = np.stack([np.interp(share, at, _COLOURS[:, k]) for k in range(3)], axis=-1).round().astype(np.uint8)
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    parts = ((b"IHDR", struct.pack(">IIBBBBB", values.shape[1], values.shape[0], 8, 2, 0, 0, 0)),
             (b"IDAT", zlib.compress(rows)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in parts)


def image(values, title):
    """Returns an HTML figure of a map of heights, metres."""
    data = base64.b64encode(png(values)).decode()
    low, high = 100 * np.min(values), 100 * np.max(values)
    return (f'<figure><img src="data:image/png;base64,{data}" alt="{html.escape(title)}" width="235" '
            f'style="image-rendering: pixelated"><figcaption>{html.escape(title)}, {low:.1f} to {high:.1f} cm'
            "</figcaption></figure>")


def _cell(value):
    return html.escape(f"{value:.4g}" if isinstance(value, float) else "" if value is None else str(value))


def table(rows, head=()):
    """Returns an HTML table of rows of values. Markup in the values is escaped."""
    lines = ["".join(f"<th>{_cell(one)}</th>" for one in head)] if head else []
    lines += ["".join(f"<td>{_cell(one)}</td>" for one in row) for row in rows]
    return "<table>" + "".join(f"<tr>{line}</tr>" for line in lines) + "</table>"


def _png_of(figure):
    out = io.BytesIO()
    figure.savefig(out, format="png", bbox_inches="tight")
    return out.getvalue()


def figure(**size):
    """Returns an empty matplotlib figure that a notebook shows with any backend. Raises ImportError without matplotlib."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    out = type("Shown", (Figure,), {"_repr_png_": _png_of})(layout="constrained", **size)
    FigureCanvasAgg(out)
    return out


def draw_run(run):
    """Draws the surface of a run with its taps, its standard deviation and, if the truth is known, its error; in cm."""
    maps, truth = run.after(len(run)), run.truth
    panels = [("surface", maps.surface), ("standard deviation", maps.height_standard_deviation)]
    if truth is not None:
        panels.append(("error", maps.surface - truth))
    out = figure(figsize=(4.2 * len(panels), 3.6))
    half_x, half_y = ((axis[1] - axis[0]) / 2 if len(axis) > 1 else 0.0 for axis in (run.x, run.y))
    extent = [100 * v for v in (run.x[0] - half_x, run.x[-1] + half_x, run.y[0] - half_y, run.y[-1] + half_y)]
    taps = run.taps
    for axes, (title, values) in zip(np.atleast_1d(out.subplots(1, len(panels))), panels):
        drawn = axes.imshow(100 * values, origin="lower", extent=extent, cmap="viridis")
        axes.set(title=f"{title}, cm", xlabel="x, cm", ylabel="y, cm")
        out.colorbar(drawn, ax=axes)
        if len(taps) and title == "surface":
            axes.scatter(100 * taps["x"].astype(float), 100 * taps["y"].astype(float), c="white", edgecolors="black", s=18)
    return out


def draw_sweep(jobs, keys, metric):
    """Draws one point per finished job and the mean as a bar, one column per setting: all keys that differ except the seed."""
    out = figure(figsize=(6.4, 4.2))
    axes = out.subplots()
    done = jobs[jobs["status"] == "done"]
    shown = [key for key in keys if key != "seed" and len(set(done[key])) > 1]
    names = [", ".join(f"{key}={_cell(job[key])}" for key in shown) or "all jobs" for job in done]
    settings = list(dict.fromkeys(names))
    values = np.asarray(done[metric], dtype=float)
    for column, setting in enumerate(settings):
        of = values[[name == setting for name in names]]
        spread = column + np.linspace(-0.15, 0.15, len(of)) if len(of) > 1 else [column]
        axes.plot(spread, of, "o", alpha=0.6)
        axes.hlines(of.mean(), column - 0.25, column + 0.25, color="black")
    axes.set_xticks(range(len(settings)), settings, rotation=20, ha="right")
    axes.set(ylabel=metric)
    return out
