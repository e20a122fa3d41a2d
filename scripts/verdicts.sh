#!/usr/bin/env bash
# What verdicts say of images with known faults: a table by kind of fault, in Markdown.
#
#   scripts/verdicts.sh             all faults, about an hour on two cores
#   scripts/verdicts.sh WORD…       those with one of the words in their name, case or kind
#
# Every verdict goes to target/verdicts.txt, the table also to the terminal.
set -euo pipefail
cd "$(dirname "$0")/.."

mkdir -p target
words=$(
    IFS=,
    echo "$*"
)
status=0
VOLREF_FAULTS=$words cargo test --test library names_of_faults_outside_the_catalogue -- --ignored --nocapture \
    >target/verdicts.txt || status=$?
grep '^|' target/verdicts.txt
exit $status
