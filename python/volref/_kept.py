"""Files that are kept in a folder of the user: each is written whole, and replaces those of its case alone."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path

from ._program import VolrefError

# pytest shows the line that called volref, not the lines of volref.
__tracebackhide__ = True

#: Extensions of images, and factors on the step: those of src/suite/outputs.rs.
EXTENSIONS = ("exr", "pfm", "npy", "png")
FACTORS = [0.5**halvings for halvings in range(11)]
#: Beginning of a line in the provenance of a golden.
PROVENANCE = b'schema = "volref/golden/'


def keep_images(images: Sequence[Path], outputs: Path, case: str, cases: Collection[str]) -> None:
    """Copies the ``images`` of ``case`` into ``outputs`` and removes others of the same case there; ``cases`` are
    the names in its family.

    Raises VolrefError for a folder of a suite, and OSError.
    """
    require_no_suite(outputs)
    family = case.rpartition("/")[0]
    folder = own_folder(outputs, family)
    with _alone(folder):
        put(images, folder, lambda name: case_of(f"{family}/{name}", cases) == case)


def put(files: Sequence[Path], folder: Path, is_old: Callable[[str], bool] = lambda name: False) -> None:
    """Copies ``files`` into ``folder``, and removes the files there whose name is old.

    Raises VolrefError, before anything is changed, if one of these is a golden.
    """
    for name in [*(file.name for file in files), *filter(is_old, os.listdir(folder))]:
        if is_golden(folder / name):
            raise VolrefError(f"{folder / name} is a golden, which only `volref accept` changes: give another folder")
    try:
        _put(files, folder, is_old)
    except OSError as error:
        # Not of a file beside it, which nobody finds again.
        raise OSError(error.errno, error.strerror, str(folder)) from None


def _put(files: Sequence[Path], folder: Path, is_old: Callable[[str], bool]) -> None:
    with tempfile.TemporaryDirectory(prefix=".volref-", dir=folder) as beside:
        # All before any is replaced: on a full disk nothing is lost.
        for file in files:
            shutil.copyfile(file, Path(beside) / file.name)
        for old in list(os.scandir(folder)):
            if is_old(old.name) and (old.is_symlink() or old.is_file()):
                os.unlink(old)
        for file in files:
            # A link is replaced, not followed.
            os.replace(Path(beside) / file.name, folder / file.name)


def case_of(file: str, cases: Collection[str]) -> str | None:
    """The one of ``cases`` whose image ``file`` is, ``family/name.extension``, by the rule of ``volref validate
    --outputs``."""
    stem, _, extension = file.rpartition(".")
    extension = extension.lower()
    if extension not in EXTENSIONS:
        return None
    if stem in cases:
        return stem
    name, _, factor = stem.rpartition("@")
    if name in cases:
        return name if _is_factor(factor) else None
    # A case may be called rate-0.1: the whole name comes before the number of a replicate.
    name, _, last = stem.rpartition(".")
    is_replicate = last.isascii() and last.isdigit() and int(last) < 2**32
    is_beside = (last, extension) in {("variance", "exr"), ("depth", "npy")}
    return name if name in cases and (is_replicate or is_beside) else None


def _is_factor(text: str) -> bool:
    try:
        return set(text) <= set("0123456789.eE+-") and float(text) in FACTORS
    except ValueError:
        return False


def own_folder(root: Path, within: str) -> Path:
    """The folder ``within`` ``root``, created where it is missing. Raises VolrefError where links lead elsewhere."""
    folder = root / within
    if not leads_nowhere_else(root, within):
        raise VolrefError(f"{folder} leads to another folder by a link, where nothing is changed: remove the link")
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def leads_nowhere_else(root: Path, within: str) -> bool:
    """The path ``within`` ``root`` has no links; ``root`` itself may be one."""
    expected = os.path.join(os.path.realpath(root), *within.split("/"))
    return os.path.normcase(os.path.realpath(root / within)) == os.path.normcase(expected)


def require_no_suite(folder: Path) -> None:
    """Raises VolrefError for a folder of a suite, whose goldens are images of cases by name, or of goldens elsewhere."""
    real = Path(os.path.realpath(folder))
    for above in (real, *real.parents):
        if above == real or above.name == "golden":
            require_no_goldens(above)
        if os.path.isdir(above / "golden") and os.path.isdir(above / "fixtures" / "cases"):
            raise VolrefError(f"{folder} is in a suite ({above}), where no images are kept: give a folder outside")


def require_no_goldens(folder: Path) -> None:
    """Raises VolrefError for a folder that holds goldens, or whose families do: outputs there would be taken for them."""
    for file in (*folder.glob("*.toml"), *folder.glob("*/*.toml")):
        if is_golden(file):
            raise VolrefError(f"{folder} holds goldens, such as {file.name}: give another folder")


def is_golden(file: Path) -> bool:
    """Whether ``file`` is a golden, which has its provenance beside it."""
    provenance = file.with_suffix(".toml")
    try:
        return file.is_file() and provenance.is_file() and PROVENANCE in provenance.read_bytes()[: 1 << 20]
    except OSError:
        return False


@contextlib.contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Waits for other processes and threads that change the images of ``folder``: two sets of one case are not to
    be mixed. Windows has no locks of folders; each file is whole there too."""
    try:
        import fcntl
    except ImportError:
        yield
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        # Some network file systems refuse.
        with contextlib.suppress(OSError):
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)
