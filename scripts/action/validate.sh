#!/usr/bin/env bash
# A step of action.yml: runs volref validate, writes the job summary, and states the exit code as an output.
# The step itself fails only if that cannot be done: the report is kept first.
set -euo pipefail

if [ -n "${VOLREF_RUN:-}" ] && [ -n "${VOLREF_OUTPUTS:-}" ]; then
    echo "give run or outputs, not both" >&2
    exit 2
fi
arguments=()
# Split as a shell would, with nothing expanded.
set -f
for word in ${VOLREF_CASES:-}; do arguments+=("$word"); done
set +f
if [ -n "${VOLREF_RUN:-}" ]; then arguments+=(--run "$VOLREF_RUN"); fi
if [ -n "${VOLREF_OUTPUTS:-}" ]; then arguments+=(--outputs "$VOLREF_OUTPUTS"); fi
while IFS= read -r word; do
    if [ -n "$word" ]; then arguments+=("$word"); fi
done < <(xargs -n 1 <<< "${VOLREF_ARGUMENTS:-}")

report=${VOLREF_REPORT:-volref-report}
mkdir -p "$report"
code=0
volref validate "${arguments[@]}" --report "$report" --json="$report/results.json" --junit "$report/results.xml" \
    > "$report/results.txt" || code=$?
cat "$report/results.txt"
{
    echo "## volref"
    echo
    grep -E '^[0-9]+ cases?:' "$report/results.txt" || echo "Nothing was compared (exit code $code)."
    echo
    echo '```text'
    cat "$report/results.txt"
    echo '```'
} >> "$GITHUB_STEP_SUMMARY"
echo "exit-code=$code" >> "$GITHUB_OUTPUT"
