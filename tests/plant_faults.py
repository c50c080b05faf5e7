"""Plants faults as people make them, and tells which of them the tests see.

    python3 tests/plant_faults.py FOLDER [COUNT [SEED]]

Works in FOLDER, on a clone of this tree's last commit without CGAL, which takes minutes to compile.
The places are drawn at random, from as many rooms as there are faults. A place whose object file stays
the same is drawn again. Each fault alone meets the tests of its folder, then the short ones of its room.
Faults that survive are then planted all at once, and the whole release stage is run. The tests that
fail are run again without a fault, and with fewer and fewer faults, until each stands alone. The long
stage then does the same with what is left, but runs at full length the unit tests of those folders
alone. Tests that cannot see a fault in the code (of its comments, walls and documents) or that only
repeat others on other machines are left out.

FOLDER/build/faults.json keeps what was found: a run that was stopped goes on from there. A test that
hangs has seen the fault. Faults that no test sees show what is untested, or what nobody can see.
"""
import json
import os
import pathlib
import random
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
AXES = {"[0]": "[1]", "[1]": "[2]", "[2]": "[0]"}
COMPARISONS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}
LEFT_OUT = re.compile(
    "text/(comments|versions|links)|architecture|abi|docs|features|linked|readme|schedulers/(parallel|slurm|dask|lost_host)"
)
SHORT = 2.0  # seconds of a test that a fault meets alone
HANGS = {"near": 200, "release": 300, "long": 900}  # seconds


def raise_number(text):
    if "." in text:
        return re.sub(r"f?$", r"5\g<0>", text, count=1)
    return str(int(text) + 1)


# A kind of fault: a pattern of code, and the code in its place.
KINDS = {
    "a sign": (re.compile(r"(?<=[\w)\]] )[+-](?= [\w(])"), lambda old: "-" if old == "+" else "+"),
    "a comparison": (re.compile(r"(?<= )(<|>|<=|>=|==|!=)(?= )"), COMPARISONS.get),
    "an axis": (re.compile(r"(?<=\w)\[[012]\]"), AXES.get),
    "a constant": (re.compile(r"(?<![\w.\[\"'])\d+(\.\d+f?)?(?![\w.\]\"'])"), raise_number),
    "a dropped branch": (re.compile(r"(?<=\bif \()[^;]*(?=\)( \{)?$)"), lambda old: f"0 && ({old})"),
}


# --- drawing ----------------------------------------------------------------------------------------


def find_objects(folder):
    """The object files of each source that the build compiles, without those of the tests."""
    objects = {}
    for entry in json.loads((folder / "build/release/compile_commands.json").read_text()):
        path = pathlib.Path(entry["file"])
        if path.is_relative_to(folder) and path.parts[len(folder.parts)] not in ("tests", "build"):
            objects.setdefault(str(path.relative_to(folder)), []).append(
                re.search(r" -o (\S+)", entry["command"])[1]
            )
    return objects


def hide_text(line):
    """The line with strings and comments blanked out."""
    line = re.sub(r'"(\\.|[^"\\])*"', lambda match: '"' * len(match[0]), line)
    return re.sub(r"/\*.*?(\*/|$)|//.*", lambda match: " " * len(match[0]), line)


def find_places(lines, pattern):
    is_comment = False
    for number, line in enumerate(lines):
        starts_comment = line.lstrip().startswith("/*")
        if is_comment or starts_comment:
            is_comment = "*/" not in line
        elif not line.lstrip().startswith("#") and "assert(" not in line:
            for match in pattern.finditer(hide_text(line)):
                yield number, match.span()


def draw_place(generator, paths, folder):
    """A fault in one of these files; it may not compile."""
    while True:
        path = generator.choice(paths)
        kind = generator.choice(list(KINDS))
        pattern, change = KINDS[kind]
        lines = (folder / path).read_text().splitlines()
        places = list(find_places(lines, pattern))
        if places:
            number, (start, end) = generator.choice(places)
            line = lines[number]
            planted = line[:start] + change(line[start:end]) + line[end:]
            return {"path": path, "line": number, "kind": kind, "before": line, "planted": planted}


# --- building and asking ----------------------------------------------------------------------------


def run(folder, *command):
    with open(folder / "build/plant.log", "w", encoding="utf-8") as log:
        return subprocess.run(command, cwd=folder, stdout=log, stderr=log, check=False).returncode == 0


