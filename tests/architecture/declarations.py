"""Holds that a header declares only what its own room defines: declarations.py [ROOT]

A room is a folder of sources. Names that no source defines, such as those of generated files, may be
declared anywhere.
"""

import pathlib
import re
import sys

import circles

DATA = re.compile(r"^(?!static|extern|typedef)[a-zA-Z][\w ]*?[ *](\w+)(?:\[\w*\])*(?: =|;)", re.M)
BODY = re.compile(r"\{[^{}]*\}")


def find_homes(root):
    """Returns the room of each function and constant that is defined in a source."""
    homes = {}
    for path, code in circles.read_sources(root).items():
        for name in circles.DEFINED.findall(code) + DATA.findall(code):
            homes[name] = path.parent
    return homes


def list_declared(code):
    """Returns the names of functions and data that a header declares, without those it defines."""
    code = re.sub(r"^[ \t]*#(?:\\\n|[^\n])*", "", circles.TOKEN.sub(" ", code), flags=re.M)
    code = re.sub(r"extern\s*\{", "", code)
    while BODY.search(code):
        code = BODY.sub(";", code)
    for statement in code.split(";"):
        statement = statement.strip()
        if statement and not re.match(r"(typedef|static|struct \w+$|enum|union)\b", statement):
            yield from circles.NAME.findall(statement.split("(")[0])


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2])
    homes, known, bad = find_homes(root), 0, 0
    for room in circles.ROOMS:
        for path in sorted((root / room).rglob("*.h")):
            header = path.relative_to(root)
            for name in list_declared(path.read_text()):
                known += name in homes
                if homes.get(name, header.parent) != header.parent:
                    print(f"{header} declares {name}, which {homes[name]} defines")
                    bad += 1
    if not known:
        print("no declarations")
    print(f"{known} declarations, {bad} of another room")
    return bad or not known


sys.exit(1 if main() else 0)
