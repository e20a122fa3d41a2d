#!/usr/bin/env bash
# The Python package against real renderers: builds its wheel, installs it with Mitsuba and VTK into an environment
# of its own, runs the guide's blocks, and judges VTK, as it comes, by a test of pytest. Minutes; needs PyPI.
set -euo pipefail
cd "$(dirname "$0")/../.."

root=$PWD
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m venv "$folder/venv"
python=$folder/venv/bin/python
"$python" -m pip install --quiet . pytest mitsuba vtk

cat > "$folder/test_vtk.py" <<TEST
import subprocess
import sys

import numpy as np
import pytest
import volref


@pytest.mark.volref("figures/figure-[134]")
def test_stock_vtk(volref_case, volref_check, tmp_path):
    bundle = volref.export(volref_case, "bundle", tmp_path)
    image = tmp_path / "image.npy"
    program = "$root/scripts/peers/vtk_render.py"
    subprocess.run([sys.executable, program, bundle, image, "--stock"], check=True)
    volref_check(volref_case, np.load(image), profile="vtk")
    assert volref.check(volref_case, np.load(image), explain=120).verdict == "convention"
TEST
cp python/tests/conftest.py python/tests/test_guide.py "$folder/"
cd "$folder"
VOLREF_CHAPTER=$root/src/guide/in_your_tests.md "$python" -m pytest --durations=0 -p no:cacheprovider .
