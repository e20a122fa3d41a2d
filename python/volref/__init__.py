"""A reference renderer for volumes, and golden images that other volume renderers are tested against.

``check`` judges an array as the image of a case, ``compare`` one image by another, ``cases`` lists the suite,
``scene`` and ``export`` say what to render, and ``render`` renders it. All of them call the program ``volref``, which the package brings.

``bundle`` reads an exported scene as numbers for an adapter of another renderer, which ``main`` makes a program that ``volref
validate`` calls; ``refuse``, ``save`` and ``serve`` are its parts.

Images are arrays of rows from the top:

- floating point of 16, 32 or 64 bits, shape (height, width, 3), (height, width, 4) with opacity, or
  (height, width) or (height, width, 1) for grey: linear radiance, in front of the background of the scene;
- ``uint8``, shape (height, width, 3), (height, width) or (height, width, 1): sRGB at the exposure of the case.
"""

from ._api import (
    Case,
    Comparison,
    Flip,
    Mistake,
    Result,
    cases,
    check,
    compare,
    export,
    flip,
    render,
    scene,
)
from ._bundle import Bundle, Table, Volume, bundle, save
from ._program import Refusal, UnknownCase, VolrefError, program, refuse, version
from ._radiance import Coefficients, Part, divided
from ._serve import main, serve

__version__ = version()

__all__ = [
    "Bundle",
    "Case",
    "Coefficients",
    "Comparison",
    "Flip",
    "Mistake",
    "Part",
    "Refusal",
    "Result",
    "Table",
    "UnknownCase",
    "Volume",
    "VolrefError",
    "bundle",
    "cases",
    "check",
    "compare",
    "divided",
    "export",
    "flip",
    "main",
    "program",
    "refuse",
    "render",
    "save",
    "scene",
    "serve",
    "version",
]
