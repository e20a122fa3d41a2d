#!/usr/bin/env bash
# The Python package: builds its wheel, installs it into a fresh environment with NumPy, pytest and Mitsuba, and runs
# python/tests there. Needs Python 3.11 with venv, and PyPI. With VOLREF_TEST_EVERYTHING set a skipped test is an error.
set -euo pipefail
cd "$(dirname "$0")/.."

python=${PYTHON:-python3}
root=${CARGO_TARGET_DIR:-target}
folder=$(mkdir -p "$root/python" && cd "$root/python" && pwd)
rm -rf "$folder/venv"
"$python" -m venv "$folder/venv"
pip() { "$folder/venv/bin/python" -m pip --quiet --disable-pip-version-check "$@"; }
# With the build of the release that is there, not a second one.
pip install "maturin>=1.7,<2"
PATH="$folder/venv/bin:$PATH" pip wheel --no-deps --no-build-isolation --wheel-dir "$folder/wheels" .
wheel=$(ls -t "$folder"/wheels/volref-*.whl | head -1)
echo "$(basename "$wheel"): $(($(stat -c %s "$wheel" 2>/dev/null || stat -f %z "$wheel") / 1024)) KiB"
pip uninstall --yes maturin
pip install "$wheel" "pytest>=7" "pytest-xdist>=3"
# There are no wheels for some systems.
pip install mitsuba || echo "without Mitsuba"
# Elsewhere: neither this package's sources nor its suite are to be found by chance.
cp pyproject.toml "$folder/"
rm -rf "$folder/tests"
cp -r python/tests "$folder/tests"
cp src/guide/in_your_tests.md "$folder/"
cd "$folder"
export VOLREF_CHAPTER=$folder/in_your_tests.md
"$folder/venv/bin/python" -m pytest --numprocesses auto --quiet -rs -c pyproject.toml --rootdir "$folder" "$folder/tests" "$@" | tee printed
if [ -n "${VOLREF_TEST_EVERYTHING:-}" ] && grep -q '^SKIPPED' printed; then exit 1; fi
