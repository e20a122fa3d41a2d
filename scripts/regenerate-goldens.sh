#!/usr/bin/env bash
# New goldens, on purpose: scripts/regenerate-goldens.sh [FILTER…] --reason TEXT [--keep-images]
#
# Renders the cases that the filters name (all of them without a filter) and accepts the results
# as goldens: all of them, or, if anything goes wrong, none. Look at the pictures before you
# commit them. It refuses where CI is set. Interrupted, it may be started again with the same
# words: stochastic cases that are finished are not rendered again.
set -euo pipefail
cd "$(dirname "$0")/.."

filters=()
reason=()
keep=()
while [ $# -gt 0 ]; do
    case "$1" in
        --reason) reason=(--reason "${2-}"); shift; [ $# -eq 0 ] || shift ;;
        --reason=*) reason=("$1"); shift ;;
        --keep-images) keep=(--keep-images); shift ;;
        -h|--help) sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
        -*) echo "unknown option $1; see --help" >&2; exit 2 ;;
        *) filters+=("$1"); shift ;;
    esac
done
if [ ${#reason[@]} -eq 0 ]; then
    echo "a golden changes for a reason: --reason TEXT" >&2
    exit 2
fi
if [ ${#filters[@]} -eq 0 ]; then
    filters=('*')
fi
exec cargo run --release -- accept "${filters[@]}" "${reason[@]}" ${keep[@]+"${keep[@]}"}
