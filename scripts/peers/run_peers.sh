#!/usr/bin/env bash
# Stock VTK and Mitsuba over all cases that they can show, judged by volref: writes
# golden/peers/vtk.toml, vtk-unnamed.toml and mitsuba.toml. Half an hour with Mitsuba, minutes with VTK.
#
#   scripts/peers/run_peers.sh [vtk] [mitsuba]     # both, if none is named
#
# Needs `pip install vtk mitsuba numpy` for the python3 on the path, or for $PYTHON.
#
# VTK is judged twice: under its profile, and without a word on its conventions, which volref has to
# find. A verdict other than pass is kept with its reason; NOTES, if there is such a file beside the
# table (golden/peers/NAME.notes.toml), says who is right.
set -uo pipefail
cd "$(dirname "$0")/../.."

python=${PYTHON:-python3}
export PYTHONPATH=$PWD/python
peers=${*:-vtk mitsuba}
spp=${SPP:-64}
cargo build --quiet --release
volref=${CARGO_TARGET_DIR:-target}/release/volref
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# judged NAME VERSION OPTION…: runs `volref validate` and keeps its table.
judged() {
    local name=$1 version=$2 notes=()
    shift 2
    [ -f "golden/peers/$name.notes.toml" ] && notes=(--notes "golden/peers/$name.notes.toml")
    # Verdicts other than pass are no failure of this script.
    "$volref" validate --json="$folder/$name.json" "$@"
    case $? in 2 | 3) exit 1 ;; esac
    "$python" scripts/peers/peer_table.py "$folder/$name.json" --name "$name" --version "$version" "${notes[@]}"
}

for peer in $peers; do
    case $peer in
    vtk)
        version=$("$python" -c 'import vtk; print(vtk.vtkVersion().GetVTKVersion())') || exit 1
        # Figure 2 is a plot, and figure 5 has a shadow that VTK has no word for.
        shown="figure-1 figure-3 figure-4 limit"
        run="$python scripts/peers/vtk_render.py {export:bundle} {output} --stock --step {step}"
        judged vtk "$version" --only-present --as vtk --run "$run" $shown
        judged vtk-unnamed "$version" --only-present --explain 60 --run "$run" $shown
        ;;
    mitsuba)
        version=$("$python" -c 'import mitsuba; print(mitsuba.__version__)') || exit 1
        run="$python scripts/peers/run_mitsuba.py {export:mitsuba} {output} --spp {spp} --seed {seed}"
        judged mitsuba "$version" --explain 0 --timeout 300 --decide --budget 60m --spp "$spp" --run "$run" \
            fog smoke procedural known-answers hard
        ;;
    *)
        echo "unknown renderer: $peer; vtk and mitsuba are known" >&2
        exit 2
        ;;
    esac
done
