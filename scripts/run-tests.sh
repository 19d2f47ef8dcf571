#!/bin/sh
# Runs the tests in two lanes at once, since those with real processes mostly wait, two files of them at a time: they
# have the cores first, the others what is left. With arguments, runs pytest with them instead.
set -u
cd "$(dirname "$0")/.."
pytest=".venv/bin/python -m pytest"
[ $# -eq 0 ] || exec $pytest "$@"

log=$(mktemp)
trap 'rm -f "$log"' EXIT
nice -n 19 $pytest -m "not realtime and not hosts" >"$log" 2>&1 &
other=$!
trap 'kill "$other" 2>/dev/null; exit 130' INT TERM
$pytest -m "realtime or hosts" -n 2 --dist loadfile
real=$?
wait "$other"
virtual=$?
cat "$log"
[ $real -eq 0 ] && [ $virtual -eq 0 ]
