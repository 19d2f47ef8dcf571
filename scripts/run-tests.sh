#!/bin/sh
# Runs the tests in two lanes at once, since those with real processes mostly wait: they have the cores first, the others
# what is left. `long` runs, alone, what takes too long for every time. With other arguments, runs pytest with them.
set -u
cd "$(dirname "$0")/.."
# Where it is set, each of the hundreds of processes would compile all of Farhand, and each worker all tests.
unset PYTHONDONTWRITEBYTECODE
pytest=".venv/bin/python -m pytest"
# What has changed since: else each of the first processes would compile it, and those that wait for them give up.
.venv/bin/python -m farhand.laboratory.warm >/dev/null || exit 1
if [ "$*" = long ]; then
    FARHAND_TESTS=thorough exec $pytest -m "long or thorough" -n 2 --dist worksteal
fi
[ $# -eq 0 ] || exec $pytest "$@"

log=$(mktemp)
trap 'rm -f "$log"' EXIT
nice -n 19 $pytest -m "not realtime and not hosts and not long" -n 2 --dist worksteal >"$log" 2>&1 &
other=$!
trap 'kill "$other" 2>/dev/null; exit 130' INT TERM
# Only the files that have such tests: each of the processes would import all others as well.
files=$(grep -rlE --include="test_*.py" "mark\.(realtime|hosts)" tests)
$pytest -m "(realtime or hosts) and not long" -n 3 --dist loadfile $files
real=$?
wait "$other"
virtual=$?
cat "$log"
[ $real -eq 0 ] && [ $virtual -eq 0 ]
