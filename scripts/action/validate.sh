#!/usr/bin/env bash
# A step of action.yml: runs volref validate, writes the job summary, and states the exit code as an output.
# The step itself fails only if that cannot be done: the report is kept first.
set -euo pipefail

refuse() {
    echo "$1" >&2
    exit 2
}

# Appends the words of $1 to `arguments`, split as a shell would, with nothing expanded.
split() {
    local text=$1 word='' begun='' quote='' letter index
    for ((index = 0; index < ${#text}; index++)); do
        letter=${text:index:1}
        case $quote$letter in
        "''" | '""') quote='' ;;
        "'"?*) word+=$letter ;;
        \\ | '"\')
            index=$((index + 1))
            letter=${text:index:1}
            case $quote$letter in
            '') refuse "arguments: nothing follows the last backslash: $text" ;;
            $'\n' | $'"\n') ;;
            '"'[!\"\\\$\`]) word+=\\$letter ;;
            *) word+=$letter begun=yes ;;
            esac
            ;;
        '"'?*) word+=$letter ;;
        "'" | '"') quote=$letter begun=yes ;;
        [[:space:]])
            if [ -n "$begun" ]; then arguments+=("$word"); fi
            word='' begun=''
            ;;
        *) word+=$letter begun=yes ;;
        esac
    done
    if [ -n "$quote" ]; then refuse "arguments: a quotation mark ($quote) is not closed: $text"; fi
    if [ -n "$begun" ]; then arguments+=("$word"); fi
}

if [ -n "${VOLREF_RUN:-}" ] && [ -n "${VOLREF_OUTPUTS:-}" ]; then refuse "give run or outputs, not both"; fi
arguments=(validate)
# Split at spaces, with nothing expanded.
set -f
for word in ${VOLREF_CASES:-}; do
    case $word in -*) refuse "cases: $word is an option, no case: give options as arguments" ;; esac
    arguments+=("$word")
done
set +f
if [ -n "${VOLREF_RUN:-}" ]; then arguments+=("--run=$VOLREF_RUN"); fi
if [ -n "${VOLREF_OUTPUTS:-}" ]; then arguments+=("--outputs=$VOLREF_OUTPUTS"); fi
if [ -n "${VOLREF_KNOWN:-}" ]; then arguments+=("--known=$VOLREF_KNOWN"); fi
split "${VOLREF_ARGUMENTS:-}"

report=${VOLREF_REPORT:-volref-report}
case $report in -*) report=./$report ;; esac
mkdir -p "$report"
code=0
# What a renderer prints is no command to the runner, such as ::error::, nor Markdown.
token=volref-$RANDOM$RANDOM$RANDOM
echo "::stop-commands::$token"
volref "${arguments[@]}" --report "$report" --json="$report/results.json" --junit "$report/results.xml" \
    > "$report/results.txt" || code=$?
cat "$report/results.txt"
echo "::$token::"
{
    echo "## volref"
    echo
    grep -E '^[0-9]+ cases?:' "$report/results.txt" || echo "Nothing was compared (exit code $code)."
    # Counts of known failures, and what is to change in their file: indented, as all that a renderer may have named.
    if [ -n "${VOLREF_KNOWN:-}" ]; then
        echo
        sed -n '/^known failures: /,/^$/p' "$report/results.txt" | sed 's/^/    /'
    fi
    echo
    sed 's/^/    /' "$report/results.txt"
} >> "$GITHUB_STEP_SUMMARY"
echo "exit-code=$code" >> "$GITHUB_OUTPUT"
