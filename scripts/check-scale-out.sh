#!/usr/bin/env bash
# Parts by GNU parallel, and a golden after a process that is killed: the results and the golden of one process. Needs
# parallel and jq, and a release build, which it makes.
#
#   scripts/check-scale-out.sh
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --quiet --release
volref=${CARGO_TARGET_DIR:-$PWD/target}/release/volref
golden=$PWD/golden/hard/g9-white-things-far-away.exr
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# accept writes to a copy.
unset CI VOLREF_SUITE
export VOLREF_CACHE=$work/cache
"$volref" suite --extract "$work/suite" >/dev/null
cd "$work/suite"

seq 4 | parallel "$volref" verify figures smoke --partition slice:{}/4 >/dev/null
"$volref" merge . --json=joined.json >/dev/null
"$volref" verify figures smoke --json=whole.json >/dev/null
timeless='.cases[].seconds = 0'
diff <(jq "$timeless" joined.json) <(jq "$timeless" whole.json)
echo "$(jq '.cases | length' whole.json) cases verified by four processes: the results of one"

rm golden/hard/g9-white-things-far-away.* && rm -r .volref
# 137: it was killed before it came to its end.
code=0
timeout --signal=KILL 0.5 "$volref" accept g9-white-things-far-away --reason 'killed' >/dev/null 2>&1 || code=$?
[ $code = 137 ]
"$volref" accept g9-white-things-far-away --reason 'again'
cmp golden/hard/g9-white-things-far-away.exr "$golden"
