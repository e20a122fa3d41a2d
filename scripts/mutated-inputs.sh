#!/usr/bin/env bash
# Breaks inputs of every kind at random and sees that each is read or refused: no panic, no hang, no
# file written over, and no more than 4 GiB of memory. By night: a million take a quarter of an hour to an
# hour, with VOLREF_MUTANTS_COMMANDS=4, which gives one in four of those to a command that would be.
#
#   scripts/mutated-inputs.sh [COUNT [SEED]]
#
# A table says how many of each kind there were; what failed is kept in target/mutants, the input
# under way in target/mutants/under-way-SEED.
set -euo pipefail
cd "$(dirname "$0")/.."

export VOLREF_MUTANTS=${1:-100000}
export VOLREF_MUTANTS_SEED=${2:-1}

# Files in memory where there is such a folder: most of the time would be the disk's.
[ -w /dev/shm ] && export TMPDIR=${TMPDIR:-/dev/shm}

cargo test --test cli --no-run
# Address space, in KiB. The compiler may have more.
ulimit -v $((4 << 20))
exec cargo test --test cli mutated_inputs -- --nocapture
