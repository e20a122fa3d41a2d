"""The blocks of Python in the guide."""

import contextlib
import io
import os
import re
from pathlib import Path

import pytest

CHAPTER = Path(os.environ.get("VOLREF_CHAPTER", Path(__file__).parents[2] / "src/guide/in_your_tests.md"))


@pytest.fixture(scope="module")
def blocks():
    found = re.findall(r"```python\n(.*?)```", CHAPTER.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert len(found) == 3
    return found


def prints_what_it_shows(block):
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(block, {})
    (shown,) = re.findall(r"print\(.*\) +# (.*)", block)
    assert printed.getvalue() == shown + "\n"


def test_an_array_is_judged(blocks):
    prints_what_it_shows(blocks[0])


def test_mitsuba_is_judged(blocks, tmp_path, monkeypatch):
    pytest.importorskip("mitsuba")
    monkeypatch.chdir(tmp_path)
    prints_what_it_shows(blocks[2])


def test_a_renderer_is_tested(blocks, pytester):
    renderer, _ = blocks[0].split("\nimage =")
    pytester.makepyfile(my_renderer=renderer, test_mine=blocks[1])
    result = pytester.runpytest("--volref-report", "pages")
    result.assert_outcomes(failed=3)
    result.stdout.fnmatch_lines(["*looks like black:*", "*pages/*/index.html"])
