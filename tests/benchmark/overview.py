#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
r"""Draws README's picture: a run of the default after 5, 10 and 30 taps, and the error of three strategies against taps.

    ./palpate sweep configs/default.yaml name=moments taps=5,10,30 log.surface=true
    ./palpate sweep configs/benchmark/strategies.yaml name=overview motion=per_tap scene.effects=standard \
        strategy=default,uncertainty,weighted "seed=range(1000,1025)"
    ./palpate compare runs/overview/* --by strategy --metric rmse_m --at "$(seq -s, 60)" --format csv |
        python3 tests/benchmark/overview.py runs/moments/* overview.png

Reads the CSV of the comparison on stdin, and prints the numbers of the picture. Needs gnuplot."""
import csv
import pathlib
import subprocess
import sys

WIDTH, HEIGHT = 1800, 880  # pixels, at 257 dpi 17.8 cm wide
POINT = WIDTH / (17.8 / 2.54 * 72)  # pixels of a point in print
COLOURS = {"default": "#0072b2", "uncertainty": "#d55e00", "weighted": "#555555"}
DASHES = {"default": "1", "uncertainty": "(6,3)", "weighted": "(10,3,2,3)"}
WORDS = {"default": "default", "uncertainty": "uncertainty", "weighted": "weighted (the paper's rule)"}
LABELS = {"default": (42, 3.3), "uncertainty": (36, 9.9), "weighted": (15, 24)}  # taps and mm, of the left end
SHOWN = (17, 30, 60)  # taps whose errors are printed
HIGHEST = 12  # cm, the end of the colours
SIDE = 23  # cm, of the area


def rows(file):
    with open(file, newline="", encoding="utf-8") as lines:
        return list(csv.DictReader(lines))


def read_moments(sweep):
    """The jobs of the sweep by ascending taps: number of taps, RMSE in mm, rows of taps.csv and of surface.csv."""
    out = []
    for job in sorted(rows(sweep / "results.csv"), key=lambda row: int(row["taps"])):
        folder = sweep / "jobs" / job["id"]
        error = 1e3 * float(job["rmse_m"])
        out.append((int(job["taps"]), error, rows(folder / "taps.csv"), rows(folder / "surface.csv")))
    longest = [tap["x"] + tap["y"] + tap["height"] for tap in out[-1][2]]
    for count, _, taps, _ in out:
        if [tap["x"] + tap["y"] + tap["height"] for tap in taps] != longest[:count]:
            sys.exit(f"overview: the run of {count} taps does not begin the longest run: its taps differ")
    return out


def block(name, lines):
    return f"${name} << END\n" + "\n".join(lines) + "\nEND\n"


def map_block(name, surface, column):
    """Rows of x, y and height in cm: the cells of a map, in the order of the file."""
    return block(name, [" ".join(f"{100 * float(row[one]):.3f}" for one in ("x", "y", column)) for row in surface])


def taps_block(name, taps, on_object):
    shown = [tap for tap in taps if tap["outcome"] == "contact" and (tap["on_object"] == "true") == on_object]
    return block(name, [f"{100 * float(tap['x']):.3f} {100 * float(tap['y']):.3f}" for tap in shown] or ["NaN NaN"])


