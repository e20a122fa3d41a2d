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

from ._bundle import bundle, save
from ._program import Refusal

#: Version of the protocol, see src/guide/staying.md.
PROTOCOL = 1
#: Longest request, and longest words of an answer, in bytes.
MOST_LINE = 1 << 20
MOST_WORDS = 4096


def serve(render: Callable[[dict[str, Any]], ArrayLike | None]) -> None:
    """Answers the requests of ``volref validate --serve`` until there are no more.

    ``render`` takes a request and returns the image, which is saved as its ``output``, or ``None`` if it has saved
    that itself. :func:`refuse` answers `cannot`; any other exception answers `error` in its words, with the traceback
    on standard error. Printed text goes to standard error, too.
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


def main(
    render: Callable[..., ArrayLike | None], parser: argparse.ArgumentParser | None = None, *, export: str = "bundle"
) -> None:
    """The program of a renderer: ``SCENE OUTPUT`` for one picture, with ``--step H``, ``--spp N`` and ``--seed S``;
    ``--serve`` to stay.

    ``render`` takes a bundle of one panel, and returns its image; several panels are put side by side. With another
    ``export``, such as ``"mitsuba"``, it takes the request, whose ``export:mitsuba`` is the scene's file. ``parser`` may
    hold further options: ``render`` takes them by their names.
    """
    parser = parser or argparse.ArgumentParser()
    parser.add_argument("scene", type=Path, nargs="?", help=f"what `volref export --to {export}` wrote")
    parser.add_argument("output", type=Path, nargs="?", help="image: .exr, .npy or .pfm")
    parser.add_argument("--step", type=float, help="distance between samples, world units [the scene's]")
    parser.add_argument("--spp", type=int, help="samples per pixel, 2 or more [the scene's]")
    parser.add_argument("--seed", type=int, help="of random numbers, 0 or more [the scene's]")
    parser.add_argument("--serve", action="store_true", help="stay, and read requests from standard input")
    options = vars(parser.parse_args())
    file, output, stay = (options.pop(name) for name in ("scene", "output", "serve"))
    asked = {name: options.pop(name) for name in ("step", "spp", "seed")}
    name = f"export:{export}"

    def picture(request: Mapping[str, Any]) -> ArrayLike | None:
        if name not in request:
            raise ValueError(f"the request has no {export}: name {{{name}}} in the command")
        if export != "bundle":
            return render(request, **options)
        whole = bundle(request[name], request.get("step"), dict(request))
        if len(whole.panels) < 2:
            return render(whole, **options)
        return _side_by_side([render(whole.alone(index), **options) for index in range(len(whole.panels))])

    if stay:
        serve(picture)
    elif output is None:
        parser.error("give a scene and an output, or --serve")
    elif (asked["spp"] or 2) < 2 or (asked["seed"] or 0) < 0:
        parser.error("--spp is 2 or more, and --seed is not negative")
    else:
        try:
            image = picture({name: str(file), "output": str(output), **asked})
        except Refusal as refusal:
            sys.exit(f"refused: {refusal}")
        if image is not None:
            save(output, image)


def _side_by_side(images: list[ArrayLike | None]) -> ArrayLike:
    if any(image is None for image in images):
        raise ValueError("of several panels, return the images")
    return np.concatenate([np.asarray(image) for image in images], axis=1)
