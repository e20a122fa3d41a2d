#!/usr/bin/env python3
"""What the stochastic gate sees of wrong numbers: the tables of the guide, src/guide/sensitivities.md.

    scripts/power.py table       the smallest change of each number that is seen, by samples per pixel
    scripts/power.py honest      right images of all cases with sensitivities: how many fail, and their scores
    scripts/power.py faults      numbers that are wrong by twice what is seen: verdict, size that is found

Cases may follow. Needs `cargo build --release`; minutes to hours.
"""

import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
VOLREF = ROOT / "target/release/volref"
CASES = ["smoke/cornell", "fog/rate-0.05", "fog/rate-0.1", "fog/rate-0.3", "fog/scattering", "procedural/coloured"]
SAMPLES = [16, 64, 256]


def judged(case, spp, seed, change=None):
    """The result of validating volref's own image of `case`, with a number changed or not."""
    with tempfile.TemporaryDirectory() as folder:
        image = Path(folder) / f"{case}.exr"
        image.parent.mkdir(parents=True)
        command = [VOLREF, "render", f"fixtures/scenes/{case}.toml", "-o", image, f"--spp={spp}", f"--seed={seed}"]
        if change is not None:
            command.append(f"--change={change}")
        run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        if run.returncode:
            raise SystemExit(run.stderr)
        command = [VOLREF, "validate", case, "--outputs", folder, "--explain=0", "--json"]
        run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        return json.loads(run.stdout)["cases"][0]


def shown(size):
    """Three digits; `-` for what is not seen at all."""
    if size is None or size > 10:
        return "-"
    return f"{size:.3g}"


def table():
    """Sizes are shares of a number, or in the unit that `volref sensitivity CASE` states."""
    for case in chosen(CASES):
        columns = [{it["name"]: it for it in judged(case, spp, 1)["detectable"]} for spp in SAMPLES]
        print(f"\n`{case}`\n\n| number | " + " | ".join(f"{spp} spp" for spp in SAMPLES) + " |")
        print("| --- |" + " --- |" * len(SAMPLES))
        for name in columns[0]:
            sizes = [column.get(name, {}) for column in columns]
            cells = [shown(it.get("change")) for it in sizes]
            print(f"| `{name}` | " + " | ".join(cells) + " |", flush=True)


def with_sensitivities():
    folder = ROOT / "golden/sensitivities"
    return sorted(str(path.relative_to(folder).with_suffix("")) for path in folder.glob("*/*.exr"))


def chosen(default):
    return sys.argv[2:] or default


def honest():
    count, failed, scores = 0, 0, []
    for case in chosen(with_sensitivities()):
        for spp, seeds in [(16, range(100, 106)), (64, range(200, 202))]:
            for seed in seeds:
                result = judged(case, spp, seed)
                count += 1
                scores.append(result["metrics"].get("largest_score", 0.0))
                if result["verdict"] == "fail":
                    failed += 1
                    print(f"{case} {spp} spp, seed {seed}: {result['reason']}")
        print(f"{case}: largest scores {' '.join(f'{score:.1f}' for score in scores[-8:])}", flush=True)
    print(f"{count} right images: {failed} fail; largest score {max(map(abs, scores)):.2f}")


def faults():
    pulls = []
    for case in chosen(CASES):
        for it in judged(case, 64, 1)["detectable"]:
            for factor in (2.0, -2.0):
                change = factor * it["change"]
                try:
                    result = judged(case, 64, 7, f"{it['name']}={change}")
                except SystemExit:
                    continue
                found = [one for one in result.get("changes", []) if one["fits_best"]]
                right = [one for one in found if one["name"] == it["name"]]
                if right and len(found) == 1:
                    pulls.append((right[0]["change"] - change) / right[0]["error"])
                words = "; ".join(f"{one['name']} {one['change']:.4g} ± {one['error']:.2g}" for one in found)
                print(f"{case} {it['name']}={change:.4g}: {result['verdict']}, {words}", flush=True)
    square = math.sqrt(sum(pull * pull for pull in pulls) / len(pulls))
    print(f"{len(pulls)} named alone: mean pull {sum(pulls) / len(pulls):.2f}, root mean square {square:.2f}")


if __name__ == "__main__":
    what = {"table": table, "honest": honest, "faults": faults}.get(" ".join(sys.argv[1:2]))
    if what is None:
        raise SystemExit(__doc__)
    what()
