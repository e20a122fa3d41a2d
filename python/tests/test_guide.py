"""The blocks of Python in the guide."""

import contextlib
import importlib.util
import io
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

CHAPTER = Path(os.environ.get("VOLREF_CHAPTER", Path(__file__).parents[2] / "src/guide/in_your_tests.md"))


@pytest.fixture(scope="module")
def blocks():
    found = re.findall(r"```python\n(.*?)```", CHAPTER.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert len(found) == 3
    return found


def shown_by(block):
    (shown,) = re.findall(r"print\(.*\) +# (.*)", block)
    return shown + "\n"


def prints_what_it_shows(block):
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(block, {})
    assert printed.getvalue() == shown_by(block)


def test_an_array_is_judged(blocks):
    prints_what_it_shows(blocks[0])


@pytest.mark.skipif(importlib.util.find_spec("mitsuba") is None, reason="needs Mitsuba")
def test_mitsuba_is_judged(blocks, tmp_path):
    # In a process of its own: pytester unloads modules, and those of Mitsuba crash when they are loaded again.
    ran = subprocess.run([sys.executable, "-c", blocks[2]], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ran.stdout == shown_by(blocks[2]), ran.stderr


def test_a_renderer_is_tested(blocks, pytester):
    renderer, _ = blocks[0].split("\nimage =")
    pytester.makepyfile(my_renderer=renderer, test_mine=blocks[1])
    result = pytester.runpytest("--volref-report", "pages")
    result.assert_outcomes(failed=3)
    result.stdout.fnmatch_lines(["*nothing was drawn:*", "volref: report: */pages/index.html"])
