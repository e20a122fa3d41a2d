#!/usr/bin/env bash
# How many instructions it saves to leave out what is null, and the price of each effect, counted by callgrind.
# Prints tables in Markdown, those of src/guide/speed.md (scripts/speed.py).
#
# Counts repeat from run to run, but for a few hundred instructions of the allocator: the last of
# the three digits may move by one. Versions of the compiler differ by more; it is named below the
# tables. Takes some minutes.
set -euo pipefail
cd "$(dirname "$0")/.."

command -v valgrind >/dev/null || {
    echo "valgrind is missing: in Debian and Ubuntu it is in the package valgrind" >&2
    exit 2
}
# Callgrind looks for a function by its name.
export CARGO_PROFILE_RELEASE_STRIP=none
cargo build --quiet --release --package volref-scripts
"${CARGO_TARGET_DIR:-target}/release/instructions"
printf '\n%s, %s, profile release\n' "$(rustc --version)" "$(valgrind --version)"
