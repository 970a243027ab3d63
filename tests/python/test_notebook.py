# SPDX-License-Identifier: MIT
"""Output of runs, sweeps and experiments of the Python module in a notebook."""

import base64
import html.parser
import os
import pathlib
import struct
import unittest
import unittest.mock
import zlib

import numpy as np
import palpate
from palpate import _show

from support import CONFIGS, DEFAULT, FolderTest


def pixels(png):
    """Returns the pixels of a PNG image of 8-bit RGB without filters, the top row first."""
    width, height = struct.unpack(">II", png[16:24])
    at, data = 8, b""
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at:at + 8])
        content = png[at + 8:at + 8 + length]
        assert zlib.crc32(kind + content) == struct.unpack(">I", png[at + 8 + length:at + 12 + length])[0]
        data += content if kind == b"IDAT" else b""
        at += 12 + length
    rows = np.frombuffer(zlib.decompress(data), np.uint8).reshape(height, 1 + 3 * width)
    assert not rows[:, 0].any()
    return rows[:, 1:].reshape(height, width, 3)


class Page(html.parser.HTMLParser):
    """Parser of the cells, the pictures and the tags of HTML."""

    def __init__(self, text):
        super().__init__()
        self.cells, self.pictures, self.tags, self._in_cell = [], [], set(), False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.add(tag)
        self._in_cell = tag in ("td", "th")
        if self._in_cell:
            self.cells.append("")
        if tag == "img":
            self.pictures.append(base64.b64decode(dict(attributes)["src"].removeprefix("data:image/png;base64,")))

    def handle_data(self, data):
        if self._in_cell:
            self.cells[-1] += data


class Notebook(FolderTest):
    def test_a_map_is_drawn_with_y_upwards_and_brighter_where_it_is_higher(self):
        values = np.zeros((3, 4))
        values[0, 3] = 0.05  # lower right
        drawn = pixels(_show.png(values))
        self.assertEqual(drawn.shape, (3, 4, 3))
        self.assertEqual(tuple(drawn[2, 3]), (253, 231, 37))
        self.assertEqual({tuple(one) for row in (drawn[0], drawn[1], drawn[2, :3]) for one in row}, {(68, 1, 84)})

    def test_a_run_shows_its_summary_and_its_surface(self):
        run = palpate.run(DEFAULT, "taps=4", runs=self.folder)
        page = Page(run._repr_html_())
        for cell in (run.directory, "done", f"{run.summary['rmse_m']:.4g}"):
            self.assertIn(cell, page.cells)
        self.assertEqual(pixels(page.pictures[0]).shape[:2], run.surface.shape)

    def test_what_is_damaged_is_shown_in_the_place_of_the_map(self):
        done = palpate.sweep(DEFAULT, taps=2, seed=[1, 2], runs=self.folder)
        run = done[0]
        record = pathlib.Path(run.directory) / "record.jsonl"
        for shown, part in ((done, "tap"), (run, "end")):
            text = record.read_text(encoding="utf-8")
            record.write_text(text.replace(f'{{"{part}": ', f'{{"{part}": broken '), encoding="utf-8")
            page = Page(shown._repr_html_())
            self.assertIn(shown.directory, " ".join(page.cells))
            self.assertIn("record.jsonl", page.cells[-2], "the place")
            self.assertEqual(page.pictures, [])

    def test_a_run_from_any_side_shows_its_summary_and_why_there_is_no_map(self):
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(CONFIGS.parent)  # the paths of its meshes start there
        run = palpate.run("configs/any_side.yaml", "taps=3", "scene=any_bowl", runs=self.folder)
        page = Page(run._repr_html_())
        self.assertIn("done", page.cells)
        self.assertIn(run.directory, page.cells[-2])
        self.assertIn("any side", page.cells[-1])
        self.assertEqual(page.pictures, [])

    def test_an_experiment_shows_what_it_believes_and_once_closed_where_it_lies(self):
        experiment = self.begin("taps=3")
        experiment.ask()
        experiment.tell(0.05)
        page = Page(experiment._repr_html_())
        self.assertIn("1", page.cells)
        self.assertEqual(pixels(page.pictures[0]).shape[:2], experiment.belief.height_mean.shape)
        experiment.close()
        page = Page(experiment._repr_html_())
        self.assertIn("is closed", page.cells)
        self.assertIn(experiment.directory, page.cells)

    def test_a_sweep_shows_its_jobs_and_names_are_no_markup(self):
        done = palpate.sweep(DEFAULT, taps=2, seed=[1, 2], name="<script>alert(1)</script>", runs=self.folder)
        page = Page(done._repr_html_())
        self.assertEqual(page.tags, {"table", "tr", "th", "td", "figure", "img", "figcaption"})
        self.assertEqual(page.cells.count("done"), 2)
        self.assertEqual(len(page.pictures), 1)
        self.assertEqual(Page(_show.table([("<script>", "&amp;")])).cells, ["<script>", "&amp;"])

    def test_figures_show_maps_and_taps_and_the_jobs_of_a_sweep(self):
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            self.skipTest("needs python3-matplotlib")
        run = palpate.run(DEFAULT, "taps=4", runs=self.folder)
        figure = run.plot()
        panels = {axes.get_title(): axes for axes in figure.axes if axes.get_title()}
        self.assertEqual(list(panels), ["surface, cm", "standard deviation, cm", "error, cm"])
        np.testing.assert_array_equal(panels["surface, cm"].images[0].get_array(), 100 * run.surface)
        np.testing.assert_array_equal(panels["error, cm"].images[0].get_array(), 100 * (run.surface - run.truth))
        np.testing.assert_allclose(panels["surface, cm"].collections[0].get_offsets()[:, 0], 100 * run.taps["x"])
        self.assertEqual(figure._repr_png_()[:4], b"\x89PNG")
        done = palpate.sweep(DEFAULT, taps=[2, 3], seed=[1, 2], runs=self.folder)
        axes = done.plot().axes[0]
        self.assertEqual([label.get_text() for label in axes.get_xticklabels()], ["taps=2", "taps=3"])
        shown = np.concatenate([line.get_ydata() for line in axes.lines])
        np.testing.assert_array_equal(np.sort(shown), np.sort(done.table["rmse_m"]))
        self.assert_error("plot", "no numeric column 'colour'", "column", lambda: done.plot("colour"))

    def test_a_figure_without_matplotlib_is_an_error_with_its_remedy(self):
        run = palpate.run(DEFAULT, "taps=2", runs=self.folder)
        with unittest.mock.patch.dict("sys.modules", {"matplotlib": None, "matplotlib.figure": None}):
            self.assert_error("plot", "matplotlib is missing", "python3-matplotlib", run.plot)


if __name__ == "__main__":
    unittest.main()
