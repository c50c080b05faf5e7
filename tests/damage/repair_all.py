"""Repairs damaged meshes, and counts what came out: python3 repair_all.py BIN_FOLDER [OPTION...]
--short: 6 kinds of damage of 3 meshes; else all 25 of all 20. --kind NAME, --mesh NAME: these alone. --seed N: other
damage. --keep FOLDER: where files stay. --admesh: ask ADMesh in our place.

A result is right when the command gives 0, `check` finds it sound, and its volume is within 0.1 % of what was
meant; wrong when the command gives 0 all the same; refused when it does not. None may be wrong."""

import argparse
import json
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

import numpy as np
import damages
import sound_meshes

TOLERANCE = 1e-3  # of the volume
MIN_RIGHT = 0.95
MIN_RIGHT_OF_KIND = 0.9
# what a file for a printer must be; its size and its walls are other questions
SOUND = ("manifold", "closed", "oriented", "outward", "intersections", "degenerate", "duplicates")
SHORT = ("seam1", "gap2", "tjunctions", "doubled_shell", "shared_wall", "holes")
SHORT_MESHES = ("cube", "torus", "bracket")


def write_stl(path, corners, is_text):
    if is_text:
        rows = ["solid damaged"]
        for t in corners:
            rows += ["facet normal 0 0 0", "outer loop"]
            rows += ["vertex %.9g %.9g %.9g" % tuple(map(float, p)) for p in t]
            rows += ["endloop", "endfacet"]
        path.write_text("\n".join(rows + ["endsolid damaged", ""]))
        return
    record = np.zeros(len(corners), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("flags", "<u2")])
    record["corners"] = corners
    path.write_bytes(b"damaged".ljust(80) + np.uint32(len(corners)).tobytes() + record.tobytes())


def read_stl(path):
    data = path.read_bytes()
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("flags", "<u2")])
    return np.frombuffer(data, record, int(np.frombuffer(data, "<u4", 1, 80)[0]), 84)["corners"]


def run(*words):
    return subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=300)


def is_sound(program, path):
    report = json.loads(run(program, "check", path, "--profile", "print", "--json", "-", "-q").stdout)
    verdicts = {v["name"]: v["grade"] for v in report["verdicts"]}
    assert {"manifold", "closed", "outward"} <= set(verdicts), verdicts
    return not any(grade == "fail" and name != "size" for name, grade in verdicts.items())


def judge(program, path, meant, size):
    """Tells what is not right with a result; nothing if all is."""
    if not path.exists():
        return "no file"
    corners = read_stl(path)
    got = sound_meshes.volume(corners) if len(corners) else 0.0
    if abs(got - meant) > TOLERANCE * abs(meant):
        return "volume %.6g, not %.6g" % (got, meant)
    box = np.ptp(corners.reshape(-1, 3), axis=0)
    if (box > size * 1.001).any():
        return "box %s, not %s" % (box, size)
    return "" if is_sound(program, path) else "check finds it broken"


def repair(program, source, out):
    made = run(program, "repair", source, "-o", out, "-q")
    assert made.returncode in (0, 1, 9), (source, made)
    return made.returncode == 0, made.stderr.strip()


def repair_admesh(_, source, out):
    made = run("admesh", "-b", out, source)
    return made.returncode == 0 and out.exists(), ""


def try_one(program, repairer, kind, mesh, folder, seed):
    points, faces = sound_meshes.make(mesh)
    rng = np.random.default_rng([seed, zlib.crc32(f"{kind} {mesh}".encode())])
    corners, meant = damages.damage(kind, points, faces, rng)
    source, out = folder / f"{kind}-{mesh}.stl", folder / f"{kind}-{mesh}-repaired.stl"
    write_stl(source, corners, rng.random() < 0.5)
    out.unlink(missing_ok=True)
    is_done, why = repairer(program, source, out)
    size = np.maximum(np.ptp(corners.reshape(-1, 3), axis=0), np.ptp(points, axis=0))
    wrong = judge(program, out, meant, size)
    return ("refused", why or wrong) if not is_done else ("wrong", wrong) if wrong else ("right", "")


def check_unchanged(program, folder):
    """Repairs the sound meshes: they come back bit by bit, and the command says so."""
    failed = 0
    for mesh in sound_meshes.SOUND:
        points, faces = sound_meshes.make(mesh)
        source, out = folder / f"{mesh}.stl", folder / f"{mesh}-same.stl"
        write_stl(source, points[faces], False)
        done = run(program, "repair", source, "-o", out)
        said = run(program, "repair", source, "--report-only")
        same = np.array_equal(read_stl(source), read_stl(out)) if out.exists() else False
        if done.returncode or not same or "nothing to repair" not in said.stdout + done.stderr:
            print(f"{mesh}: a sound mesh was changed: {done.stderr}{said.stdout}")
            failed = 1
    return failed


def main():
    p = argparse.ArgumentParser()
    p.add_argument("bin", type=Path)
    p.add_argument("--short", action="store_true")
    p.add_argument("--keep", type=Path)
    p.add_argument("--kind", action="append")
    p.add_argument("--mesh", action="append")
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--admesh", action="store_true")
    args = p.parse_args()
    program = args.bin / "cubewright"
    kinds = args.kind or (SHORT if args.short else damages.DAMAGES)
    meshes = args.mesh or (SHORT_MESHES if args.short else sound_meshes.SOUND)
    failed = 0
    sums = dict.fromkeys(("right", "wrong", "refused"), 0)
    with tempfile.TemporaryDirectory() as made:
        folder = args.keep or Path(made)
        folder.mkdir(exist_ok=True)
        if not args.admesh and not args.kind:
            failed = check_unchanged(program, folder)
        print("%-15s right wrong refused" % "kind")
        lines, kinds_failed = [], []
        for kind in kinds:
            found = dict.fromkeys(sums, 0)
            for mesh in meshes:
                verdict, why = try_one(program, repair_admesh if args.admesh else repair, kind, mesh, folder, args.seed)
                found[verdict] += 1
                sums[verdict] += 1
                if why:
                    lines.append(f"{verdict}: {kind} {mesh}: {why}")
            print("%-15s %5d %5d %7d" % (kind, *found.values()), flush=True)
            if found["right"] < MIN_RIGHT_OF_KIND * len(meshes):
                kinds_failed.append(kind)
        print("%-15s %5d %5d %7d" % ("all", *sums.values()))
        print("\n".join(lines))
    if args.admesh:
        return 0
    if kinds_failed or sums["wrong"] or sums["right"] < MIN_RIGHT * sum(sums.values()):
        print("too many are wrong or refused", *kinds_failed)
        failed = 1
    return failed


if __name__ == "__main__":
    sys.exit(main())
