#!/usr/bin/env bash
# A step of action.yml: puts volref on the search path. What is there already is used; else the binary of the
# action's release, if it has one for this platform; else volref is built from the action's own files.
set -euo pipefail

if command -v volref > /dev/null; then
    volref --version
    exit 0
fi
folder=${RUNNER_TEMP:-/tmp}/volref
mkdir -p "$folder/bin"
case "${RUNNER_OS:-}-${RUNNER_ARCH:-}" in
    Linux-X64) asset=volref-x86_64-unknown-linux-gnu.tar.gz ;;
    macOS-ARM64) asset=volref-aarch64-apple-darwin.tar.gz ;;
    Windows-X64) asset=volref-x86_64-pc-windows-msvc.tar.gz ;;
    *) asset= ;;
esac
url="https://github.com/${GITHUB_ACTION_REPOSITORY:-}/releases/download/${GITHUB_ACTION_REF:-}/$asset"
if [ -n "$asset" ] && [ -n "${GITHUB_ACTION_REF:-}" ] &&
    curl --fail --silent --location --output "$folder/$asset" "$url"; then
    tar -xzf "$folder/$asset" -C "$folder/bin"
else
    cargo install --locked --path "$GITHUB_ACTION_PATH" --root "$folder"
fi
echo "$folder/bin" >> "$GITHUB_PATH"
"$folder/bin/volref" --version
