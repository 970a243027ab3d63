# SPDX-License-Identifier: MIT
"""Taps from any side by ask and tell. tests/support/simulated_arm.cpp makes the taps, as a program of the protocol. PALPATE_LONG
compares 8 solids with 5 seeds and 40 taps."""

import json
import os
import pathlib
import subprocess
import unittest

import numpy as np
import palpate

from support import BUILD, CONFIGS, FolderTest

ANY_SIDE = CONFIGS / "any_side.yaml"
FEW = ("scene=any_bowl", "candidates.count=200", "belief.moves=50")
LONG = os.environ.get("PALPATE_LONG")


class SimulatedArm:
    def __init__(self, *overrides):
        self._program = subprocess.Popen([BUILD / "tests/simulated_arm", *overrides], stdin=subprocess.PIPE,
                                         stdout=subprocess.PIPE, text=True)
        self._previous = None

    def tap(self, tap):
        line = {"start": tap.start.tolist(), "direction": tap.direction.tolist(), "length": tap.length}
        print(json.dumps({"palpate": 2, "tap": tap.number, "line": line, "previous": self._previous}),
              file=self._program.stdin, flush=True)
        self._previous = line
        answer = json.loads(self._program.stdout.readline())
        del answer["tap"]
        return answer

    def close(self):
        self._program.communicate()


def taps_of(directory):
    return (pathlib.Path(directory) / "taps.csv").read_text(encoding="utf-8")


class AnySide(FolderTest):
    def arm(self, *overrides):
        arm = SimulatedArm(*overrides)
        self.addCleanup(arm.close)
        return arm

    def test_who_tells_distances_in_the_scene_gets_the_lines_and_the_taps_of_the_simulator(self):
        solids = [file.stem for file in sorted((CONFIGS / "scene").glob("any_*.yaml"))] if LONG else ["any_two"]
        seeds, taps = (5, 40) if LONG else (1, 10)
        for solid in solids:
            for seed in range(1, seeds + 1):
                scene = f"scene={solid}", f"seed={seed}"
                felt = palpate.run(ANY_SIDE, *scene, taps=taps, runs=self.folder, name="felt")
                arm = self.arm(*scene)
                with self.begin(*scene, "backend.scene_is_truth=true", config=ANY_SIDE, taps=taps, name="told") as experiment:
                    while tap := experiment.ask():
                        experiment.tell(**arm.tap(tap))
                self.assertEqual(taps_of(experiment.directory), taps_of(felt.directory), scene)
                self.assertEqual(len(palpate.load(experiment.directory)), taps)
        print(len(solids) * seeds, "runs have equal taps")

    def test_scores_of_the_caller_choose_among_the_lines_that_are_drawn_before_each_tap(self):
        arm = self.arm(FEW[0])
        seen = []
        with self.begin(*FEW, config=ANY_SIDE, taps=8) as experiment:
            belief = experiment.belief
            for number in range(8):
                lines = belief.lines
                self.assertEqual(lines.shape, (200, 7))
                seen.append(lines)
                scores = 2.0 + lines[:, 5] + (belief.values("surface_std") if number >= 4 else 0.0)
                self.assertEqual(belief.uncertainty.shape, (200,))
                tap = experiment.ask(scores)
                self.assertEqual(tap.source, "caller")
                self.assertEqual(tap.candidate, int(np.argmax(scores)))
                np.testing.assert_array_equal(np.hstack((tap.start, tap.direction, tap.length)), lines[tap.candidate])
                np.testing.assert_array_equal(belief.lines, lines)
                experiment.tell(**arm.tap(tap))
            with self.assertRaises(ValueError):
                seen[0][0, 0] = 1.0
        self.assertEqual(len({lines.tobytes() for lines in seen}), 8)
        run = palpate.load(experiment.directory)
        self.assertEqual(set(run.taps["source"]), {"caller"})

    def test_what_is_not_on_the_line_is_refused_and_a_position_gives_the_distance(self):
        with self.begin(*FEW, config=ANY_SIDE, taps=4) as experiment:
            tap = experiment.ask()
            for fields, reason, remedy in (
                    ({"height": 0.05}, "the contact has no position", "give the distance along the line"),
                    ({"outcome": "contact"}, "is valid only with", "leave one"),
                    ({"distance": 120.0}, "distance 120 m is outside 0 to 0.3588 m", "are these millimetres?"),
                    ({"distance": -0.01}, "distance -0.01 m is outside", ""),
                    ({"distance": float("nan")}, "distance nan m is outside", ""),
                    ({"distance": 0.1, "contacts": [{"position": (11.0, 0, 0)}]}, "is more than 10 m away", "metres"),
                    ({"distance": 0.4, "outcome": "no_contact"}, "distance 0.4 m is outside", "")):
                self.assert_error("tell", reason, remedy, lambda: experiment.tell(**fields))
            experiment.tell(contacts=[{"position": tap.start + 0.125 * tap.direction}])
            experiment.ask()
            experiment.tell(distance=0.25, outcome="no_contact")
            experiment.ask()
            experiment.tell(outcome="no_contact")
            experiment.ask()
            experiment.tell(distance=0.125, outcome="contact")
            self.assert_error("display", "reads label_mean, which the belief solids does not offer", "",
                              lambda: experiment.belief.weight)
            self.assertEqual(experiment.belief.uncertainty.shape, (200,), "the refusal leaves no trace")
        along = palpate.load(experiment.directory).taps["along"]
        self.assertAlmostEqual(along[0], 0.125, delta=1e-15)
        np.testing.assert_array_equal(along[1:], [0.25, np.nan, 0.125])


if __name__ == "__main__":
    unittest.main()
