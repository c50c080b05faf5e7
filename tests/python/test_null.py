"""Calls every function of the C library with NULL in place of each pointer, and each that takes options with
a later version of them: an error, and no crash."""

import ctypes
import subprocess
import sys
import unittest

from cubewright import Status
from cubewright import _declarations as c
from cubewright._library import lib
from support import LIMIT_S, Case, main

# Functions without a status that need the pointers they are given: small computations.
NEEDS_POINTERS = {
    "cw_field_value",
    "cw_label_color",
    "cw_label_patch_area",
    "cw_label_volumes",
    "cw_image_place",
    "cw_check_paints",
    "cw_features",
    "cw_formats",
    "cw_transfer_at",
    "cw_transfer_gradient_factor",
    "cw_transfer_index",
    "cw_volume_to_world",
    "cw_volume_spacing",
    "cw_volume_corners",
}


def zero_of(kind):
    """Returns NULL for a pointer, and zero for a number or a struct."""
    if kind in (ctypes.c_char_p, ctypes.c_void_p) or hasattr(kind, "contents"):
        return None
    return kind() if issubclass(kind, ctypes.Structure) else kind(0)


def takes_error(arguments):
    return bool(arguments) and arguments[-1] is ctypes.POINTER(c.cw_error)


def call_all():
    """Calls each function; prints its name before, and the status and message after."""
    for name, (result, arguments) in sorted(c.FUNCTIONS.items()):
        if name in NEEDS_POINTERS or not arguments:
            continue
        print(name, end=" ", flush=True)
        error = c.cw_error()
        error.message = b"left over"
        values = [zero_of(kind) for kind in arguments]
        if takes_error(arguments):
            values[-1] = ctypes.byref(error)
        status = getattr(lib, name)(*values)
        print(status if takes_error(arguments) else "-", error.message.decode(), flush=True)
        if takes_error(arguments):  # without a place for the error, too
            getattr(lib, name)(*values[:-1], None)


LATER = 7  # than all versions of structs that there are


def is_desc(kind):
    return hasattr(kind, "contents") and kind._type_.__name__.endswith("_desc")


def later_of(kind):
    """Returns memory for a pointer, all 0 but the version of options; else as zero_of()."""
    if is_desc(kind):
        return ctypes.pointer(kind._type_(version=LATER))
    if kind in (ctypes.c_char_p, ctypes.c_void_p) or hasattr(kind, "contents"):
        return ctypes.cast(ctypes.create_string_buffer(1 << 16), kind)
    return zero_of(kind)


def call_later():
    """Calls each function that takes options; prints its name before, and the message after."""
    for name, (result, arguments) in sorted(c.FUNCTIONS.items()):
        if not takes_error(arguments) or not any(is_desc(kind) for kind in arguments):
            continue
        print(name, end=" ", flush=True)
        error = c.cw_error()
        status = getattr(lib, name)(*[later_of(kind) for kind in arguments[:-1]], ctypes.byref(error))
        print(status, error.message.decode(), flush=True)


class Null(Case):
    def test_every_function_refuses_options_of_a_later_version(self):
        run = subprocess.run([sys.executable, __file__, "later"], capture_output=True, text=True, timeout=LIMIT_S)
        lines = run.stdout.splitlines()
        self.assertEqual(run.returncode, 0, f"it crashed in {lines[-1] if lines else '?'}: {run.stderr}")
        self.assertGreater(len(lines), 60)
        for line in lines:
            name, status, *words = line.split()
            self.assertEqual(int(status), Status.ARGUMENT, line)
            self.assertIn(f"version is {LATER}; this library knows up to 0", " ".join(words), name)

    def test_every_function_takes_null(self):
        run = subprocess.run([sys.executable, __file__, "call"], capture_output=True, text=True, timeout=LIMIT_S)
        lines = run.stdout.splitlines()
        self.assertEqual(run.returncode, 0, f"it crashed in {lines[-1] if lines else '?'}: {run.stderr}")
        self.assertGreater(len(lines), 180)
        for line in lines:
            name, status, *words = line.split()
            if status == "-":
                continue
            message = " ".join(words)
            self.assertNotIn("left over", message, name)
            if int(status):
                self.assertEqual(int(status), Status.ARGUMENT, line)
                self.assertIn("NULL", message, line)
            else:
                self.assertIn(name, ("cw_allocator_set", "cw_memory_overflow", "cw_pipeline_check", "cw_team_agree"), line)


if __name__ == "__main__":
    if sys.argv[1:] == ["call"]:
        call_all()
    elif sys.argv[1:] == ["later"]:
        call_later()
    else:
        main()
