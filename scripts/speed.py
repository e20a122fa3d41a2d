#!/usr/bin/env python3
"""Writes the tables of measured speed in src/guide/speed.md, each part by the command that stands above it.

    speed.py [WORD ...]      the parts with one of the words in their command; without words, all

A part begins with `<!-- by COMMAND -->` and ends with `<!-- end -->`. What the command prints takes the place of what is
between, with date and processor below it. If a command fails, its part stays as it is. All of it takes half an hour on two
idle cores. It needs valgrind, in the `python3` of the path NumPy, Matplotlib, Mitsuba and VTK, LLVM 17 or newer, and the build of
`cargo build --release`.
"""

import argparse
import datetime
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "src/guide/speed.md"
PART = re.compile(r"(<!-- by ([^\n]+) -->\n).*?(<!-- end -->)", re.DOTALL)


def processor():
    """Model and number of the processors that this program may use."""
    models = re.findall(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    return f"{models[0].strip()}, {len(models)} cores"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("words", nargs="*", metavar="WORD")
    words, failed = parser.parse_args().words, []
    commands = [part[2] for part in PART.finditer(PAGE.read_text())]
    chosen = [command for command in commands if not words or any(word in command for word in words)]
    if not chosen:
        sys.exit(f"no command holds {' or '.join(words)}; there are:\n" + "\n".join(commands))
    # Adapters of renderers import volref's package.
    environment = os.environ | {"PYTHONPATH": str(ROOT / "python")}
    for command in chosen:
        print(command, file=sys.stderr, flush=True)
        done = subprocess.run(command, shell=True, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True)
        if done.returncode:
            failed.append(command)
            continue
        written = f"\n{done.stdout.strip()}\n\n{datetime.date.today()}, {processor()}\n\n"
        page = PART.sub(lambda part: part[1] + written + part[3] if part[2] == command else part[0], PAGE.read_text())
        PAGE.write_text(page)
    if failed:
        sys.exit("failed, and left as it was: " + ", ".join(failed))


if __name__ == "__main__":
    main()
