"""Runs the code blocks of python/README.md, in their order, on a real scan where one is there."""

import os
import re

import cubewright as cw
import numpy as np
from support import ROOT, Case, main

SCAN = ROOT.parent / "shared" / "data" / "headsq-ct" / "headsq.mha"


class Guide(Case):
    def test_every_block_runs(self):
        head = cw.read_volume(SCAN) if SCAN.exists() else cw.make("ct-head", type="i16")
        cw.write(self.folder / "head.nrrd", head)
        text = (ROOT / "python" / "README.md").read_text()
        blocks = re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
        self.assertGreater(len(blocks), 5)
        names, here = {}, os.getcwd()
        os.chdir(self.folder)
        try:
            for block in blocks:
                exec(compile(block, "README.md: " + block.splitlines()[0], "exec"), names)
        finally:
            os.chdir(here)
        for made in ("head.ply", "cells.obj", "ball.png"):
            try:
                self.assertGreater((self.folder / made).stat().st_size, 1000)
            except FileNotFoundError:
                self.fail(f"{made} was not written")

    def test_the_block_of_the_main_page_runs(self):
        text = (ROOT / "README.md").read_text()
        (block,) = re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
        np.save(self.folder / "head.npy", cw.make("ct-head", type="i16").array)
        here = os.getcwd()
        os.chdir(self.folder)
        try:
            exec(compile(block, "README.md", "exec"), {})
        finally:
            os.chdir(here)
        self.assertGreater(len(cw.read_mesh(self.folder / "head.ply").triangles), 1000)

    def test_every_public_name_has_a_docstring(self):
        for name in cw.__all__:
            public = getattr(cw, name)
            if callable(public) and name != "Progress":
                self.assertGreater(len(public.__doc__ or ""), 20, name)


if __name__ == "__main__":
    main()
