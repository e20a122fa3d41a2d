#!/usr/bin/env bash
# The same bits from every build: debug, release, release for this very processor, and one or many
# threads. Renders cases of the suite by each, compares every bit with the goldens, runs the rows of
# the catalogue of hard cases (of which A5 holds functions and pictures to hashes written down in
# it), and compares the images themselves. Another architecture is tried where its toolchain is.
#
#   scripts/same-bits.sh              the whole suite
#   scripts/same-bits.sh FILTER…      these cases (see volref verify --help)
#   scripts/same-bits.sh --built …    debug and release as they were built last, and no third build:
#                                     of check.sh, whose debug build is for this very processor
#
# Builds what is missing: debug and release in target/, the third in target/native/. With
# VOLREF_CROSS_TARGET another architecture than the two below is tried. Needs the Rust toolchain.
set -euo pipefail
cd "$(dirname "$0")/.."

built=no
if [ "${1-}" = --built ]; then
    built=yes
    shift
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
    "$program" verify "${filters[@]}" "$@" >"$hashes/$name.verify" 2>"$hashes/$name.error" || code=$?
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
if [ $built = no ]; then
    cargo build --quiet
    cargo build --quiet --release
    CARGO_TARGET_DIR=target/native RUSTFLAGS="${RUSTFLAGS:-} -C target-cpu=native" cargo build --quiet --release
fi

try debug target/debug/volref
try release target/release/volref
[ $built = yes ] || try native target/native/release/volref
try one-thread target/release/volref --threads 1
try five-threads target/release/volref --threads 5

say "another architecture"
for target in ${VOLREF_CROSS_TARGET:-aarch64-unknown-linux-gnu wasm32-unknown-unknown}; do
    if [ ! -d "$(rustc --print sysroot)/lib/rustlib/$target/lib" ]; then
        echo "$target: its standard library is not installed (rustup target add $target): not tried"
    elif cargo build --quiet --release --lib --target "$target"; then
        echo "$target: builds; its bits are compared where it runs, by this script"
    else
        echo "$target: does not build"
        odd=1
    fi
done

say "compared"
for name in "${builds[@]}"; do
    if ! diff "$hashes/debug.hashes" "$hashes/$name.hashes"; then
        echo "$name: other bits than debug"
        odd=1
    fi
done
[ $odd = 0 ] || exit 1
grep -E '^[0-9a-f]{16}  ' "$hashes/debug.hashes"
echo "the same bits: ${builds[*]}"
