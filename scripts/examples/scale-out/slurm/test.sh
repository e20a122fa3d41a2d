#!/usr/bin/env bash
# Regenerates goldens by an array of eight Slurm tasks, some of which are requeued while they run, and by one process:
# the same bytes? Then verifies them by an array. Minutes; needs root, slurm-wlm and munge.
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

# Eight sampled cases, small enough for minutes.
cases=(fog/rate-0.05 fog/rate-0.1 fog/rate-0.3 fog/scattering procedural/gain-0.1 procedural/gain-0.5
    procedural/threshold-1 procedural/coloured)
for suite in one many; do
    "$VOLREF" suite --extract "$work/$suite"
    rm -rf "$work/$suite/golden/fog" "$work/$suite/golden/procedural"
    for case in "${cases[@]}"; do
        sed -i 's/^converged_samples = .*/converged_samples = 64/; s/^resolution = .*/resolution = 0.99/' \
            "$work/$suite/fixtures/cases/$case.toml"
    done
done

cd "$work/one"
"$VOLREF" accept "${cases[@]}" --reason 'by one process'
cd "$work/many"
job=$(sbatch --parsable --output="$work/task-%a.log" "$here/volref.sbatch" accept "${cases[@]}" --reason 'by one process')
requeued=0
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
for case in "${cases[@]}"; do
    for file in exr png; do
        cmp "$work/one/golden/$case.$file" "$work/many/golden/$case.$file"
    done
done
echo "eight goldens of an array are those of one process; $requeued tasks were requeued"

job=$(sbatch --parsable --wait --output="$work/verify-%a.log" "$here/volref.sbatch" verify "${cases[@]}") || {
    cat "$work"/verify-*.log
    exit 1
}
echo "verified by an array, job $job: $(ls results | wc -l) files of results"
