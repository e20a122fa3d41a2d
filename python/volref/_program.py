"""The program that the package calls."""

from __future__ import annotations

import atexit
import contextlib
import functools
import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path
from typing import Any, NoReturn

# pytest shows the line that called volref, not the lines of volref.
__tracebackhide__ = True

#: Environment variable for the program, in place of the one that the package brings.
PROGRAM_VARIABLE = "VOLREF_PROGRAM"
#: Environment variable for the folder of a suite, in place of the one within the program.
SUITE_VARIABLE = "VOLREF_SUITE"


class VolrefError(Exception):
    """The program could not do what it was asked to; says why, and what to do."""

    # The name under which users know it.
    __module__ = "volref"


class UnknownCase(VolrefError, KeyError):
    """There is no case of this name; says which is meant, if one is near."""

    __module__ = "volref"

    def __str__(self) -> str:
        return Exception.__str__(self)


class Refusal(VolrefError):
    """A renderer has no words for something in a scene; says for what."""

    __module__ = "volref"


def refuse(reason: str) -> NoReturn:
    """Raises Refusal: the renderer has no words for what ``reason`` names."""
    raise Refusal(reason)


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
        "there is no program volref beside this package: it was removed, or the wheel held none for this platform. "
        "Install the package again (pip install --force-reinstall); or build the program with Rust "
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
        _hold(folder)
        _own_suite = folder
    return _own_suite


#: File by which the program knows temporary folders of killed processes: that of src/files/temporary_folder.rs.
LOCK = ".volref-lock"


def _hold(folder: Path) -> None:
    """Locks ``folder`` for as long as this process, however it ends: afterwards the program removes it. Windows has no
    such locks in Python."""
    try:
        import fcntl
    except ImportError:
        return
    # Not seen under its name before it is locked.
    aside = folder / f"{LOCK}-"
    held = os.open(aside, os.O_CREAT | os.O_WRONLY, 0o600)
    # Some file systems refuse: then the folder stays.
    with contextlib.suppress(OSError):
        fcntl.flock(held, fcntl.LOCK_EX)
        os.replace(aside, folder / LOCK)


def call(arguments: Sequence[str]) -> dict[str, Any]:
    """What the program prints as JSON. Raises VolrefError if it could not do its work."""
    words = [str(program()), *arguments, "--json"]
    ran = _run(words)
    try:
        value = json.loads(ran.stdout)
    except ValueError:
        value = None
    if not isinstance(value, dict) or "schema" not in value:
        _require_volref(words[0])
        said = (ran.stderr or ran.stdout).strip()
        raise VolrefError(f"{words[0]} {arguments[0]} ended with exit code {ran.returncode}:\n{said}")
    if value["schema"] == "volref/error/1":
        message = value["error"]
        if value.get("help"):
            message = f"{message} ({value['help']})"
        message = _in_terms_of_python(message)
        if value["error"].startswith("no case matches"):
            raise UnknownCase(message)
        raise VolrefError(message)
    return value


def _run(words: Sequence[str]) -> subprocess.CompletedProcess[str]:
    try:
        return subprocess.run(
            words, stdin=subprocess.DEVNULL, capture_output=True, encoding="utf-8", errors="replace", check=False
        )
    except OSError as error:
        raise VolrefError(f"cannot run {words[0]}: {error}") from None


def _require_volref(path: str) -> None:
    """Raises VolrefError if the program there is another one."""
    if not _run([path, "--version"]).stdout.startswith("volref "):
        named = f"{PROGRAM_VARIABLE} names {path}, which" if os.environ.get(PROGRAM_VARIABLE) else path
        raise VolrefError(f"{named} is not volref: it does not answer to --version as volref does")


def _in_terms_of_python(message: str) -> str:
    """A message of the program, with this package's functions and arguments in place of commands and options."""
    message = re.sub(r"\s*For more information, try '--help'\.\s*$", "", message.removeprefix("error: "))
    message = re.sub(r"`volref list[^`]*` shows", "volref.cases() lists", message)
    message = re.sub(r"`volref list[^`]*`", "volref.cases()", message)
    message = re.sub(r"^invalid value '(.*?)' for '--(\S+) <\S+>': ", r"\2 is '\1': ", message)
    for said, instead in [
        ("run volref in the suite's folder, or give the folder with --suite DIR", "give the folder of a suite"),
        ("--suite DIR", "suite=DIR"),
    ]:
        message = message.replace(said, instead)
    return message
