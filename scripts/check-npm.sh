#!/usr/bin/env bash
# The npm packages: packs the release that is built, installs them into a fresh project without a network, and runs
# npm/test there. Needs Node 18.3 with npm; pages are tested where there is Chromium.
set -euo pipefail
cd "$(dirname "$0")/.."

root=${CARGO_TARGET_DIR:-target}
folder=$(mkdir -p "$root/npm" && cd "$root/npm" && pwd)
rm -rf "$folder/packages" "$folder/project"
mkdir "$folder/project"
extension=$([ "${OS:-}" = Windows_NT ] && echo .exe || true)
program=$(cd "$root/release" && pwd)/volref$extension
node npm/pack.mjs "$folder/packages" "$(node -p 'process.platform + "-" + process.arch')=$program"
# Elsewhere: neither the package's sources nor another program are to be found by chance.
cp -r npm/test "$folder/project/"
cp src/guide/in_your_tests.md "$folder/"
cd "$folder/project"
echo '{ "private": true, "type": "module" }' >package.json
npm install --offline --no-audit --no-fund --silent "$folder"/packages/*.tgz
unset VOLREF_PROGRAM
export VOLREF_CHAPTER=$folder/in_your_tests.md
printed=$(mktemp)
trap 'rm -f "$printed"' EXIT
node --test test/ >"$printed" 2>&1 || { cat "$printed"; exit 1; }
grep -E '^(#|ℹ) (tests|skipped)' "$printed"
if [ -n "${VOLREF_TEST_EVERYTHING:-}" ] && grep -E '^(#|ℹ) skipped [1-9]' "$printed"; then exit 1; fi