def draw(moments, curves, file):
    script = f"""set terminal pngcairo size {WIDTH},{HEIGHT} font 'DejaVu Sans,8' fontscale {0.75 * POINT:.3f} linewidth {POINT:.3f}
set output '{file}'
set multiplot
set palette defined (0 '#f7f7f7', 0.15 '#d0d8a8', 0.5 '#5ab4ac', 1 '#01506b')
set cbrange [0:{HIGHEST}]
unset colorbox
unset key
set tics scale 0.4 nomirror
set border lw 0.6
"""
    panels = [(f"after {count} taps: {error:.1f} mm", surface, "reconstructed_height", taps)
              for count, error, taps, surface in moments]
    panels.append(("truth", moments[-1][3], "true_height", []))
    left, side, gap, top = 0.012, 0.205, 0.012, 0.94
    high = side * WIDTH / HEIGHT
    for number, (title, surface, column, taps) in enumerate(panels):
        x = left + (number % 2) * (side + gap)
        y = top - high - (number // 2) * (high + 0.075)
        script += map_block(f"map{number}", surface, column)
        script += taps_block(f"object{number}", taps, True) + taps_block(f"desk{number}", taps, False)
        script += f"""set lmargin at screen {x:.4f}
set rmargin at screen {x + side:.4f}
set bmargin at screen {y:.4f}
set tmargin at screen {y + high:.4f}
set xrange [0:{SIDE}]
set yrange [0:{SIDE}]
unset xtics
unset ytics
set label 1 '{title}' at graph 0.5,1.06 center
plot $map{number} using 1:2:3 with image, \\
  $object{number} using 1:2 with points pt 7 ps {0.30 * POINT:.2f} lc '#000000', \\
  $object{number} using 1:2 with points pt 7 ps {0.20 * POINT:.2f} lc '#ffd23f', \\
  $desk{number} using 1:2 with points pt 2 ps {0.22 * POINT:.2f} lw 0.9 lc '#000000'
"""
    # The scale of heights, as a map of its own: a colorbox of gnuplot goes with one of the maps.
    bar = left + 2 * side + gap + 0.014
    bottom = top - 2 * high - 0.075
    steps = 60
    script += block("bar", [f"{dx} {(k + 0.5) * HIGHEST / steps:.3f} {(k + 0.5) * HIGHEST / steps:.3f}"
                            for k in range(steps) for dx in (0, 1)])
    script += f"""unset label 1
set lmargin at screen {bar:.4f}
set rmargin at screen {bar + 0.013:.4f}
set bmargin at screen {bottom:.4f}
set tmargin at screen {bottom + high:.4f}
set xrange [-0.5:1.5]
set yrange [0:{HIGHEST}]
set format y2 '%g'
set y2range [0:{HIGHEST}]
set y2tics 3 offset -0.8,0
set label 2 'height' at screen {bar - 0.002:.4f},{bottom + high + 0.09:.4f} left
set label 3 '[cm]' at screen {bar - 0.002:.4f},{bottom + high + 0.045:.4f} left
set label 4 'taps on' at screen {bar - 0.002:.4f},{top - 0.02:.4f} left
set label 5 'object' at screen {bar + 0.016:.4f},{top - 0.075:.4f} left
set label 6 '' at screen {bar + 0.006:.4f},{top - 0.075:.4f} point pt 7 ps {0.30 * POINT:.2f} lc '#000000'
set label 7 '' at screen {bar + 0.006:.4f},{top - 0.075:.4f} point pt 7 ps {0.20 * POINT:.2f} lc '#ffd23f'
set label 8 'desk' at screen {bar + 0.016:.4f},{top - 0.13:.4f} left
set label 9 '' at screen {bar + 0.006:.4f},{top - 0.13:.4f} point pt 2 ps {0.22 * POINT:.2f} lw 0.9 lc '#000000'
plot $bar using 1:2:3 with image
unset label
unset y2tics
"""
    for name, points in curves.items():
        script += block(name, [" ".join(f"{value:.4f}" for value in point) for point in points])
    bands = [f"${name} using 1:3:4 with filledcurves fs transparent solid 0.22 noborder lc '{COLOURS[name]}'"
             for name in curves]
    lines = [f"${name} using 1:2 with lines lw 1.6 dt {DASHES[name]} lc '{COLOURS[name]}'" for name in curves]
    for number, name in enumerate(curves):
        taps, error = LABELS[name]
        script += f"set label {number + 1} \"{WORDS[name]}\" at {taps},{error} left tc '{COLOURS[name]}'\n"
    script += f"""set lmargin at screen 0.575
set rmargin at screen 0.985
set bmargin at screen 0.125
set tmargin at screen {top:.4f}
set xrange [0:60]
set yrange [0:30]
set xtics 10
set ytics 5
set grid lw 0.4 lc '#dddddd'
set xlabel 'taps'
set ylabel 'error of the scene (RMSE) [mm]' offset 1,0
plot {', '.join(bands + lines)}
unset multiplot
"""
    subprocess.run(["gnuplot"], input=script, text=True, check=True)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    moments = read_moments(pathlib.Path(sys.argv[1]))
    curves = {}
    for row in csv.DictReader(sys.stdin):
        if row["kind"] == "group":
            point = (int(row["at"]), *(1e3 * float(row[column]) for column in ("mean", "low_95", "high_95")))
            curves.setdefault(row["group"], []).append(point)
            seeds = row["seeds"]
    draw(moments, curves, sys.argv[2])
    for count, error, _, _ in moments:
        print(f"run after {count} taps: RMSE {error:.1f} mm")
    for name, points in curves.items():
        for at, mean, low, high in points:
            if at in SHOWN:
                print(f"{name} after {at} taps: RMSE {mean:.1f} [{low:.1f}, {high:.1f}] mm, {seeds} seeds")


if __name__ == "__main__":
    main()
