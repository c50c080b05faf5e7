"""Counts circles between files: sets of sources whose functions call each other. circles.py [ROOT]

Prints the files of each circle, and the calls that tie it. It is a report, not a test: a circle
through a callback or between two halves of one parser may be right.
"""

import collections
import pathlib
import re
import sys

ROOMS = ("core", "extract", "simplify", "formats", "viewer", "cli")
TOKEN = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])*\'', re.S)
DEFINED = re.compile(r"^(?!static|typedef|#|\s)[\w][\w\s\*]*?\b(\w+)\([^;{]*\)\s*\{", re.M)
NAME = re.compile(r"\b(?:cwi?|cli|view)_\w+")


def read_sources(root):
    """Returns the code of each source, without comments and strings."""
    paths = [p for room in ROOMS for p in sorted((root / room).rglob("*.c"))]
    return {p.relative_to(root): TOKEN.sub(" ", p.read_text()) for p in paths}


def find_calls(sources):
    """Returns which files each file calls, and by which functions."""
    home = {}
    for path, code in sources.items():
        for name in DEFINED.findall(code):
            home.setdefault(name, path)
    calls = {path: collections.defaultdict(set) for path in sources}
    for path, code in sources.items():
        for name in set(NAME.findall(code)):
            if home.get(name, path) != path:
                calls[path][home[name]].add(name)
    return calls


def find_circles(calls):
    """Returns the strongly connected components of more than one file [Tarjan1972]."""
    index, low, stack, circles = {}, {}, [], []

    def visit(path):
        index[path] = low[path] = len(index)
        stack.append(path)
        for other in calls[path]:
            if other not in index:
                visit(other)
            if other in stack:
                low[path] = min(low[path], low[other])
        if low[path] == index[path]:
            at = stack.index(path)
            if len(stack) - at > 1:
                circles.append(sorted(stack[at:]))
            del stack[at:]

    sys.setrecursionlimit(10000)
    for path in calls:
        if path not in index:
            visit(path)
    return sorted(circles, key=len, reverse=True)


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2])
    calls = find_calls(read_sources(root))
    circles = find_circles(calls)
    for circle in circles:
        print(f"{len(circle)} files")
        for path in circle:
            for other in sorted(set(calls[path]) & set(circle)):
                print(f"  {path} -> {other.name}: {', '.join(sorted(calls[path][other]))}")
    print(f"{len(circles)} circles, {sum(map(len, circles))} files")


if __name__ == "__main__":
    main()
