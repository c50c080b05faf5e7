"""Plants faults as people make them, one at a time, and tells which of them the tests see.

    python3 tests/plant_faults.py FOLDER [COUNT [SEED]]

Works in FOLDER, on a clone of this tree's last commit. The places are drawn at random, from every room
alike. The release stage is asked first, in the order of what is near; what it does not see, the long
stage is asked. Prints a line for each fault, and at the end the shares; faults that none saw show what
is untested, or change nothing that anybody can see.
"""
import os
import pathlib
import random
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
ROOMS = ROOT / "tests" / "architecture" / "rooms.txt"
AXES = {"[0]": "[1]", "[1]": "[2]", "[2]": "[0]"}

# A kind of fault: a pattern of code, and what takes its place.
KINDS = {
    "a sign": (re.compile(r"(?<=[\w)\]] )[+-](?= [\w(])"), lambda m: "-" if m[0] == "+" else "+"),
    "a comparison": (
        re.compile(r"(?<= )(<|>|<=|>=|==|!=)(?= )"),
        lambda m: {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}[m[0]],
    ),
    "an axis": (re.compile(r"(?<=\w)\[[012]\]"), lambda m: AXES[m[0]]),
    "a constant": (
        re.compile(r"(?<![\w.\[\"'])\d+(\.\d+)?(?![\w.\]\"'])"),
        lambda m: m[0] + "5" if "." in m[0] else str(int(m[0]) + 1),
    ),
    "a dropped branch": (re.compile(r"(?<=\bif \()(?=[^;]*\)$)"), lambda m: "0 && "),
}


def find_files(room):
    """Sources of a room, or of the formats; not those on CGAL, which take minutes to compile."""
    files = sorted(ROOT.glob(room + "/*.c")) + sorted(ROOT.glob(room + "/*.cpp"))
    return [path for path in files if "<CGAL/" not in path.read_text()]


def find_rooms():
    rooms = [line.split(":")[0] for line in ROOMS.read_text().splitlines() if re.match("[a-z]", line)]
    rooms += [str(folder.relative_to(ROOT)) for folder in sorted(ROOT.glob("cli/*")) if folder.is_dir()]
    return [room for room in dict.fromkeys(rooms) if find_files(room)]


def hide_text(line):
    """The line with strings and comments blanked out; None where no fault is planted."""
    if line.lstrip().startswith(("#", "/*", "*", "//")) or "assert(" in line or " * " in line[:4]:
        return None
    line = re.sub(r'"(\\.|[^"\\])*"', lambda m: '"' * len(m[0]), line)
    line = re.sub(r"/\*.*?(\*/|$)", lambda m: " " * len(m[0]), line)
    return line


def find_places(path, kind):
    pattern = KINDS[kind][0]
    is_comment = False
    for number, line in enumerate(path.read_text().splitlines()):
        if line.lstrip().startswith("/*"):
            is_comment = "*/" not in line
            continue
        if is_comment:
            is_comment = "*/" not in line
            continue
        hidden = hide_text(line)
        if hidden:
            for match in pattern.finditer(hidden):
                yield number, match


def draw_fault(rooms):
    """A file, the number of a line, the line with its fault, and the kind."""
    while True:
        path = random.choice(find_files(random.choice(rooms)))
        kind = random.choice(list(KINDS))
        places = list(find_places(path, kind))
        if places:
            number, match = random.choice(places)
            line = path.read_text().splitlines()[number]
            planted = line[: match.start()] + KINDS[kind][1](match) + line[match.end() :]
            return path.relative_to(ROOT), number, line, planted, kind


def run(folder, *command):
    """True if the command ended well; its words are in FOLDER/plant.log."""
    with open(folder / "build" / "plant.log", "w") as log:
        return subprocess.run(command, cwd=folder, stdout=log, stderr=log, check=False).returncode == 0


def build(folder):
    return run(folder, "cmake", "--build", "--preset", "release")


def find_failure(folder):
    """The first test that failed, of the last run."""
    text = (folder / "build" / "plant.log").read_text(errors="replace")
    failed = re.search(r"Test *#\d+: (\S+) \.*\**(?!.*(Passed|Skipped))", text)
    return failed[1] if failed else "?"


def ask(folder, *options):
    """The test that saw the fault, or None."""
    ctest = ("ctest", "--preset", "release", "-j", str(os.cpu_count()), "--stop-on-failure", "--timeout", "600")
    return None if run(folder, *ctest, *options) else find_failure(folder)


def judge(folder, room):
    """Which stage saw it, and by which test."""
    os.environ.pop("CUBEWRIGHT_TEST_LONG", None)
    seen = ask(folder, "-L", f"^{room}$") or ask(folder, "-LE", f"^(long|{room})$")
    if seen:
        return "release", seen
    os.environ["CUBEWRIGHT_TEST_LONG"] = "1"
    seen = ask(folder, "-L", "^(long|again)$")
    return ("long", seen) if seen else ("none", "")


def plant(folder, rooms):
    """Plants a fault that compiles, judges it, and takes it back."""
    while True:
        path, number, line, planted, kind = draw_fault(rooms)
        target = folder / path
        lines = (ROOT / path).read_text().splitlines()
        lines[number] = planted
        before = target.read_bytes()
        target.write_text("\n".join(lines) + "\n")
        try:
            if build(folder):
                stage, test = judge(folder, path.parts[0])
                return f"{path}:{number + 1}: {kind}: {line.strip()}  ->  {planted.strip()}", stage, test
        finally:
            target.write_bytes(before)


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 50
    random.seed(int(sys.argv[3]) if len(sys.argv) > 3 else 1)
    if not folder.exists():
        subprocess.run(["git", "clone", "-q", ROOT, folder], check=True)
    (folder / "build").mkdir(exist_ok=True)
    if not run(folder, "cmake", "--preset", "release", "-DCUBEWRIGHT_TESTS=ON") or not build(folder):
        sys.exit(f"the clone does not build: see {folder}/build/plant.log")
    rooms = find_rooms()
    stages = []
    for n in range(count):
        started = time.monotonic()
        fault, stage, test = plant(folder, rooms)
        stages.append(stage)
        print(f"{n + 1}. {stage} {test} ({time.monotonic() - started:.0f} s): {fault}", flush=True)
    seen, later = stages.count("release"), stages.count("long")
    print(f"{count} faults: {seen} seen by the release stage, {later} by the long one alone, "
          f"{stages.count('none')} by none; the release stage sees "
          f"{100 * seen / max(seen + later, 1):.0f} % of those that both see")


if __name__ == "__main__":
    main()
