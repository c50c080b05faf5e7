"""Tests that the declarations are those of the headers, and of the compiler."""

import ctypes
import os
import subprocess
import sys

from support import LIMIT_S, ROOT, Case, main

from cubewright import _declarations as c
from cubewright._library import lib

CC = os.environ.get("CC", "cc")


class Declarations(Case):
    def setUp(self):
        super().setUp()
        try:
            import pycparser  # noqa: F401
        except ImportError:
            self.skipTest("no pycparser")
        self.made, self.probe = self.folder / "made.py", self.folder / "probe.c"
        generator = ROOT / "python" / "generate_declarations.py"
        command = [sys.executable, generator, self.made, "--cc", CC, "--probe", self.probe]
        subprocess.run(command, check=True, timeout=LIMIT_S)

    def test_the_committed_file_is_what_the_generator_makes(self):
        committed = ROOT / "python" / "cubewright" / "_declarations.py"
        self.assertEqual(
            self.made.read_text(),
            committed.read_text(),
            "run python/generate_declarations.py python/cubewright/_declarations.py",
        )

    def test_sizes_offsets_and_values_are_those_of_the_compiler(self):
        program = self.folder / "probe"
        folder = os.path.dirname(os.environ["CUBEWRIGHT_LIBRARY"])
        subprocess.run(
            [CC, f"-I{ROOT}/include", "-o", program, self.probe, f"-L{folder}", "-lcubewright"], check=True
        )
        environment = {**os.environ, "LD_LIBRARY_PATH": folder}
        ran = subprocess.run([program], check=True, capture_output=True, text=True, env=environment)
        lines = ran.stdout.splitlines()
        self.assertGreater(len(lines), 1500)
        for line in lines:
            kind, name, value = line.split(" ", 2)
            self.assertEqual(ask_ctypes(kind, name), value, line)

    def test_every_function_has_types(self):
        for name, (result, arguments) in c.FUNCTIONS.items():
            function = getattr(lib, name)
            self.assertEqual(function.argtypes, arguments, name)
            self.assertEqual(function.restype, result, name)


def ask_ctypes(kind, name):
    """Returns the value of a line of the probe as ctypes has it."""
    first, _, last = name.partition(".")
    declared = getattr(c, first, None)
    if kind == "sizeof":
        return str(ctypes.sizeof(declared))
    if kind == "offset":
        return str(getattr(declared, last).offset)
    if kind == "size":
        return str(getattr(declared, last).size)
    if kind == "sizeof_enum":
        return str(ctypes.sizeof(ctypes.c_int))
    if kind == "enum":
        return str(int(declared[last]))
    if kind == "variable":
        return str(ctypes.sizeof(c.VARIABLES[first]))
    return f"{declared:.17g}" if kind == "real" else str(declared)


if __name__ == "__main__":
    main()
