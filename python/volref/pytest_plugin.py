"""The plug-in for pytest: a fixture that judges images, and a mark for the cases of the suite.

``volref_check`` fails a test whose image is not right, with the reason and the likely mistake::

    def test_figure_3(volref_check):
        volref_check("figures/figure-3", my_renderer())

A test that takes ``volref_case`` runs once for each case that ``@pytest.mark.volref(filter, ...)`` names, all of
them without the mark::

    @pytest.mark.volref("smoke", "fog/rate-0.1")
    def test_my_renderer(volref_case, volref_check):
        volref_check(volref_case, my_renderer(volref_case.scene()))

Goldens are only read.
"""

from __future__ import annotations

import dataclasses
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import volref


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("volref", "images of volume renderers")
    group.addoption(
        "--volref-report",
        metavar="DIR",
        help="write a page for each image that does not pass: DIR/FAMILY/CASE/index.html",
    )
    group.addoption("--volref-outputs", metavar="DIR", help="keep the images that are judged in DIR")
    group.addoption("--volref-suite", metavar="DIR", help="suite to judge by, in place of the one within volref")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line(
        "markers",
        "volref(*filters): run the test once for each case of volref's suite that the filters name; "
        "the case is the argument volref_case",
    )


def pytest_report_header(config: pytest.Config) -> str:
    suite = config.getoption("volref_suite")
    return f"volref: {volref.version()}" + (f", suite {suite}" if suite else "")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "volref_case" not in metafunc.fixturenames:
        return
    mark = metafunc.definition.get_closest_marker("volref")
    filters = mark.args if mark else ()
    if mark and mark.kwargs:
        raise pytest.UsageError(f"{metafunc.definition.nodeid}: the mark volref takes filters alone, as texts")
    try:
        cases = volref.cases(*filters, suite=metafunc.config.getoption("volref_suite"))
    except (volref.VolrefError, TypeError) as error:
        raise pytest.UsageError(f"{metafunc.definition.nodeid}: {error}") from error
    metafunc.parametrize("volref_case", cases, ids=[case.name for case in cases])


@pytest.fixture
def volref_check(request: pytest.FixtureRequest) -> Callable[..., volref.Result]:
    """Judges an image as :func:`volref.check` does, and fails the test unless it passes.

    ``volref_check(case, image, variance=None, ...)`` returns the result of an image that passes. With
    ``allow_inconclusive=True`` an image that is too noisy to decide does not fail.
    """
    config = request.config
    folders = {
        "outputs": config.getoption("volref_outputs"),
        "suite": config.getoption("volref_suite"),
    }

    def check(
        case: str | volref.Case,
        image: Any,
        variance: Any = None,
        *,
        allow_inconclusive: bool = False,
        **arguments: Any,
    ) -> volref.Result:
        __tracebackhide__ = True
        given = {**{name: folder for name, folder in folders.items() if folder}, **arguments}
        reports = None if "report" in arguments else config.getoption("volref_report")
        try:
            result = _checked(case, image, variance, given, reports, allow_inconclusive)
            why = None
        except (volref.VolrefError, OSError) as error:
            why = str(error)
        if why is not None:
            pytest.fail(why, pytrace=False)
        request.node.user_properties.append((f"volref {result.name}", result.verdict))
        if _is_accepted(result, allow_inconclusive):
            return result
        hint = "" if result.report else "\n(--volref-report DIR writes a page with both images)"
        pytest.fail(f"{result}{hint}", pytrace=False)

    return check


def _is_accepted(result: volref.Result, allow_inconclusive: bool) -> bool:
    return result.passed or (allow_inconclusive and result.verdict == "inconclusive")


def _checked(
    case: str | volref.Case,
    image: Any,
    variance: Any,
    given: dict[str, Any],
    reports: str | None,
    allow_inconclusive: bool,
) -> volref.Result:
    """The result, with a page below ``reports`` if the image is not accepted, and none if it is."""
    if reports is None:
        return volref.check(case, image, variance, **given)
    with tempfile.TemporaryDirectory(prefix="volref-") as folder:
        result = volref.check(case, image, variance, **given, report=folder)
        kept = Path(reports) / result.name / "index.html"
        if _is_accepted(result, allow_inconclusive):
            # Of an earlier run, when it was not.
            kept.unlink(missing_ok=True)
            return dataclasses.replace(result, report=None)
        kept.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(Path(folder) / "index.html", kept)
    return dataclasses.replace(result, report=kept)
