#!/usr/bin/env bash
# Everything that must hold before a change lands. CI runs exactly this; run it before a commit.
# Needs the Rust toolchain and a C compiler. What needs more is left out where that is missing, and named at the end;
# with VOLREF_TEST_EVERYTHING set, as in CI, that is an error.
set -euo pipefail
cd "$(dirname "$0")/.."

goldens() { git status --porcelain golden; }
goldens_before=$(goldens)

step() {
    step=$*
    printf '\n== %s\n' "$step"
}

left_out=()
# left_out NEED: the step is left out.
left_out() {
    echo "left out: that needs $1"
    left_out+=("$step: needs $1")
}

# beside COMMAND…: runs while the steps behind it do. What it prints follows where `joined` waits for it.
beside() {
    printed=$(mktemp)
    "$@" >"$printed" 2>&1 &
    beside=$!
    trap 'kill $beside 2>/dev/null || true' EXIT
}
joined() {
    local code=0
    wait $beside || code=$?
    trap - EXIT
    cat "$printed"
    rm "$printed"
    return $code
}

# Everything is built once, from nothing: what could be built again is not worth its keeping.
export CARGO_INCREMENTAL=0

# The FLIP oracle is C++. Where there is a compiler for it, all is built with it, and once.
if command -v c++ >/dev/null; then export RUSTFLAGS="${RUSTFLAGS:-} --cfg flip_oracle"; fi

# What is built for lints and tests is built for this very processor, the release for any: the tests and
# `verify` hold the same hashes of all goldens, so that both builds are known to give the same bits. Numbers of
# threads are compared at night.
for_any_processor=${RUSTFLAGS:-}
export RUSTFLAGS="$for_any_processor -C target-cpu=native"

# Tests wait now and then, for a browser or for one another.
beside env RUSTFLAGS="$for_any_processor" nice -n 19 cargo build --release

step "format"
cargo fmt --check

step "lints"
cargo clippy --workspace --all-targets -- -D warnings

step "tests, as in the README"
cargo test
while read -r test; do left_out+=("tests: needs $test"); done <"${CARGO_TARGET_DIR:-target}/tmp/not-tried.txt"

step "documentation"
RUSTDOCFLAGS="-D warnings" cargo doc --no-deps

export RUSTFLAGS=$for_any_processor

step "the release"
joined

step "the suite, as in the README"
cargo run --release -- verify

step "the Python package and its plug-in for pytest (begun; its output stands below)"
if python3 -c 'import ensurepip, sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
    beside scripts/check-python.sh
else
    beside true
    left_out "Python 3.11 with venv"
fi

step "the npm packages"
if node -e 'process.exit(process.versions.node.split(".")[0] < 18 ? 1 : 0)' 2>/dev/null && command -v npm >/dev/null; then
    scripts/check-npm.sh
else
    left_out "Node 18.3 and npm"
fi

step "cmake/volref.cmake"
if command -v ctest >/dev/null && { python3 -c 'import numpy' || /usr/bin/python3 -c 'import numpy'; } 2>/dev/null; then
    scripts/check-cmake.sh
else
    left_out "CMake, and Python with NumPy"
fi

step "parts by GNU parallel"
if command -v parallel >/dev/null && command -v jq >/dev/null; then
    scripts/check-scale-out.sh
else
    left_out "GNU parallel and jq"
fi

step "the suite catches every mistake and rejects no correct image, on cases that catch them all"
self_test=$(cargo run --release --quiet -- selftest --quick figures smoke fog/absorption fog/forward fog/balance \
    fog/rate-0.1 procedural/absorbing-grid procedural/emissive-grid procedural/coloured \
    procedural/gain-0.6 procedural/scale-2-0.5-2 scenes bricks reported) || { echo "$self_test"; exit 1; }
echo "$self_test"
if grep " 0 of 0 cases accept it" <<<"$self_test"; then
    echo "that kind of correct image was never tried"
    exit 1
fi
caught=$(sed -n 's/^\([0-9]*\) mistakes caught, 0 not;.*/\1/p' <<<"$self_test")
grep "In all, $caught mistakes" src/guide/working_on_volref.md || {
    echo "src/guide/working_on_volref.md states another number of mistakes than the $caught that are caught"
    exit 1
}

step "the core set catches as many mistakes as the guide says"
core=$(cargo run --release --quiet -- selftest --quick core) || true
caught=$(sed -n 's/^\([0-9]*\) mistakes caught, .*; 0 correct images rejected$/\1/p' <<<"$core")
grep "The core set catches $caught of the" src/guide/suite.md || {
    echo "$core"
    echo "src/guide/suite.md states another number of mistakes than the $caught that the core set catches"
    exit 1
}

step "the Python package and its plug-in for pytest"
joined

step "no golden was written"
test "$(goldens)" = "$goldens_before" || { goldens; exit 1; }

if [ ${#left_out[@]} = 0 ]; then
    printf '\nall checks passed, and none was left out\n'
else
    printf '\nwhat was checked passed; left out:\n'
    printf '  %s\n' "${left_out[@]}"
    [ -z "${VOLREF_TEST_EVERYTHING:-}" ]
fi
