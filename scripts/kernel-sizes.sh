#!/usr/bin/env bash
# How much code the kernels are: a row of Markdown for each family, for the table in
# src/render/mod.rs. A test holds its numbers of kernels; sizes change with the compiler.
#
# Needs nm and size from binutils, which come with the C compiler. Builds the release once more, for
# its symbols to say what types they were compiled for, in target/kernel-sizes/.
set -euo pipefail
cd "$(dirname "$0")/.."

export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-target}/kernel-sizes
RUSTFLAGS="${RUSTFLAGS:-} -C symbol-mangling-version=v0" cargo build --quiet --release
binary=$CARGO_TARGET_DIR/release/volref
text=$(size -A "$binary" | awk '$1 == ".text" { print $2 }')

# The renderer calls a kernel through one closure of `rows`, which is how kernels are counted. Code
# compiled for effects that names no renderer serves both of them. What other parts of volref have
# compiled for themselves is not of the kernels.
nm -S -C "$binary" | awk -v text="$text" '
    function hexadecimal(digits,    value, i) {
        for (i = 1; i <= length(digits); i++)
            value = 16 * value + index("0123456789abcdef", substr(digits, i, 1)) - 1
        return value
    }
    $3 !~ /^[tTwW]$/ || /volref(\[[0-9a-f]*\])?::(cost|reference|conventions)::|classified::conventional::/ { next }
    /PathTracer|ByPathTracing/ { family = "path tracer" }
    /LineOfSight|ByLineOfSight/ { family = "line of sight" }
    !/PathTracer|ByPathTracing|LineOfSight/ {
        if (/effects::Only</) family = "shared by both"
        else next
    }
    {
        work = /counters::PerEvent</ ? "counted" : /counters::Uncounted/ ? "uncounted" : "either"
        bytes[family, work] += hexadecimal($2)
        if (/pixels::rows::</ && /::\{closure#0\}$/) kernels[family, work]++
    }
    function row(family, dimensions,    all) {
        all = bytes[family, "uncounted"] + bytes[family, "counted"] + bytes[family, "either"]
        if (kernels[family, "uncounted"] != kernels[family, "counted"]) {
            print family ": not as many kernels that count as that do not" > "/dev/stderr"
            exit 1
        }
        printf "| %s | %s | %s | %d | %d | %d | %.1f %% |\n", family,
            kernels[family, "uncounted"] ? kernels[family, "uncounted"] : "–", dimensions,
            bytes[family, "uncounted"] / 1024, bytes[family, "counted"] / 1024,
            bytes[family, "either"] / 1024, 100 * all / text
    }
    END {
        media = "media, surfaces, emission, colour, anisotropy, heterogeneity"
        print "| family | kernels | compiled for | uncounted, KiB | counted | either | of all code |"
        print "|---|---|---|---|---|---|---|"
        row("path tracer", media)
        row("line of sight", media)
        row("shared by both", "the same")
    }
'
