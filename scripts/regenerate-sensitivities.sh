#!/usr/bin/env bash
# Makes the derivatives that travel with the goldens, golden/sensitivities/FAMILY/CASE.exr, of blocks (by the
# refractive index: of pixels) by all numbers of a scene: of the cases that are given, or of all sampled cases of fog, smoke and procedural volumes.
# They are needed again where the scene of a case changes; an hour on two cores. The records of the goldens get
# their hashes; where a scene has changed, accept its new image first, without the old file.
set -euo pipefail
cd "$(dirname "$0")/.."

cargo build --release --quiet
volref=target/release/volref
cases=("$@")
if [ ${#cases[@]} -eq 0 ]; then
    mapfile -t cases < <("$volref" list fog smoke procedural | awk '$2 == "stochastic" { print $1 }')
fi
for case in "${cases[@]}"; do
    # Rooms and what is compared most have more; a path of the dense body takes twenty times as long.
    case $case in
        fog/absorption | fog/backward) spp=64 ;;
        fog/rate-* | fog/scattering | smoke/cornell) spp=32 ;;
        fog/dense-body) spp=4 ;;
        *) spp=16 ;;
    esac
    mkdir -p "golden/sensitivities/$(dirname "$case")"
    "$volref" sensitivity "fixtures/scenes/$case.toml" --all --spp "$spp" -o "golden/sensitivities/$case.exr"
done
"$volref" accept "${cases[@]}" --keep-images --reason "Sensitivities made anew"
