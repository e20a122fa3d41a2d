"""The plug-in for pytest: a fixture that judges images, and a mark for the cases of the suite.

``volref_check`` fails a test whose image is not right, with the reason and the likely mistake::

    def test_figure_3(volref_check):
        volref_check("figures/figure-3", my_renderer())

A test that takes ``volref_case`` runs once for each case that ``@pytest.mark.volref(filter, ...)`` names; for all
of them without the mark, or with a mark that names none::

    @pytest.mark.volref("smoke", "fog/rate-0.1")
    def test_my_renderer(volref_case, volref_check):
        volref_check(volref_case, my_renderer(volref_case.scene()))

A mark that names cases, on a test that does not take ``volref_case``, is an error: it would judge nothing.

Goldens are only read.
"""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import volref
from volref._api import IMAGES, in_words, without_folder
from volref._kept import put, require_no_goldens, require_no_suite
from volref._program import call, suite_arguments

# pytest shows the line of the test that called volref_check, not the lines of volref.
__tracebackhide__ = True

#: Name of a page.
PAGE = "index.html"
#: By which processes of pytest-xdist are told the folder of the results.
RESULTS = "volref_results"
RESULTS_KEY = pytest.StashKey[Path]()
#: The page of the run, or why there is none.
PAGE_KEY = pytest.StashKey[str]()

INCONCLUSIVE = (
    "a less noisy image can be decided, or one of known noise: give the variance of the mean with samples=N, or a list "
    "of 16 or more renderings with seeds of their own; allow_inconclusive=True accepts it as it is"
)


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("volref", "images of volume renderers")
    group.addoption(
        "--volref-report",
        metavar="DIR",
        help="write one page with the images of all tests, DIR/index.html",
    )
    group.addoption(
        "--volref-outputs",
        metavar="DIR",
        help="keep the images that are judged in DIR, which is in no suite, in place of earlier ones of their cases",
    )
    group.addoption(
        "--volref-known",
        metavar="FILE",
        help="known failures, as of volref validate --known: a listed failure is an expected one, and a mended, worse or "
        "other one fails. The first file: volref validate --outputs DIR --only-present --known FILE --known-update, with the "
        "DIR of --volref-outputs [default: volref_known of the ini file, from the folder of that file]",
    )
    parser.addini("volref_known", "file of known failures, from the folder of this file")
    group.addoption("--volref-suite", metavar="DIR", help="suite to judge by, in place of the one within volref")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line(
        "markers",
        "volref(*filters): run the test once for each case of volref's suite that the filters name; "
        "the case is the argument volref_case",
    )
    # Absolute, for a test may change the current folder.
    if not config.getoption("volref_known") and config.getini("volref_known"):
        config.option.volref_known = os.path.join(config.rootpath, config.getini("volref_known"))
    for option in ["volref_report", "volref_outputs", "volref_known", "volref_suite"]:
        given = config.getoption(option)
        if given:
            setattr(config.option, option, os.path.join(config.invocation_params.dir, given))
    if _is_worker(config):
        if results := config.workerinput.get(RESULTS):
            config.stash[RESULTS_KEY] = Path(results)
        return
    for option, check in [("volref_report", require_no_goldens), ("volref_outputs", require_no_suite)]:
        _create(config.getoption(option), option, check)
    if config.getoption("volref_suite"):
        try:
            volref.cases(suite=config.getoption("volref_suite"))
        except volref.VolrefError as error:
            raise pytest.UsageError(f"--volref-suite {config.getoption('volref_suite')}: {error}") from None
    if config.getoption("volref_report"):
        results = Path(os.path.realpath(tempfile.mkdtemp(prefix="volref-results-")))
        config.stash[RESULTS_KEY] = results
        config.add_cleanup(lambda: shutil.rmtree(results, ignore_errors=True))


def _is_worker(config: pytest.Config) -> bool:
    """Whether this is a process that pytest-xdist started."""
    return hasattr(config, "workerinput")


def _create(folder: str | None, option: str, check: Callable[[Path], None]) -> None:
    """Creates the folder of an option, if one is given. Raises UsageError if it does not pass ``check``, or if nothing
    can be written there."""
    if not folder:
        return
    flag = f"--{option.replace('_', '-')}"
    named = f"{flag}: cannot write into {folder}"
    try:
        check(Path(folder))
        os.makedirs(folder, exist_ok=True)
    except volref.VolrefError as error:
        raise pytest.UsageError(f"{flag}: {error}") from None
    except OSError as error:
        raise pytest.UsageError(f"{named}: {error.strerror}") from None
    if not os.access(folder, os.W_OK | os.X_OK):
        raise pytest.UsageError(f"{named}: no permission")


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop(session: pytest.Session) -> None:
    """Removes the page of an earlier run."""
    config = session.config
    if config.getoption("volref_report") and not _is_worker(config) and not config.getoption("collectonly"):
        (Path(config.getoption("volref_report")) / PAGE).unlink(missing_ok=True)


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: Any) -> None:
    """Tells a process of pytest-xdist where results are kept."""
    if RESULTS_KEY in node.config.stash:
        node.workerinput[RESULTS] = str(node.config.stash[RESULTS_KEY])


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """Writes the page of the run: one for the images of all tests."""
    config = session.config
    results = config.stash.get(RESULTS_KEY, None)
    if results is None or _is_worker(config):
        return
    try:
        if any(results.iterdir()):
            config.stash[PAGE_KEY] = _page_of_all(results, config)
    except (volref.VolrefError, OSError) as error:
        config.stash[PAGE_KEY] = f"not written: {error}"


