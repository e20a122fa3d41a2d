#!/usr/bin/env python3
"""Writes what another renderer came to as a table to keep, golden/peers/NAME.toml.

    volref validate fog smoke procedural --run '...' --spp 64 --json=results.json
    peer_table.py results.json --name mitsuba --version 3.9.1 --spp 64 --notes notes.toml
    peer_table.py more.json --name mitsuba --version 3.9.1 --spp 256 --add

NOTES is TOML, a sentence for a case: who is right where they differ, and how that is known.
"""

import argparse
import json
import tomllib
from pathlib import Path

KEPT = [
    "mean_z_red", "mean_z_green", "mean_z_blue", "worst_block_z", "rejected_blocks",
    "amount_of_noise", "smallest_visible_bias", "outlier_share", "max_abs_error",
]


def quoted(text):
    return json.dumps(text, ensure_ascii=False)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=Path)
    parser.add_argument("--name", required=True)
    parser.add_argument("--version", required=True)
    parser.add_argument("--spp", type=int)
    parser.add_argument("--notes", type=Path)
    parser.add_argument("--add", action="store_true", help="keep the cases of the table that are not in the results")
    options = parser.parse_args()
    results = json.loads(options.results.read_text())
    notes = tomllib.loads(options.notes.read_text()) if options.notes else {}
    root = Path(__file__).resolve().parents[2]
    path = root / "golden" / "peers" / f"{options.name}.toml"
    new = {case["name"] for case in results["cases"]}
    kept, samples = [], options.spp
    if options.add:
        head, *tables = path.read_text().rstrip("\n").split("\n\n")
        kept = [table for table in tables if json.loads(table.split("]")[0].lstrip("[")) not in new]
        samples = tomllib.loads(head).get("samples")
    lines = [
        "# What volref says of another renderer's images, case by case: for information, judged by",
        "# nobody. Written by scripts/peers/peer_table.py.",
        f"renderer = {quoted(options.name)}",
        f"version = {quoted(options.version)}",
    ]
    if samples:
        lines.append(f"samples = {samples}")
    for table in kept:
        lines += ["", table]
    for case in results["cases"]:
        lines += ["", f"[{quoted(case['name'])}]", f"verdict = {quoted(case['verdict'])}"]
        if options.spp != samples and case["verdict"] != "missing":
            lines.append(f"samples = {options.spp}")
        if case["verdict"] in ("pass", "fail", "inconclusive"):
            lines.append(f"gate = {quoted(case['gate'])}")
            for name in KEPT:
                if name in case["metrics"]:
                    lines.append(f"{name} = {float(case['metrics'][name]):.4g}")
        if case["verdict"] != "pass":
            lines.append(f"reason = {quoted(case['reason'])}")
        if notes_of_case := case.get("notes"):
            lines.append(f"looks = {quoted('; '.join(notes_of_case))}")
        if note := notes.get(case["name"]):
            lines.append(f"note = {quoted(note)}")
    text = "\n".join(lines) + "\n"
    tomllib.loads(text)
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)
    print(path.relative_to(root))


if __name__ == "__main__":
    main()
