"""Shares what tests of the package need: fields with known answers, and running as a script."""

import contextlib
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import cubewright as cw
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77  # for ctest
LIMIT_S = 300 * int(os.environ.get("CUBEWRIGHT_TEST_SLOW", "1"))  # ends what hangs; no machine is so slow


def make_ball(size=24, dtype="f4", scale=1.0):
    """Returns an array that is positive in a ball, with axes of three lengths."""
    z, y, x = np.ogrid[:size, : size + 2, : size + 5]
    middle = (size - 1) / 2
    distance = np.sqrt((z - middle) ** 2 + (y - middle) ** 2 + (x - middle) ** 2)
    return ((0.35 * size - distance) * scale).astype(dtype)


class Case(unittest.TestCase):
    """A test with a temporary folder, and checks of errors."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    @contextlib.contextmanager
    def fails(self, status, *words):
        """Holds a block to an Error of a status, whose message has some words."""
        with self.assertRaises(cw.Error) as caught:
            yield
        self.assertEqual(caught.exception.status, status, caught.exception.message)
        for word in words:
            self.assertIn(word, caught.exception.message)

    def same_mesh(self, a, b):
        self.assertTrue(np.array_equal(a.triangles, b.triangles))
        self.assertTrue(np.array_equal(a.vertices, b.vertices))

    def need(self, feature):
        if not cw.features()[feature].available:
            self.skipTest(f"{feature} is not in this build")


def run_python(code, **environment):
    """Runs code in an interpreter of its own."""
    return subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, **environment}, capture_output=True, text=True, timeout=LIMIT_S
    )


def main():
    """Runs the tests of a script; with 77 when all were skipped."""
    result = unittest.main(exit=False, verbosity=1).result
    every_skipped = result.testsRun and len(result.skipped) >= result.testsRun
    sys.exit(not result.wasSuccessful() or (SKIPPED if every_skipped else 0))