def _page_of_all(results: Path, config: pytest.Config) -> str:
    """Joins the results and writes their page; returns its path."""
    with tempfile.TemporaryDirectory(prefix="volref-") as folder:
        suite = suite_arguments(config.getoption("volref_suite"))
        call(["merge", str(results), f"--report={folder}", *suite])
        page = Path(folder) / PAGE
        text = page.read_text(encoding="utf-8")
        # Folders that are gone: those of the images, then that of the results.
        gone = f"{re.escape(str(results) + os.sep + IMAGES)}\\w+"
        images = in_words(config.getoption("volref_outputs"))
        for pattern in (gone, gone.replace("/", "&\\#x2f;")):
            text = re.sub(pattern, lambda _: images, text)
        page.write_text(without_folder(without_folder(text, str(results), "RESULTS"), folder, "REPORT"), encoding="utf-8")
        kept = Path(config.getoption("volref_report"))
        put([page], kept)
    return str(kept / PAGE)


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    if page := config.stash.get(PAGE_KEY, None):
        terminalreporter.write_line(f"volref: report: {page}")


def pytest_report_header(config: pytest.Config) -> str:
    suite = config.getoption("volref_suite")
    return f"volref: {volref.version()}" + (f", suite {suite}" if suite else "")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    mark = metafunc.definition.get_closest_marker("volref")
    filters = mark.args if mark else ()
    if mark and mark.kwargs:
        raise _usage_error(metafunc, "the mark volref takes filters alone, as texts")
    if "volref_case" not in metafunc.fixturenames:
        if filters:
            raise _usage_error(
                metafunc, "the mark volref names cases, and the test does not take the argument volref_case"
            )
        return
    try:
        cases = volref.cases(*filters, suite=metafunc.config.getoption("volref_suite"))
    except (volref.VolrefError, TypeError) as error:
        raise _usage_error(metafunc, str(error)) from None
    metafunc.parametrize("volref_case", cases, ids=[case.name for case in cases], indirect=True)


class _CollectError(pytest.UsageError, pytest.Collector.CollectError):
    """Wrong usage, of which pytest prints the message alone: of any other error while it collects tests it prints
    the traceback."""


def _usage_error(metafunc: pytest.Metafunc, message: str) -> Exception:
    return _CollectError(f"{metafunc.definition.nodeid}: {message}")


@pytest.fixture
def volref_case(request: pytest.FixtureRequest) -> volref.Case:
    """A case of the suite (:class:`volref.Case`): the test runs once for each that ``@pytest.mark.volref(filter,
    ...)`` names, and once for each of the suite without filters."""
    return request.param


@pytest.fixture
def volref_check(request: pytest.FixtureRequest) -> Callable[..., volref.Result]:
    """``volref_check(case, image, variance=None, *, samples=None, allow_inconclusive=False, ...)`` judges an image as
    :func:`volref.check` does, with its arguments, fails the test unless it passes, and returns the result.
    ``variance``: variance of the mean of each value, of the image's shape, with the number of ``samples`` per pixel.
    ``allow_inconclusive=True`` accepts an image that is too noisy to decide."""
    config = request.config
    folders = {
        "outputs": config.getoption("volref_outputs"),
        "known": config.getoption("volref_known"),
        "suite": config.getoption("volref_suite"),
    }

    # Of images that a test judges alike, each has a name of its own.
    counts: dict[str, int] = {}

    def check(
        case: str | volref.Case,
        image: Any,
        variance: Any = None,
        *,
        samples: int | None = None,
        allow_inconclusive: bool = False,
        **arguments: Any,
    ) -> volref.Result:
        given = {**{name: folder for name, folder in folders.items() if folder}, "samples": samples, **arguments}
        page = None
        if RESULTS_KEY in config.stash:
            page = Path(config.getoption("volref_report")) / PAGE
            count = counts[str(case)] = counts.get(str(case), 0) + 1
            name = request.node.nodeid + (f" #{count}" if count > 1 else "")
            given["_kept"] = (config.stash[RESULTS_KEY], name)
        try:
            result = volref.check(case, image, variance, **given)
            why = None
        except (volref.VolrefError, OSError) as error:
            why = str(error)
        if why is not None:
            pytest.fail(why)
        request.node.user_properties.append((f"volref {result.name}", result.verdict))
        known = result.known or {}
        if known.get("status") == "known":
            link = f" ({known['link']})" if known.get("link") else ""
            pytest.xfail(f"{known['reason']}{link}")
        is_accepted = result.passed or (allow_inconclusive and result.verdict == "inconclusive")
        if is_accepted and not known:
            return result
        lines = [f"{known['status']}: {known['change']}"] if known else []
        lines.append(str(result))
        if result.verdict == "inconclusive":
            lines.append(INCONCLUSIVE)
        if page:
            lines.append(f"report of all tests, once they have ended: {page}")
        elif not result.report:
            lines.append("(--volref-report DIR writes a page with the images of all tests)")
        pytest.fail("\n".join(lines))

    return check
