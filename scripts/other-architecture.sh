#!/usr/bin/env bash
# volref and its tests on another architecture than this one, which QEMU imitates.
#
#   scripts/other-architecture.sh build NAME     builds volref and the tests, optimised as a release,
#                                                and says where volref is: a program that runs here
#   scripts/other-architecture.sh test NAME      runs the tests
#
#   NAME   aarch64   another processor than those that made the goldens
#          s390x     the most significant byte is first
#          i686      words of 32 bits; runs on this very processor
#
# Needs rustup, and Debian or its kin on x86-64: there apt-get installs what is missing, elsewhere it
# is named. Without rustup: RUSTC=/usr/bin/rustc, from Debian's rustc-web, with the standard library
# of libstd-rust-web-dev:arm64 (after dpkg --add-architecture arm64).
set -euo pipefail
cd "$(dirname "$0")/.."

usage() { sed -n '2,/^set/{/^#/s/^# \?//p}' "$0" >&2 && exit 2; }
name=${2-}
case $name in
    aarch64) debian=arm64 machine=aarch64-linux-gnu emulator=qemu-aarch64-static ;;
    s390x) debian=s390x machine=s390x-linux-gnu emulator=qemu-s390x-static ;;
    i686) debian=i386 machine=i686-linux-gnu emulator=env ;;
    *) usage ;;
esac
target=$name-unknown-linux-gnu

# A folder of its own, and no flags for the processor here. Linked statically, a program needs no
# library of the other system when it runs.
export CARGO_TARGET_DIR=target/other
export RUSTFLAGS="-C target-feature=+crt-static"
export "CARGO_TARGET_${name^^}_UNKNOWN_LINUX_GNU_LINKER=$machine-gcc"
folder=$CARGO_TARGET_DIR/$target/release

# What depends on floats, words and the order of bytes: known answers and laws, random numbers, hashes,
# readers and writers of volumes, meshes and images, FLIP, the gate, kernels, exports, the commands.
# Of tests/library only these subjects: the others repeat them at length.
tests=(--lib --test cli --test library)
subjects=(
    comparators:: exchange:: film_noise:: flip_laws:: flip_scale:: geometry_laws:: hard_laws:: images::
    known_answers_flip:: known_answers_statistics:: medium_known_answers:: medium_laws::
    pinned_crates:: ray_caster:: volume_files:: volume_known_answers:: volume_laws::
)

install_missing() {
    local packages=("gcc-$machine" "libc6-dev-$debian-cross")
    [ $emulator = env ] || packages+=(qemu-user-static)
    if ! command -v "$machine-gcc" >/dev/null || ! command -v $emulator >/dev/null ||
        [ ! -f "/usr/$machine/lib/libc.a" ]; then
        if ! command -v apt-get >/dev/null; then
            echo "$name needs what these packages of Debian hold: ${packages[*]}" >&2
            exit 1
        fi
        { apt-get update -qq && apt-get install -y -qq --no-install-recommends "${packages[@]}"; } >&2
    fi
    if [ ! -d "$("${RUSTC:-rustc}" --print sysroot)/lib/rustlib/$target/lib" ]; then
        rustup target add $target >&2
    fi
}

# Builds what is not built yet. Fills `programs`: the tests.
build() {
    local said
    said=$(mktemp)
    cargo test --no-run --release --target $target "${tests[@]}" 2>&1 | tee "$said" >&2
    mapfile -t programs < <(sed -nE 's/^ *Executable .*\((.*)\)$/\1/p' "$said")
    rm "$said"
    # The tests of the commands start volref by this name, and nobody but us knows about the emulator.
    if [ "$(head -c 2 "$folder/volref")" != '#!' ]; then
        # In a folder of its own, since volref says by which name it was called. Cargo may have linked
        # the same file again, which mv refuses to move.
        mkdir -p "$folder/emulated"
        rm -f "$folder/emulated/volref"
        mv "$folder/volref" "$folder/emulated/volref"
        printf '#!/bin/sh\nexec %s %s "$@"\n' $emulator "$PWD/$folder/emulated/volref" >"$folder/volref"
        chmod +x "$folder/volref"
    fi
}

run_tests() {
    local program failed=0
    # The commands of the guide and of peers are not about numbers, and take long.
    local skipped=(--skip guide:: --skip peers::) wanted
    if [ "$name" = i686 ]; then
        # The memory that plans state depends on the size of a word.
        skipped+=(--skip plan::plans_of_the_suite)
    else
        # Processes are the same everywhere but under QEMU: there a program that does not exist has
        # ended with 127, and volref cannot start itself once more, as it does beside a renderer.
        skipped+=(
            --skip exit_codes_and_signals_are_failures --skip a_killed_process_leaves_old_or_new
            --skip renderers:: --skip a_renderer_is_run --skip a_report_says_how_it_is_reproduced
            --skip renderers_that_fail --skip verdicts_come_as_they_are_known
            --skip samples_that_were_asked_for_are_known
        )
    fi
    # QEMU before 8.0.4 multiplies two 32-bit floats wrongly where a 64-bit product is wanted (MDEBR).
    [ "$name" != s390x ] || skipped+=(--skip a_camera_is_read_back --skip quaternions_turn_and_mirror)
    for program in "${programs[@]}"; do
        echo "${program##*/}"
        wanted=()
        [[ ${program##*/} != library-* ]] || wanted=("${subjects[@]}")
        $emulator "$program" --quiet "${wanted[@]}" "${skipped[@]}" || failed=1
    done
    return $failed
}

case ${1-} in
    build)
        install_missing
        build
        echo "$folder/volref"
        ;;
    test)
        build
        run_tests
        ;;
    *) usage ;;
esac
