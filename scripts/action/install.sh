#!/usr/bin/env bash
# A step of action.yml: puts volref on the search path. What is there already is used; else the binary of the
# action's release, if it has one for this platform, which must have the checksum that the release states; else
# volref is built from the action's own files.
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
server=${GITHUB_SERVER_URL:-https://github.com}
url=$server/${GITHUB_ACTION_REPOSITORY:-}/releases/download/${GITHUB_ACTION_REF:-}/$asset
download() { curl --fail --silent --location --output "$folder/$1" "$2"; }
sha256() { if command -v sha256sum > /dev/null; then sha256sum; else shasum -a 256; fi; }
if [ -n "$asset" ] && [ -n "${GITHUB_ACTION_REF:-}" ] && download "$asset" "$url"; then
    if ! download "$asset.sha256" "$url.sha256"; then
        echo "$asset: the release has no checksum ($url.sha256): the binary is not used" >&2
        exit 1
    fi
    stated=$(grep -oE '^[0-9a-f]{64}' "$folder/$asset.sha256" || true)
    found=$(sha256 < "$folder/$asset")
    if [ "$stated" != "${found%% *}" ]; then
        echo "$asset: the file has another checksum than the release states ($url.sha256): it is not used" >&2
        exit 1
    fi
    tar -xzf "$folder/$asset" -C "$folder/bin"
else
    cargo install --locked --path "$GITHUB_ACTION_PATH" --root "$folder"
fi
echo "$folder/bin" >> "$GITHUB_PATH"
"$folder/bin/volref" --version
