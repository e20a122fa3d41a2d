"""Renderers as programs: for one picture, or one that stays and reads requests, a line each."""

from __future__ import annotations

import argparse
import json
import os
import sys
import traceback
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import ArrayLike

from ._bundle import Bundle, Refusal, bundle, save

#: Version of the protocol, see src/guide/staying.md.
PROTOCOL = 1
#: Longest request, and longest words of an answer, in bytes.
MOST_LINE = 1 << 20
MOST_WORDS = 4096


def serve(render: Callable[[dict[str, Any]], ArrayLike | None]) -> None:
    """Answers the requests of ``volref validate --serve`` until there are no more.

    ``render`` takes a request and returns the image, which is saved as its ``output``, or ``None`` if it has saved
    that itself. :func:`refuse` answers `cannot`; any other exception answers `error` in its words, with the traceback
    on standard error. What is printed meanwhile goes to standard error.
    """
    sys.stdout.flush()
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    while line := sys.stdin.buffer.readline(MOST_LINE):
        answer = _answer(render, line, sys.stdin.buffer)
        try:
            print(json.dumps(answer), file=answers, flush=True)
        except BrokenPipeError:
            # Nobody reads; what is left in the buffer goes nowhere when the program ends.
            os.dup2(os.open(os.devnull, os.O_WRONLY), answers.fileno())
            return


def _answer(render: Callable[[dict[str, Any]], ArrayLike | None], line: bytes, rest: BinaryIO) -> dict[str, str]:
    try:
        request = _request(line, rest)
        output = request["output"]
        image = render(request)
        if image is not None:
            save(output, image)
        if not Path(output).is_file():
            raise FileNotFoundError(f"the renderer returned no image, and did not write {output}")
        return {"image": output}
    except Refusal as refusal:
        return {"cannot": str(refusal)[:MOST_WORDS]}
    except (Exception, SystemExit) as error:
        traceback.print_exc()
        return {"error": f"{type(error).__name__}: {error}"[:MOST_WORDS]}


def _request(line: bytes, rest: BinaryIO) -> dict[str, Any]:
    if len(line) == MOST_LINE and not line.endswith(b"\n"):
        while (more := rest.readline(MOST_LINE)) and not more.endswith(b"\n"):
            pass
        raise ValueError(f"a request of more than {MOST_LINE} bytes")
    try:
        request = json.loads(line)
    except (ValueError, RecursionError):
        request = None
    if not isinstance(request, dict) or not isinstance(request.get("output"), str):
        raise ValueError("the request is no JSON object with an output")
    if request.get("volref") != PROTOCOL:
        raise ValueError(f"the request is of version {request.get('volref')!r}, and this package speaks {PROTOCOL}")
    return request


def main(render: Callable[..., ArrayLike | None], parser: argparse.ArgumentParser | None = None) -> None:
    """The program of a renderer of bundles: ``BUNDLE OUTPUT [--step H]`` for one picture, ``--serve`` to stay.

    ``render`` takes a bundle of one panel, and returns its image; several panels are put side by side. ``parser`` may
    hold further options: ``render`` takes them by their names.
    """
    parser = parser or argparse.ArgumentParser()
    parser.add_argument("bundle", type=Path, nargs="?", help="what `volref export --to bundle` wrote")
    parser.add_argument("output", type=Path, nargs="?", help="image: .exr, .npy or .pfm")
    parser.add_argument("--step", type=float, help="distance between samples, world units [the scene's]")
    parser.add_argument("--serve", action="store_true", help="stay, and read requests from standard input")
    options = vars(parser.parse_args())
    file, output, step, stay = (options.pop(name) for name in ("bundle", "output", "step", "serve"))

    def picture(request: Mapping[str, Any]) -> ArrayLike | None:
        if "export:bundle" not in request:
            raise ValueError("the request has no bundle: name {export:bundle} in the command")
        whole = bundle(request["export:bundle"], request.get("step"), dict(request))
        if len(whole.panels) < 2:
            return render(whole, **options)
        return _side_by_side([render(whole.alone(index), **options) for index in range(len(whole.panels))])

    if stay:
        serve(picture)
    elif output is None:
        parser.error("give a bundle and an output, or --serve")
    else:
        try:
            image = picture({"export:bundle": file, "output": str(output), "step": step})
        except Refusal as refusal:
            sys.exit(f"refused: {refusal}")
        if image is not None:
            save(output, image)


def _side_by_side(images: list[ArrayLike | None]) -> ArrayLike:
    if any(image is None for image in images):
        raise ValueError("of several panels, return the images")
    return np.concatenate([np.asarray(image) for image in images], axis=1)
