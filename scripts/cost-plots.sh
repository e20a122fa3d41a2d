#!/usr/bin/env bash
# The plots of the guide: error against work in figure 3, and in a box of fractal noise by samples.
#
# They are counted, not timed: the same on every machine, and a test holds the first.
set -euo pipefail
cd "$(dirname "$0")/.."

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cargo run --release --quiet -- cost figures/figure-3 procedural/threshold-1.25 \
    --runs 0 --report "$folder" > /dev/null
mkdir -p golden/cost
cp "$folder/figure-3.svg" "$folder/threshold-1.25.svg" golden/cost/
