#!/bin/sh
# Regenerates fixtures/volumes/smoke.obj; with --check, only compares it with the committed file
# and exits with 1 if they differ.
set -eu

cd "$(dirname "$0")/.."
target=fixtures/volumes/smoke.obj

generate() {
    # By the profile of the suite's check, which has built the library already.
    cargo run --quiet --release --package volref-scripts --bin smoke-plume -- "$1"
}

case "${1-}" in
--check)
    fresh=$(mktemp)
    trap 'rm -f "$fresh"' EXIT
    generate "$fresh"
    if ! cmp "$fresh" "$target"; then
        echo "$target differs from what scripts/smoke_plume.rs generates" >&2
        exit 1
    fi
    ;;
"")
    # Aside first: an interrupted run must not leave half a fixture.
    mkdir -p "$(dirname "$target")"
    trap 'rm -f "$target.new"' EXIT
    generate "$target.new"
    mv "$target.new" "$target"
    ;;
*)
    echo "usage: generate-smoke.sh [--check]" >&2
    exit 2
    ;;
esac
