"""A reference renderer for volumes, and golden images that other volume renderers are tested against.

``check`` judges an array as the image of a case, ``compare`` one image by another, ``cases`` lists the suite,
``scene`` and ``export`` say what to render, and ``render`` renders it. All of them call the program ``volref``, which the package brings.

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
from ._program import UnknownCase, VolrefError, program, version

__version__ = version()

__all__ = [
    "Case",
    "Comparison",
    "Flip",
    "Mistake",
    "Result",
    "UnknownCase",
    "VolrefError",
    "cases",
    "check",
    "compare",
    "export",
    "flip",
    "program",
    "render",
    "scene",
    "version",
]
