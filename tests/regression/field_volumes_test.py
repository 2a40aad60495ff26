#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Meshes volumes of tests/data/field that once took very long: field_volumes_test.py TOOL.

Checks the meshes, and that the work that took long is not done. Run time is not checked, because it
depends on the machine. Needs only the standard library.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOL = pathlib.Path(sys.argv[1]).resolve()
FIELD = pathlib.Path(__file__).resolve().parents[1] / "data" / "field"


class FieldVolumes(unittest.TestCase):
    def extract(self, volume, *options):
        """The summary and the report of a run that has to succeed."""
        with tempfile.TemporaryDirectory() as folder:
            report = pathlib.Path(folder) / "report.json"
            run = subprocess.run([
                TOOL, "extract", FIELD / volume, *options, "-o",
                pathlib.Path(folder) / "mesh.ply", "--report", report
            ], capture_output=True, text=True)
            self.assertEqual((run.returncode, run.stderr), (0, ""))
            return run.stdout, json.loads(report.read_text())

    def check_level(self, level, reference):
        self.assertIs(level["certificate"]["passed"], True)
        self.assertEqual(level["self_intersections"], 0)
        for key in ("components", "genus", "boundary_loops", "euler_characteristic"):
            self.assertEqual(level[key], reference[key], key)

    def test_edge_mask_is_separated_without_subdividing_its_surface(self):
        _, report = self.extract("dog64.nii.gz", "--iso", "0.5", "--coarse")
        reference, level = report["reference"], report["levels"][0]
        self.assertEqual((reference["components"], reference["genus"], reference["boundary_loops"]),
                         (28, 5280, 107))
        self.check_level(level, reference)
        # The surface used to be subdivided around most of its 175,321 c-vertices, in 19 rounds, for
        # a mesh of 153,021 triangles.
        self.assertEqual(report["subdivision"]["added_c_vertices"], 0)
        self.assertLess(level["certificate"]["repair_rounds"], 60)
        self.assertLess(level["triangles"], 130_000)

    def test_default_bound_of_thick_layers_can_be_satisfied(self):
        summary, report = self.extract("aniso_mask_small.nii.gz", "--iso", "0.5")
        reference, level = report["reference"], report["levels"][1]
        self.assertEqual((reference["components"], reference["genus"], reference["boundary_loops"]),
                         (1, 0, 0))
        self.check_level(level, reference)
        # The bound is an eighth of 3 mm. The earlier bound, half of 0.5 mm, took 60 rounds and
        # 1,829 vertices and was violated.
        bound = level["constraints"][0]
        self.assertEqual((bound["quantity"], bound["bound"], bound["default"], bound["satisfied"]),
                         ("max-distance", 0.375, True, True))
        self.assertRegex(summary, r"level 1 .* max-distance 0\.37\d* mm \(default 0\.375 mm\),")
        self.assertLess(level["refine_rounds"], 60)
        self.assertLess(level["vertices"], 1_200)

    def test_bound_that_cannot_be_satisfied_is_reported_in_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            run = subprocess.run([
                TOOL, "extract", FIELD / "aniso_mask_small.nii.gz", "--iso", "0.5",
                "--max-distance", "0.5vx", "-o",
                pathlib.Path(folder) / "mesh.ply"
            ], capture_output=True, text=True)
        self.assertEqual(run.returncode, 1)
        self.assertRegex(
            run.stderr,
            r"\Aisoatlas: level 1: max-distance 0\.25 mm: reached 0\.3\d+ mm: \d+ cells are at the "
            r"resolution limit; "
            r"supersampling would help there\n\Z")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
