"""The program that the package calls."""

from __future__ import annotations

import atexit
import functools
import json
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

#: Environment variable for the program, in place of the one that the package brings.
PROGRAM_VARIABLE = "VOLREF_PROGRAM"
#: Environment variable for the folder of a suite, in place of the one within the program.
SUITE_VARIABLE = "VOLREF_SUITE"


class VolrefError(Exception):
    """The program could not do what it was asked to; says why, and what to do."""


class UnknownCase(VolrefError, KeyError):
    """There is no case of this name; says which is meant, if one is near."""

    def __str__(self) -> str:
        return Exception.__str__(self)


def version() -> str:
    """Version of the package, and of the program that it brings."""
    try:
        return metadata.version("volref")
    except metadata.PackageNotFoundError:
        return "unknown"


@functools.cache
def program() -> Path:
    """Path of the program: that of the environment variable VOLREF_PROGRAM, else the one installed with
    this package, else the one on the search path.

    Raises VolrefError if there is none.
    """
    given = os.environ.get(PROGRAM_VARIABLE)
    if given:
        if not Path(given).is_file():
            raise VolrefError(f"{PROGRAM_VARIABLE} names {given}, where there is no file")
        return Path(given)
    name = "volref.exe" if os.name == "nt" else "volref"
    folders = [sysconfig.get_path("scripts"), Path(sys.executable).parent]
    folders.append(sysconfig.get_path("scripts", sysconfig.get_preferred_scheme("user")))
    # Beside a package that was installed into a folder (pip install --target).
    folders.append(Path(__file__).parent.parent / "bin")
    for folder in folders:
        if folder and (Path(folder) / name).is_file():
            return Path(folder) / name
    found = shutil.which("volref")
    if found:
        return Path(found)
    raise VolrefError(
        "the program volref is not installed: this wheel holds none for your platform. Build one with Rust "
        f"(https://rustup.rs): pip install . in a clone of volref; or name a program: {PROGRAM_VARIABLE}=PATH"
    )


def suite_arguments(suite: str | os.PathLike[str] | None) -> list[str]:
    """Arguments for the suite: ``suite``, else that of VOLREF_SUITE, else the one of :func:`own_suite`, if it
    was asked for, else none."""
    folder = suite or os.environ.get(SUITE_VARIABLE) or (_own_suite and str(_own_suite))
    return ["--suite", os.fspath(folder)] if folder else []


_own_suite: Path | None = None


def own_suite() -> Path:
    """A copy of the suite within the program, for as long as this process: where the program can keep none."""
    global _own_suite
    if _own_suite is None:
        folder = Path(tempfile.mkdtemp(prefix="volref-suite-"))
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        call(["suite", "--extract", str(folder)])
        _own_suite = folder
    return _own_suite


def call(arguments: Sequence[str]) -> dict[str, Any]:
    """What the program prints as JSON. Raises VolrefError if it could not do its work."""
    words = [str(program()), *arguments, "--json"]
    try:
        ran = subprocess.run(words, capture_output=True, encoding="utf-8", errors="replace", check=False)
    except OSError as error:
        raise VolrefError(f"cannot run {words[0]}: {error}") from error
    try:
        value = json.loads(ran.stdout)
    except ValueError:
        said = (ran.stderr or ran.stdout).strip()
        raise VolrefError(f"{words[0]} {arguments[0]} ended with exit code {ran.returncode}:\n{said}") from None
    if value.get("schema") == "volref/error/1":
        message = value["error"]
        if value.get("help"):
            message = f"{message} ({value['help']})"
        if value["error"].startswith("no case matches"):
            raise UnknownCase(message)
        raise VolrefError(message)
    return value
