#!/usr/bin/python3
"""Writes cubewright/_declarations.py from the C headers: generate_declarations.py OUTPUT [--cc CC].

The headers are preprocessed with small stand-ins for the standard ones and parsed by pycparser.
With --probe a C program is written as well. It prints the sizes, offsets and values that a
compiler gives to everything declared, so that a test can compare them with those of ctypes.
"""

from __future__ import annotations

import argparse
import pathlib
import re
import subprocess
import tempfile

from pycparser import c_ast, c_parser

INCLUDE = pathlib.Path(__file__).resolve().parent.parent / "include"

# The types that our headers take from the standard ones.
STANDARD_HEADERS = {
    "stdbool.h": "#define bool _Bool\n",
    "stddef.h": "typedef unsigned long size_t;\ntypedef long ptrdiff_t;\n",
    "stdint.h": "".join(
        f"typedef {sign}{base} {sign[:1]}int{bits}_t;\n"
        for bits, base in ((8, "char"), (16, "short"), (32, "int"), (64, "long"))
        for sign in ("unsigned ", "")
    ).replace("typedef char int8_t", "typedef signed char int8_t"),
}

PLAIN_TYPES = {
    "void": "None",
    "_Bool": "c_bool",
    "char": "c_char",
    "int": "c_int",
    "unsigned": "c_uint",
    "unsigned int": "c_uint",
    "float": "c_float",
    "double": "c_double",
    "size_t": "c_size_t",
    "ptrdiff_t": "c_ssize_t",
    **{f"{sign}int{bits}_t": f"c_{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)},
}

# The Python types of fields, for type checkers. Everything else is Any.
FIELD_HINTS = {"c_bool": "bool", "c_float": "float", "c_double": "float", "c_char_p": "bytes | None"}

HEAD = '''"""Holds the declarations of the C library: structs, enums, constants and functions.

Made by generate_declarations.py from include/cubewright; do not edit.
"""

# ruff: noqa
from __future__ import annotations

import enum
from ctypes import (
    CFUNCTYPE,
    POINTER,
    Structure,
    c_bool,
    c_char,
    c_char_p,
    c_double,
    c_float,
    c_int,
    c_int8,
    c_int16,
    c_int32,
    c_int64,
    c_size_t,
    c_ssize_t,
    c_uint,
    c_uint8,
    c_uint16,
    c_uint32,
    c_uint64,
    c_void_p,
)
from typing import Any
'''


class Headers:
    """Holds what the headers declare, in their order."""

    def __init__(self) -> None:
        self.constants: dict[str, object] = {}  # of #define and of enums without a name
        self.enums: dict[str, dict[str, int]] = {}
        self.structs: dict[str, list[tuple[str, str]] | None] = {}  # None: opaque
        self.aliases: dict[str, str] = {}
        self.functions: dict[str, tuple[str, list[str]]] = {}
        self.variables: dict[str, str] = {}
        self.values: dict[str, int] = {}  # of all enumerators

    # Types -------------------------------------------------------------------------------------

    def name_type(self, node: c_ast.Node, is_parameter: bool = False) -> str:
        """Returns the ctypes expression of a declarator."""
        if isinstance(node, c_ast.TypeDecl):
            return self.name_plain(node.type)
        if isinstance(node, c_ast.ArrayDecl):
            element = self.name_type(node.type)
            if is_parameter:
                return f"POINTER({element})"
            return f"{self.group(element)} * {self.evaluate(node.dim)}"
        if isinstance(node, c_ast.PtrDecl):
            return self.name_pointer(node.type)
        raise ValueError(f"{node.coord}: a declarator that is not known")

    @staticmethod
    def group(element: str) -> str:
        return f"({element})" if " * " in element else element

    def name_plain(self, node: c_ast.Node) -> str:
        if isinstance(node, c_ast.IdentifierType):
            name = " ".join(node.names)
            if name in self.enums:
                return "c_int"
            name = self.aliases.get(name, name)
            if name in self.structs:
                return name
            return PLAIN_TYPES[name]
        raise ValueError(f"{node.coord}: a type without a name")

    def name_pointer(self, target: c_ast.Node) -> str:
        if isinstance(target, c_ast.FuncDecl):
            result, arguments = self.name_signature(target)
            return f"CFUNCTYPE({', '.join([result, *arguments])})"
        if isinstance(target, c_ast.TypeDecl):
            name = self.name_plain(target.type)
            if name == "None":
                return "c_void_p"
            if name == "c_char" and "const" in target.quals:
                return "c_char_p"
            return f"POINTER({name})"
        return f"POINTER({self.name_type(target)})"

    def name_signature(self, node: c_ast.FuncDecl) -> tuple[str, list[str]]:
        arguments = []
        for parameter in node.args.params if node.args else []:
            name = self.name_type(parameter.type, is_parameter=True)
            if name != "None":  # of f(void)
                arguments.append(name)
        return self.name_type(node.type), arguments

    # Values ------------------------------------------------------------------------------------

    def evaluate(self, node: c_ast.Node) -> int:
        if isinstance(node, c_ast.Constant):
            return int(node.value.rstrip("uUlL"), 0)
        if isinstance(node, c_ast.ID):
            return self.values[node.name]
        if isinstance(node, c_ast.BinaryOp):
            left, right = self.evaluate(node.left), self.evaluate(node.right)
            return {"<<": left << right, "-": left - right, "+": left + right}[node.op]
        raise ValueError(f"{node.coord}: an expression that is not known")

    def read_enum(self, node: c_ast.Enum) -> dict[str, int]:
        following = 0
        members = {}
        for member in node.values.enumerators:
            if member.value is not None:
                following = self.evaluate(member.value)
            members[member.name] = self.values[member.name] = following
            following += 1
        return members

    # Declarations ------------------------------------------------------------------------------

    def add(self, node: c_ast.Node) -> None:
        if isinstance(node, c_ast.Typedef):
            self.add_typedef(node)
        elif isinstance(node.type, c_ast.Enum):
            self.constants.update(self.read_enum(node.type))
        elif isinstance(node.type, c_ast.FuncDecl):
            self.functions[node.name] = self.name_signature(node.type)
        elif node.name and node.name.startswith("cw_"):
            self.variables[node.name] = self.name_type(node.type)

    def add_typedef(self, node: c_ast.Typedef) -> None:
        if not node.name.startswith("cw_"):
            return
        kind = node.type.type
        if isinstance(kind, c_ast.Enum):
            self.enums[node.name] = self.read_enum(kind)
        elif isinstance(kind, c_ast.Struct):
            self.structs.setdefault(node.name, None)
            if kind.decls is not None:
                self.structs[node.name] = [(d.name, self.name_type(d.type)) for d in kind.decls]
        else:
            self.aliases[node.name] = self.name_plain(kind)


def preprocess(cc: str, folder: str, *options: str) -> str:
    command = [cc, "-E", "-P", "-nostdinc", f"-I{folder}", f"-I{INCLUDE}", "-D__attribute__(x)="]
    main = f"{folder}/all.c"
    return subprocess.run([*command, *options, main], check=True, capture_output=True, text=True).stdout


def read_macros(text: str) -> dict[str, object]:
    """Returns the constants that are macros: numbers and strings, without casts."""
    found: dict[str, object] = {}
    for name, value in re.findall(r"^#define (CW_\w+) (.+)$", text, re.MULTILINE):
        plain = re.sub(r"\(\w+\)", "", value)
        shift = re.fullmatch(r"\(?(\d+)\s*<<\s*(\d+)\)?", plain.strip())
        if shift:
            found[name] = int(shift[1]) << int(shift[2])
        elif re.fullmatch(r'"[^"]*"', plain):
            found[name] = plain[1:-1]
        elif re.fullmatch(r"-?\d+", plain):
            found[name] = int(plain)
        elif re.fullmatch(r"-?[\d.]+(e-?\d+)?", plain):
            found[name] = float(plain)
    return found


def read_headers(cc: str) -> Headers:
    headers = Headers()
    with tempfile.TemporaryDirectory() as folder:
        for name, text in STANDARD_HEADERS.items():
            pathlib.Path(folder, name).write_text(text)
        pathlib.Path(folder, "all.c").write_text("#include <cubewright/cubewright.h>\n")
        for node in c_parser.CParser().parse(preprocess(cc, folder)).ext:
            headers.add(node)
        macros = read_macros(preprocess(cc, folder, "-dM"))
    headers.constants.update(sorted(macros.items()))
    return headers


def print_struct(name: str, fields: list[tuple[str, str]] | None) -> list[str]:
    lines = ["", "", f"class {name}(Structure):"]
    if fields is None:
        return [*lines, "    pass"]
    for field, kind in fields:
        hint = FIELD_HINTS.get(kind, "int" if re.fullmatch(r"c_(u?int\d*|s?size_t)", kind) else "Any")
        lines.append(f"    {field}: {hint}")
    lines += ["", "", f"{name}._fields_ = ["]
    lines += [f'    ("{field}", {kind}),' for field, kind in fields]
    return [*lines, "]"]


def print_module(headers: Headers) -> str:
    lines = [HEAD]
    lines += [f"{name} = {value!r}" for name, value in headers.constants.items()]
    for name, members in headers.enums.items():
        lines += ["", "", f"class {name}(enum.IntEnum):"]
        lines += [f"    {member} = {value}" for member, value in members.items()]
    for name, fields in headers.structs.items():
        lines += print_struct(name, fields)
    lines += ["", "", *(f"{name} = {target}" for name, target in headers.aliases.items())]
    lines += ["", "# The result and the arguments of each function.", "FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {"]
    for name, (result, arguments) in headers.functions.items():
        lines.append(f'    "{name}": ({result}, [{", ".join(arguments)}]),')
    lines += ["}", "", "VARIABLES: dict[str, Any] = {"]
    lines += [f'    "{name}": {kind},' for name, kind in headers.variables.items()]
    return "\n".join([*lines, "}", ""])


def print_probe(headers: Headers) -> str:
    """Returns a C program that prints `name value` for everything that ctypes can be asked."""
    lines = ["/* Prints what the compiler makes of the headers. */", "#include <cubewright/cubewright.h>"]
    lines += ["#include <stdio.h>", "", "int main(void)", "{"]

    def add(label: str, value: str) -> None:
        lines.append(f'    printf("{label} %lld\\n", (long long)({value}));')

    for name, fields in headers.structs.items():
        if fields is None:
            continue
        add(f"sizeof {name}", f"sizeof({name})")
        for field, _ in fields:
            add(f"offset {name}.{field}", f"offsetof({name}, {field})")
            add(f"size {name}.{field}", f"sizeof((({name} *)0)->{field})")
    for name, members in headers.enums.items():
        add(f"sizeof_enum {name}", f"sizeof({name})")
        for member in members:
            add(f"enum {name}.{member}", member)
    for name, value in headers.constants.items():
        if isinstance(value, str):
            lines.append(f'    printf("text {name} %s\\n", {name});')
        elif isinstance(value, float):
            lines.append(f'    printf("real {name} %.17g\\n", (double){name});')
        else:
            add(f"constant {name}", name)
    for name in headers.variables:
        add(f"variable {name}", f"sizeof({name})")
    return "\n".join([*lines, "    return 0;", "}", ""])


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("--cc", default="cc", help="C compiler that preprocesses")
    parser.add_argument("--probe", type=pathlib.Path, help="C program to write as well")
    arguments = parser.parse_args()
    headers = read_headers(arguments.cc)
    arguments.output.write_text(print_module(headers))
    if arguments.probe:
        arguments.probe.write_text(print_probe(headers))


if __name__ == "__main__":
    main()
