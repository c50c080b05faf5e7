"""Tests that type checkers find no error in the package: mypy --strict."""

import subprocess
import sys
import unittest

from support import ROOT, Case, main


class Types(Case):
    def test_mypy_is_content(self):
        if subprocess.run([sys.executable, "-m", "mypy", "--version"], capture_output=True).returncode:
            raise unittest.SkipTest("no mypy")
        package = ROOT / "python" / "cubewright"
        command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", self.folder, package]
        ran = subprocess.run(command, capture_output=True, text=True)
        self.assertEqual(ran.returncode, 0, ran.stdout)


if __name__ == "__main__":
    main()
