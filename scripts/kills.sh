#!/usr/bin/env bash
# Kills `accept` at random moments, in a suite of its own: whatever the moment, goldens are all the old ones or all the new
# ones, the same command run again succeeds, and nothing is left behind.
#
#   scripts/kills.sh [KILLS]        100 by default; of the build under development, or of the one that VOLREF names
set -euo pipefail
cd "$(dirname "$0")/.."
kills=${1:-100}
volref=${VOLREF:-${CARGO_TARGET_DIR:-$PWD/target}/debug/volref}
[ -n "${VOLREF-}" ] || cargo build --quiet
room=$PWD/fixtures/scenes/smoke/cornell.toml
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset CI VOLREF_SUITE
export VOLREF_CACHE=
cd "$work"

fail() {
    printf 'kill %d: %s\n' "$round" "$*" >&2
    tail -n 20 "$work/log" >&2
    exit 1
}

# Four stochastic cases and a deterministic one, as they were (old) and with other pictures (new).
for version in old new; do
    mkdir -p "$version"/{scenes,cases}/fog
    density=0.01 && [ $version = new ] && density=0.02
    for case in 1 2 3 4; do
        sed "s/= 256/= $((8 + 2 * case))/; s/^sigma_t = .*/sigma_t = $density/" "$room" >"$version/scenes/fog/$case.toml"
        printf '%s\n' 'source = "a test"' 'shows = "a room"' 'computes = "radiance"' 'class = "stochastic"' \
            'converged_samples = 64' 'quick_samples = 4' 'resolution = 0.99' >"$version/cases/fog/$case.toml"
    done
    printf '[film]\nwidth = 16\nheight = 12\n\n[curve]\ndensities = %s\n' "1${density#0}" >"$version/scenes/fog/curve.toml"
    printf '%s\n' 'source = "a test"' 'shows = "a curve"' 'computes = "its colours"' 'class = "deterministic"' \
        >"$version/cases/fog/curve.toml"
done

fixtures() { rm -rf suite/fixtures && cp -r "$1" suite/fixtures; }
run() { "$volref" "$@" --suite suite >>log 2>&1; }
all_files() { (cd suite && find . -not -type d -o -empty) | sort; }

accept=(accept '*' --reason 'a kill')
mkdir suite
round=0
fixtures old
run "${accept[@]}" || fail "no goldens"
clean=$(all_files)
fixtures new
start=$(date +%s%N)
run "${accept[@]}" || fail "no new goldens"
longest=$(($(date +%s%N) - start))

killed=0
before=new after=old
for ((round = 1; round <= kills; round++)); do
    fixtures $after
    : >log
    # A little longer than a whole run, in microseconds.
    delay=$((longest / 1000 * (RANDOM % 1100 + 1) / 1000))
    code=0
    # The shell says of every kill that it happened.
    {
        timeout --signal=KILL "$(printf '%d.%06d' $((delay / 1000000)) $((delay % 1000000)))" \
            "$volref" "${accept[@]}" --suite suite >>log 2>&1
    } 2>/dev/null || code=$?
    case $code in
    137) killed=$((killed + 1)) ;;
    0) ;;
    *) fail "it ended by itself with exit code $code" ;;
    esac
    if ! run verify; then
        fixtures $before
        run verify || fail "the goldens are neither the old ones nor the new ones"
        fixtures $after
    fi
    run "${accept[@]}" || fail "accept does not succeed afterwards"
    [ "$(all_files)" = "$clean" ] || fail "left behind: $(diff <(all_files) <(echo "$clean"))"
    [ $before = old ] && before=new after=old || { before=old after=new; }
    run verify || fail "the goldens do not verify afterwards"
done
echo "$kills runs, $killed of them killed: nothing wrong, and nothing left behind"
