#!/usr/bin/env bash
# Regenerates goldens by an array of eight Slurm tasks, some of which are requeued while they run, and by one process: the
# same bytes? Then validates the suite by an array, and by one process: the same results? Minutes; needs root, slurm-wlm,
# munge and python3.
#
#   scripts/examples/scale-out/slurm/test.sh
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../../../.." && pwd)
cargo build --quiet --release --manifest-path "$root/Cargo.toml"
export VOLREF=${CARGO_TARGET_DIR:-$root/target}/release/volref
work=$(mktemp -d)
trap '"$here/cluster.sh" stop "$work/slurm"; rm -rf "$work"' EXIT
"$here/cluster.sh" start "$work/slurm"
export SLURM_CONF=$work/slurm/slurm.conf

# Runs an array, and requeues six tasks of it while they run.
array() {
    local job running requeued=0
    job=$(sbatch --parsable --output="$work/task-%A-%a.log" "$here/volref.sbatch" "$@")
    while [ -n "$(squeue --noheader --job "$job")" ]; do
        running=$(squeue --noheader --array --job "$job" --states=RUNNING --format=%i | shuf -n 1)
        if [ -n "$running" ] && [ "$requeued" -lt 6 ]; then
            sleep "0.$((RANDOM % 10))"
            scontrol requeue "$running" 2>/dev/null && requeued=$((requeued + 1))
            # A requeued task waits before it may run again.
            sleep 1
            scontrol release "$job" 2>/dev/null || true
        fi
        sleep 1
    done
    echo "volref $1 by an array: $requeued tasks were requeued"
}

# Sampled cases, small enough for minutes.
cases=(fog/rate-0.05 fog/rate-0.1 fog/rate-0.3 procedural/gain-0.1 procedural/gain-0.5 procedural/threshold-1
    procedural/coloured fog/scattering)
for suite in one cases; do
    "$VOLREF" suite --extract "$work/$suite"
    rm -rf "$work/$suite/golden/fog" "$work/$suite/golden/procedural"
    for case in "${cases[@]}"; do
        samples=64
        [ "$case" = fog/scattering ] && samples=768
        sed -i "s/^converged_samples = .*/converged_samples = $samples/; s/^resolution = .*/resolution = 0.99/" \
            "$work/$suite/fixtures/cases/$case.toml"
    done
done

cd "$work/one"
"$VOLREF" accept "${cases[@]}" --reason 'the same'
cd "$work/cases"
array accept "${cases[@]}" --reason 'the same'
for case in "${cases[@]}"; do
    for file in exr png toml; do
        cmp "$work/one/golden/$case.$file" "$work/cases/golden/$case.$file"
    done
done
echo "goldens by an array are those of one process"

mkdir -p images/figures
"$VOLREF" render fixtures/scenes/figures/figure-3.toml --step '1 voxel' -o images/figures/figure-3.exr
cp golden/figures/figure-4.exr images/figures/
array validate --outputs images
"$VOLREF" merge . --json=joined.json >/dev/null || true
"$VOLREF" validate --outputs images --json=whole.json >/dev/null || true
python3 - <<'PYTHON'
import json
joined, whole = (json.load(open(f"{name}.json")) for name in ("joined", "whole"))
for results in joined, whole:
    for case in results["cases"]:
        case["seconds"] = 0
assert joined == whole, "the results differ"
print(f"results of {len(whole['cases'])} cases validated by an array are those of one process")
PYTHON
