"""Packs the package into a wheel, for pip: a build backend without dependencies (PEP 517)."""

from __future__ import annotations

import base64
import hashlib
import pathlib
import re
import zipfile
from typing import Any

HERE = pathlib.Path(__file__).resolve().parent
PACKAGE = HERE / "cubewright"

METADATA = """\
Metadata-Version: 2.1
Name: cubewright
Version: {version}
Summary: Volumes into surfaces: exact, fast and honest about error
License: MIT
Requires-Python: >=3.9
Requires-Dist: numpy >=1.20
"""

WHEEL = """\
Wheel-Version: 1.0
Generator: cubewright
Root-Is-Purelib: true
Tag: py3-none-any
"""


def read_version() -> str:
    found = re.search(r"^CW_VERSION = '(.+)'$", (PACKAGE / "_declarations.py").read_text(), re.MULTILINE)
    assert found, "the declarations have no version"
    return found[1]


def build_wheel(wheel_directory: str, config_settings: Any = None, metadata_directory: Any = None) -> str:
    """Writes the wheel into a folder and returns its name."""
    version = read_version()
    info = f"cubewright-{version}.dist-info"
    files = {f"cubewright/{path.name}": path.read_bytes() for path in sorted(PACKAGE.glob("*.py"))}
    files["cubewright/py.typed"] = b""
    files[f"{info}/METADATA"] = METADATA.format(version=version).encode()
    files[f"{info}/WHEEL"] = WHEEL.encode()
    record = [f"{name},{print_digest(data)},{len(data)}" for name, data in files.items()]
    files[f"{info}/RECORD"] = "\n".join([*record, f"{info}/RECORD,,", ""]).encode()
    name = f"cubewright-{version}-py3-none-any.whl"
    with zipfile.ZipFile(pathlib.Path(wheel_directory, name), "w", zipfile.ZIP_DEFLATED) as wheel:
        for place, data in files.items():
            wheel.writestr(zipfile.ZipInfo(place), data)  # without times: the same bytes each time
    return name


def print_digest(data: bytes) -> str:
    return "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def build_sdist(sdist_directory: str, config_settings: Any = None) -> str:
    raise NotImplementedError("the package is part of cubewright's source; build a wheel")
