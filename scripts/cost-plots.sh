#!/usr/bin/env bash
# The plots of the guide: error against work in figure 3 and in fractal noise.
#
# They are counted, not timed: the same on every machine, and a test holds them.
set -euo pipefail
cd "$(dirname "$0")/.."

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
scenes=fixtures/scenes
cargo run --release --quiet -- cost "$scenes/figures/figure-3.toml" \
    "$scenes/procedural/threshold-1.25.toml" --runs 0 --report "$folder" > /dev/null
mkdir -p golden/cost
cp "$folder/figure-3-image.svg" "$folder/threshold-1.25-transmittance.svg" golden/cost/
