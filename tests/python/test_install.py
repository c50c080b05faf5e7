"""Tests an installed package: by CMake, beside its library; and by pip."""

import os
import subprocess
import sys

from support import LIMIT_S, ROOT, Case, main

CODE = """
import cubewright as cw
print(cw._library.lib._name)
print(len(cw.extract(cw.make('sphere'), 0).triangles))
"""


def run_apart(code, folder, packages):
    """Runs code that can find the package in one folder alone."""
    unset = ("CUBEWRIGHT_LIBRARY", "LD_LIBRARY_PATH")
    environment = {name: value for name, value in os.environ.items() if name not in unset}
    environment["PYTHONPATH"] = str(packages)
    return subprocess.run(
        [sys.executable, "-c", code], cwd=folder, env=environment, capture_output=True, text=True, timeout=LIMIT_S
    )


class Install(Case):
    def setUp(self):
        super().setUp()
        install = ["cmake", "--install", os.environ["CUBEWRIGHT_BUILD"], "--prefix", self.folder / "usr"]
        subprocess.run(install, check=True, capture_output=True)
        found = list(self.folder.rglob("cubewright/__init__.py"))
        if not found:
            self.skipTest("CUBEWRIGHT_PYTHON is off")
        self.package = found[0].parent

    def test_it_finds_its_library(self):
        ran = run_apart(CODE, self.folder, self.package.parent)
        place, triangles = ran.stdout.split() or [ran.stderr, 0]
        self.assertTrue(place.startswith(str(self.folder / "usr")), place)
        self.assertGreater(int(triangles), 1000)

    def test_the_files_are_those_of_the_tree(self):
        tree = ROOT / "python" / "cubewright"
        names = sorted(path.name for path in tree.iterdir() if path.is_file())
        self.assertEqual(sorted(path.name for path in self.package.iterdir()), names)
        for name in names:
            self.assertEqual((self.package / name).read_bytes(), (tree / name).read_bytes())


class Wheel(Case):
    def test_pip_installs_it_without_a_network(self):
        """Installs into an environment that sees the system's NumPy."""
        packages = self.folder / "environment"
        made = subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", packages], capture_output=True)
        if made.returncode:
            self.skipTest("no venv or pip")
        python = packages / "bin" / "python"
        pip = [python, "-m", "pip", "install", "--no-index", "--quiet", ROOT / "python"]
        subprocess.run(pip, check=True, timeout=LIMIT_S)
        code = "import cubewright as cw; print(cw.__file__, len(cw.extract(cw.make('sphere'), 0).triangles))"
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        ran = subprocess.run([python, "-c", code], cwd=self.folder, env=environment, capture_output=True, text=True)
        self.assertIn(str(packages), ran.stdout, ran.stderr)


if __name__ == "__main__":
    main()