def build(folder, *targets):
    options = ["--target", *targets] if targets else []
    return run(folder, "cmake", "--build", "build/release", *options)


def plant(folder, faults):
    """Puts these faults into the clone, and takes out any others."""
    subprocess.run(["git", "checkout", "-q", "."], cwd=folder, check=True)
    for fault in faults:
        target = folder / fault["path"]
        lines = target.read_text().splitlines()
        lines[fault["line"]] = fault["planted"]
        target.write_text("\n".join(lines) + "\n")


def find_tests(folder):
    """Name, labels and seconds of each test that can see a fault."""
    temporary = folder / "build/release/Testing/Temporary"
    costs = {}
    known = temporary / "CTestCostData.txt"  # of runs before
    for words in map(str.split, known.read_text().splitlines() if known.exists() else []):
        if len(words) == 3:
            costs[words[0]] = float(words[2])
    shown = subprocess.run(["ctest", "--preset", "release", "--show-only=json-v1"], cwd=folder, check=True,
                           capture_output=True)
    tests = []
    for test in json.loads(shown.stdout)["tests"]:
        labels = next((p["value"] for p in test["properties"] if p["name"] == "LABELS"), [])
        if not LEFT_OUT.match(test["name"]):
            tests.append({"name": test["name"], "labels": labels, "cost": costs.get(test["name"], 0)})
    return tests


def ask(folder, tests, stage, *options):
    """Those of the tests that fail."""
    if not tests:
        return []
    failed = folder / "build/release/Testing/Temporary/LastTestsFailed.log"
    failed.unlink(missing_ok=True)
    os.environ.pop("CUBEWRIGHT_TEST_LONG", None)
    if stage == "long":
        os.environ["CUBEWRIGHT_TEST_LONG"] = "1"
    names = "|".join(re.escape(test["name"]) for test in tests)
    if run(folder, "ctest", "--preset", "release", "-j", str(os.cpu_count()), "--timeout", str(HANGS[stage]),
           "-R", f"^({names})$", *options):
        return []
    names = [line.split(":", 1)[1] for line in failed.read_text().splitlines()]
    return [test for test in tests if test["name"] in names]


# --- judging ----------------------------------------------------------------------------------------


def find_folder(folder, test):
    """The folder of the code that a test is about: of its own name, among the tests."""
    kind, _, name = test["name"].partition("/")
    found = next((folder / "tests" / kind).glob(f"**/{name}.*"), None) if name else None
    if not found:
        return ""
    parts = found.relative_to(folder / "tests").parts[:-1]
    return "/".join(parts[1:] if kind == "unit" else parts)


def sort_near(folder, fault, tests):
    """The tests of a fault's folder, and the short ones of its room."""
    place = os.path.dirname(fault["path"])
    own, room = [], []
    for test in tests:
        if "long" in test["labels"]:
            continue
        if find_folder(folder, test) == place:
            own.append(test)
        elif place.split("/")[0] in test["labels"] and test["cost"] < SHORT:
            room.append(test)
    return own, room


def find_long(folder, faults, tests):
    """The long stage: of tests at full length only those of the survivors' folders."""
    places = {os.path.dirname(fault["path"]) for fault in faults if fault["stage"] == "none"}
    return [test for test in tests if "long" in test["labels"] or
            ("again" in test["labels"] and find_folder(folder, test) in places)]


def is_compiled(folder, fault, objects):
    """Whether the fault compiles, and into something else than the code without it."""
    outputs = [folder / "build/release" / name for name in objects[fault["path"]]]
    targets = objects[fault["path"]]
    plant(folder, [])
    if not build(folder, *targets):
        sys.exit(f"the clone does not build: see {folder}/build/plant.log")
    before = [output.read_bytes() for output in outputs]
    plant(folder, [fault])
    return build(folder, *targets) and before != [output.read_bytes() for output in outputs]


def meet_near(folder, generator, paths, objects, tests):
    """Draws a fault, and asks what is near."""
    while True:
        fault = draw_place(generator, paths, folder)
        if is_compiled(folder, fault, objects) and build(folder):
            break
    for near in sort_near(folder, fault, tests):
        seen = ask(folder, near, "near", "--stop-on-failure")
        if seen:
            return fault | {"stage": "release", "test": seen[0]["name"], "missed": []}
    return fault | {"stage": "none", "test": "", "missed": []}


