#!/usr/bin/env bash
# Prints the lines of code in src, by room and in all: without tests, comments and blank lines.
#
#   scripts/code-lines.sh            rooms
#   scripts/code-lines.sh --files    files, longest first
#
# A test module begins at `#[cfg(test)]`, or that of Unix alone, before `mod` and ends the file; files
# named tests.rs are tests, and so are folders named tests. A comment is a line that begins with `//`.
set -euo pipefail
cd "$(dirname "$0")/.."

find src -name '*.rs' ! -name tests.rs ! -path '*/tests/*' -print0 | sort -z | xargs -0 awk '
    FNR == 1 { tests = 0; attribute = 0 }
    tests { next }
    attribute && /^mod [a-z_]+ \{/ { tests = 1; count[FILENAME]--; next }
    { attribute = /^#\[cfg\((test|all\(test, unix\))\)\]$/ }
    /^[[:space:]]*(\/\/|$)/ { next }
    { count[FILENAME]++ }
    END { for (file in count) print count[file], file }
' | if [[ ${1-} == --files ]]; then
    sort -k1,1nr -k2
else
    awk '
        { split($2, part, "/"); room[part[2]] += $1; all += $1 }
        END { for (name in room) print room[name], name | "sort -nr"; close("sort -nr"); print all, "in all" }
    '
fi
