#!/bin/sh
# healthy.sh listening PORT... | connected PORT
# Healthy is: the program listens on every PORT; or it holds a connection to PORT of another host, which Zenoh
# ends a second after either side fell silent. Reads the kernel's table, so that no interpreter starts each time.
# A program that has failed counts as healthy: the containers that wait for it start then, see why, and end.
[ ! -e /tmp/failed ] || exit 0
what=$1
shift
for port in "$@"; do
    awk -v what="$what" -v port="$(printf '%04X' "$port")" '
        { split($2, here, ":"); split($3, there, ":") }
        what == "listening" && $4 == "0A" && here[2] == port { found = 1 }
        what == "connected" && $4 == "01" && there[2] == port { found = 1 }
        END { exit !found }
    ' /proc/net/tcp /proc/net/tcp6 || { echo "not $what: $port"; exit 1; }
done