def drop_unfit(folder, faults, tests, save):
    """Takes back what tests have seen that fail without a fault, too."""
    plant(folder, [])
    build(folder)
    names = {fault["test"] for fault in faults}
    unfit = {test["name"] for test in ask(folder, [t for t in tests if t["name"] in names], "release")}
    print("fail without a fault:", " ".join(sorted(unfit)) or "none", flush=True)
    for fault in faults:
        if fault["test"] in unfit:
            fault.update(stage="none", test="")
    save()
    return [test for test in tests if test["name"] not in unfit]


def find_guilty(folder, faults, tests, stage):
    """Of faults that together fail some of these tests: halves them until each stands alone."""
    plant(folder, faults)
    build(folder)
    failed = ask(folder, tests, stage, *(["--stop-on-failure"] if len(faults) == 1 else []))
    if failed and len(faults) == 1:
        faults[0].update(stage=stage, test=failed[0]["name"])
    elif failed:
        find_guilty(folder, faults[: len(faults) // 2], failed, stage)
        find_guilty(folder, faults[len(faults) // 2 :], failed, stage)


def meet_stage(folder, faults, tests, stage, save):
    """Asks a stage about faults that no test has seen, first about all at once."""
    left = [fault for fault in faults if fault["stage"] == "none" and stage not in fault["missed"]]
    left.sort(key=lambda fault: fault["path"])
    plant(folder, left)
    if not left or not build(folder):
        return
    failed = ask(folder, tests, stage)
    print(f"{stage}: {len(left)} faults at once fail {' '.join(test['name'] for test in failed)}", flush=True)
    plant(folder, [])
    build(folder)
    unfit = ask(folder, failed, stage)
    print("fail without a fault:", " ".join(test["name"] for test in unfit) or "none", flush=True)
    find_guilty(folder, left, [test for test in failed if test not in unfit], stage)
    for fault in left:
        fault["missed"] += [stage] if fault["stage"] == "none" else []
    save()


# --- the whole --------------------------------------------------------------------------------------


def prepare(folder):
    """A clone that is built."""
    if not folder.exists():
        subprocess.run(["git", "clone", "-q", ROOT, folder], check=True)
    (folder / "build").mkdir(exist_ok=True)
    plant(folder, [])
    if not run(folder, "cmake", "--preset", "release", "-DCUBEWRIGHT_TESTS=ON",
               "-DCUBEWRIGHT_CGAL=OFF") or not build(folder):
        sys.exit(f"the clone does not build: see {folder}/build/plant.log")


def show(number, fault):
    print(f"{number + 1}. {fault['stage']} {fault['test']}: {fault['path']}:{fault['line'] + 1}: {fault['kind']}: "
          f"{fault['before'].strip()}  ->  {fault['planted'].strip()}", flush=True)


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 50
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    pathlib.Path("/proc/self/oom_score_adj").write_text("1000")  # a fault that takes all memory is ended first
    prepare(folder)
    tests = find_tests(folder)
    objects = find_objects(folder)
    rooms = sorted({os.path.dirname(path) for path in objects})
    random.Random(seed).shuffle(rooms)
    results = folder / "build/faults.json"
    faults = json.loads(results.read_text()) if results.exists() else []

    def save():
        results.write_text(json.dumps(faults, indent=1))

    for number in range(len(faults), count):
        room = rooms[number % len(rooms)]
        paths = sorted(path for path in objects if os.path.dirname(path) == room)
        faults.append(meet_near(folder, random.Random(f"{seed}/{number}"), paths, objects, tests))
        save()
        show(number, faults[-1])
    tests = drop_unfit(folder, faults, tests, save)
    meet_stage(folder, faults, [test for test in tests if "long" not in test["labels"]], "release", save)
    meet_stage(folder, faults, find_long(folder, faults, tests), "long", save)
    plant(folder, [])
    for number, fault in enumerate(faults):
        show(number, fault)
    stages = [fault["stage"] for fault in faults]
    seen, later = stages.count("release"), stages.count("long")
    print(f"{count} faults: {seen} seen by the release stage, {later} by the long one alone, "
          f"{stages.count('none')} by none; the release stage sees "
          f"{100 * seen / max(seen + later, 1):.0f} % of those that both see")


if __name__ == "__main__":
    main()
