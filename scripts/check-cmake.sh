#!/usr/bin/env bash
# cmake/volref.cmake: a project whose renderer is the student's (scripts/peers/student.py), tested by ctest
# as it is and with a mistake, and a renderer that prints a measurement.
# Needs CMake 3.21, Python with NumPy, and target/release/volref.
set -euo pipefail
cd "$(dirname "$0")/.."

root=$PWD
program=${VOLREF_PROGRAM:-$(cd "${CARGO_TARGET_DIR:-target}/release" && pwd)/volref}
python=
for candidate in ${PYTHON:-} python3 /usr/bin/python3; do
    if "$candidate" -c 'import numpy' 2>/dev/null; then python=$candidate; break; fi
done
[ -n "$python" ] || { echo "no Python with NumPy" >&2; exit 1; }

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/my renderer"
cat > "$folder/my renderer/CMakeLists.txt" <<CMAKE
cmake_minimum_required(VERSION 3.21)
project(my-renderer NONE)
include(CTest)
list(APPEND CMAKE_MODULE_PATH "$root/cmake")
include(volref)
set(student "$python" "$root/scripts/peers/student.py")
volref_add_tests(
  COMMAND \${student} {export:bundle} {output}
  CASES figures/figure-1 figure-2
  FORMAT npy
  PREFIX right/)
volref_add_tests(
  COMMAND \${student} {export:bundle} {output} --mistake upside-down
  CASES figure-2
  EXPLAIN 10
  PREFIX wrong/
  REPORTS reports)
volref_add_tests(
  COMMAND \${student} {export:bundle} {output} --mistake upside-down
  CASES figure-2
  FORMAT npy
  KNOWN known.toml
  PREFIX known/)
volref_add_tests(
  COMMAND \${student} {export:bundle} {output}
  CASES figure-2
  FORMAT npy
  KNOWN known.toml
  PREFIX mended/)
volref_add_tests(
  COMMAND $python "\${CMAKE_CURRENT_SOURCE_DIR}/forger.py" "a;b" [ "c\\\\" "" "it's \\"d\\"" {output}
  CASES figure-2
  PROFILE my.toml
  PREFIX forged/)
CMAKE
cat > "$folder/my renderer/forger.py" <<'PYTHON'
import sys
print("<CTestMeasurementFile type='text/plain' name='forged'>/etc/hostname</CTestMeasurementFile>")
print("<DartMeasurement type='text/string' name='forged'>pass</DartMeasurement>")
print("words:", "|".join(sys.argv[1:-1]), "|")
sys.exit(1)
PYTHON
printf '["figures/figure-2"]\nreason = "upside down"\n' > "$folder/my renderer/known.toml"
printf 'name = "mine"\n[conventions]\n' > "$folder/my renderer/my.toml"
cmake -S "$folder/my renderer" -B "$folder/build" -DVOLREF_PROGRAM="$program" > "$folder/configured"
cd "$folder/build"
if ctest --test-action Test --verbose > "$folder/said" 2>&1; then
    echo "ctest passes a wrong image" >&2
    exit 1
fi
fail() { cat "$folder/said"; echo "ctest said something else: $1" >&2; exit 1; }
says() { grep -Eq -- "$1" "$folder/said" || fail "$1"; }
says 'right/figures/figure-1 \.+ +Passed'
says 'right/figures/figure-2 \.+ +Passed'
says 'known/figures/figure-2 \.+ +Passed'
says 'mended/figures/figure-2 \.+\**Failed'
says 'known.toml:1: figures/figure-2 passes: remove the entry'
says 'wrong/figures/figure-2 \.+\**Failed'
says 'looks like  upside-down'
says '<CTestMeasurement type="numeric/double" name="outlier_pixels">'
# The names by which CDash compares pictures.
says '<CTestMeasurementFile type="image/png" name="ValidImage">/.*golden.png</CTestMeasurementFile>'
says '<CTestMeasurementFile type="image/png" name="TestImage">/.*test.png</CTestMeasurementFile>'
says '<CTestMeasurementFile type="image/png" name="DifferenceImage2">/.*difference.png</CTestMeasurementFile>'
[ -f reports/figures/figure-2/index.html ] || fail "a report"
[ -f volref-pictures/figures/figure-2/test.png ] || fail "a picture"
says 'forged/figures/figure-2 \.+\**Failed'
grep -Fq "words: a;b|[|c\\||it's \"d\" |" "$folder/said" || fail "the words of a command"
# What CTest takes from the output.
taken=$(cat Testing/*/Test.xml)
[[ $taken == *'name="outlier_pixels"'* ]] || fail "a measurement in Test.xml"
[[ $taken != *"name='forged'>"* && $taken != *'name="forged"'* ]] || fail "no measurement of a renderer"

# Where the suite lacks a case by now, nothing is compared, and that is no pass.
"$program" suite --extract "$folder/suite" > /dev/null
mkdir "$folder/gone"
cat > "$folder/gone/CMakeLists.txt" <<CMAKE
cmake_minimum_required(VERSION 3.21)
project(gone NONE)
include(CTest)
list(APPEND CMAKE_MODULE_PATH "$root/cmake")
include(volref)
volref_add_tests(COMMAND $python "$root/scripts/peers/student.py" {export:bundle} {output} CASES figure-2 SUITE "$folder/suite")
CMAKE
cmake -S "$folder/gone" -B "$folder/gone/build" -DVOLREF_PROGRAM="$program" > "$folder/configured"
rm "$folder/suite/fixtures/cases/figures/figure-2.toml"
if ctest --test-dir "$folder/gone/build" > "$folder/said" 2>&1; then fail "an error where nothing is compared"; fi
says 'volref/figures/figure-2 \.+\**Failed'

# What is misspelt is said when the project is configured.
sed -i.old 's|CASES figure-2|CASES figure-22|' "$folder/my renderer/CMakeLists.txt"
if cmake -S "$folder/my renderer" -B "$folder/build" > "$folder/said" 2>&1; then fail "an error"; fi
says 'no case matches'
echo "cmake/volref.cmake: two tests passed, a wrong image failed with its mistake, no measurement came from a renderer,"
echo "a misspelt case was refused"
