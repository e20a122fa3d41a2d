#!/usr/bin/env bash
# Everything that must hold before a change lands. CI runs exactly this; run it before a commit.
# Needs the Rust toolchain and a C compiler.
set -euo pipefail
cd "$(dirname "$0")/.."

goldens() { git status --porcelain golden; }
goldens_before=$(goldens)

step() { printf '\n== %s\n' "$*"; }

step "format"
cargo fmt --check

step "lints"
cargo clippy --all-targets -- -D warnings

step "tests, as in the README"
cargo test

if command -v c++ >/dev/null; then
    step "FLIP against NVIDIA's, pixel by pixel"
    cargo test --features flip-oracle --test flip_oracle
else
    step "FLIP against NVIDIA's: skipped, it needs a C++ compiler (c++)"
fi

step "documentation"
RUSTDOCFLAGS="-D warnings" cargo doc --no-deps

step "the suite, as in the README"
cargo run --release -- verify

step "the smoke cloud is what its generator makes"
scripts/generate-smoke.sh --check

step "no golden was written"
test "$(goldens)" = "$goldens_before" || { goldens; exit 1; }

printf '\nall checks passed\n'
