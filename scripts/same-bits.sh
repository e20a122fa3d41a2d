#!/usr/bin/env bash
# The same bits from every build: debug, release, release for this very processor, and one or many
# threads. Renders cases of the suite by each, compares every bit with the goldens, runs the rows of
# the catalogue of hard cases (of which A5 holds functions and pictures to hashes written down in
# it), and compares the images themselves, as files.
#
#   scripts/same-bits.sh              the whole suite
#   scripts/same-bits.sh FILTER…      these cases (see volref verify --help)
#   scripts/same-bits.sh --architecture NAME …
#                                     release here against release on another architecture, where
#                                     tests are run as well (scripts/other-architecture.sh)
#
# Builds what is missing: debug and release in target/, the third in target/native/. Needs the Rust
# toolchain.
set -euo pipefail
cd "$(dirname "$0")/.."

architecture=
if [ "${1-}" = --architecture ]; then
    architecture=${2:?--architecture NAME: aarch64, s390x, …} && shift 2
fi
filters=("$@")
hashes=$(mktemp -d)
trap 'rm -rf "$hashes"' EXIT

say() { printf '\n-- %s\n' "$*"; }

# The images of a few scenes, by their bytes: deterministic and sampled, by every kind of kernel.
pictures=(
    figures/figure-1 figures/figure-3 figures/figure-5
    fog/heterogeneous procedural/coloured smoke/cornell
)

# try NAME PROGRAM [ARGUMENTS]
try() {
    local name=$1 program=$2 code=0
    shift 2
    say "$name"
    # To the end, whatever is found: which builds agree is worth knowing.
    "$program" verify --verbose "${filters[@]}" "$@" >"$hashes/$name.verify" 2>"$hashes/$name.error" || code=$?
    tail -n 1 "$hashes/$name.verify"
    if [ $code != 0 ]; then
        echo "exit code $code"
        head -n 20 "$hashes/$name.error"
        { grep -vE '^(pass|$)' "$hashes/$name.verify" || true; } | head -n 20 || true
        odd=1
    fi
    for picture in "${pictures[@]}"; do
        "$program" render "fixtures/scenes/$picture.toml" --spp 2 -o "$hashes/picture.exr" "$@" >/dev/null
        printf '%s  %s\n' "$(sha256sum <"$hashes/picture.exr" | cut -c1-16)" "$picture"
    done >"$hashes/$name.hashes"
    # Without times, what verify says is the same, too.
    sed -E 's/ +[0-9]+\.[0-9]+ s//' "$hashes/$name.verify" >>"$hashes/$name.hashes"
    builds+=("$name")
}

odd=0
builds=()
if [ -n "$architecture" ]; then
    cargo build --quiet --release
    elsewhere=$(scripts/other-architecture.sh build "$architecture")
    try release target/release/volref
    try "$architecture" "$elsewhere"
    say "tests on $architecture"
    scripts/other-architecture.sh test "$architecture" || odd=1
else
    cargo build --quiet
    cargo build --quiet --release
    CARGO_TARGET_DIR=target/native RUSTFLAGS="${RUSTFLAGS:-} -C target-cpu=native" cargo build --quiet --release
    try debug target/debug/volref
    try release target/release/volref
    try native target/native/release/volref
    try one-thread target/release/volref --threads 1
    try five-threads target/release/volref --threads 5
fi

say "compared"
first=${builds[0]}
for name in "${builds[@]}"; do
    if ! diff "$hashes/$first.hashes" "$hashes/$name.hashes"; then
        echo "$name: other bits than $first"
        odd=1
    fi
done
[ $odd = 0 ] || exit 1
grep -E '^[0-9a-f]{16}  ' "$hashes/$first.hashes"
echo "the same bits: ${builds[*]}"
