"""Tests of the installed package: scripts/check-python.sh builds and installs the wheel."""

pytest_plugins = ["pytester"]
