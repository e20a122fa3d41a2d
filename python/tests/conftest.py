"""Tests of the installed package: scripts/check-python.sh builds and installs the wheel."""

import os

# Where CI is set, no cause is looked for unless a test asks: the tests are those of any machine.
os.environ.pop("CI", None)

pytest_plugins = ["pytester"]
