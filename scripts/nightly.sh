#!/usr/bin/env bash
# What takes too long for every change: hours in all. Goes on after a failure, and sums up at the end.
#
#   scripts/nightly.sh              every campaign
#   scripts/nightly.sh WORD…        those with one of the words in their title
#
# Needs what scripts/check.sh needs, and cargo-deny; for other architectures Debian or its kin on x86-64
# (scripts/other-architecture.sh).
set -uo pipefail
cd "$(dirname "$0")/.."

words=("$@")
summary=()
failed=0

# campaign TITLE COMMAND…
campaign() {
    local title=$1 outcome=passed word wanted=no
    shift
    for word in "${words[@]-}"; do
        [[ $title == *"$word"* ]] && wanted=yes
    done
    [ $wanted = yes ] || return 0
    printf '\n== %s\n' "$title"
    local start=$SECONDS
    if ! "$@"; then
        outcome=FAILED
        failed=1
    fi
    summary+=("$(printf '%-6s %5d s  %s' "$outcome" $((SECONDS - start)) "$title")")
}

# One line each; a campaign of your own is one more.
campaign "licences, sources and duplicates of dependencies" cargo deny check bans licenses sources
campaign "the smoke cloud is what its generator makes" scripts/generate-smoke.sh --check
campaign "the same bits from every build" scripts/same-bits.sh
campaign "the same bits on aarch64" scripts/same-bits.sh --architecture aarch64
campaign "the same bits on s390x, most significant byte first" scripts/same-bits.sh --architecture s390x
campaign "the same bits on i686, words of 32 bits" scripts/same-bits.sh --architecture i686
campaign "the gate: false alarms of 1000 suites, power" cargo test --release --test library gate:: -- --ignored --nocapture
campaign "honest images in every format: no alarm" cargo test --release --test library honest_images:: -- \
    --include-ignored --nocapture
campaign "200,000 scenes, others every day" env VOLREF_SCENES=200000 "VOLREF_SCENES_SEED=$(date +%Y%m%d)" \
    cargo test --release --test library any_scene::
campaign "a million inputs broken at random, others every day" env VOLREF_MUTANTS_COMMANDS=4 scripts/mutated-inputs.sh \
    1000000 "$(date +%Y%m%d)"
campaign "what every run tries in part: transport, decisions, roundings, modes, pages, generated scenes" env \
    VOLREF_NIGHTLY=1 cargo test --release --test library -- transport:: decide:: precision:: modes:: report:: reference:: \
    outside_faults::
campaign "every renderer with an adapter, judged again" env VOLREF_NIGHTLY=1 cargo test --release --test cli gallery::
campaign "300 kills of accept" scripts/kills.sh 300
campaign "many samples of every known answer" cargo test --release --test library known_answer_images:: -- \
    --ignored --nocapture
campaign "formulas to their last bits, on five times the inputs" env VOLREF_NIGHTLY=1 cargo test --release --test library \
    kernel_precision::
campaign "laws over hard cases: 100,000 each, others every day" env PROPTEST_CASES=100000 \
    "PROPTEST_RNG_SEED=$(date +%Y%m%d)" cargo test --release --test library hard_laws::
campaign "conventions: how often they are named, and mistakes taken for them" cargo test --release --test library \
    conventions::how_often -- --ignored --nocapture
campaign "names of faults outside the catalogue" cargo test --release --test library outside_faults:: -- \
    --skip mistakes_of_the_catalogue_are_named_first --include-ignored --nocapture
campaign "names of the mistakes of the catalogue, in noise" cargo test --release --test library \
    mistakes_of_the_catalogue_are_named_first -- --ignored --nocapture
campaign "every mistake of the catalogue in every case" cargo run --release --quiet -- selftest

if [ ${#summary[@]} = 0 ]; then
    echo "no campaign has such a word in its title: ${words[*]}" >&2
    exit 2
fi
printf '\n'
printf '%s\n' "${summary[@]}"
exit $failed
