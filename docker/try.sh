#!/bin/sh
# docker/try.sh [SPEC...]: builds the image, shows that operator and robot cannot meet, then drives the demo over
# each network (default: 5g-urban) and says how long it took; with COMPOSE_PROFILES=tls over TLS. Needs an engine;
# takes what it made down again.
set -eu
cd "$(dirname "$0")/.."
compose="docker compose -f docker/compose.yaml"
trap '$compose down --volumes --timeout 10 >/dev/null 2>&1' EXIT
seconds() { date +%s; }

start=$(seconds)
docker build --quiet --file docker/Dockerfile --target farhand --tag farhand . >/dev/null
echo "image built in $(($(seconds) - start)) s: $(docker image inspect farhand --format '{{.Size}}' | awk '{ printf "%.0f MB", $1 / 1e6 }')"

$compose up --detach --wait --no-build netem robot >/dev/null 2>&1
address() { docker inspect --format "{{(index .NetworkSettings.Networks \"farhand_$2\").IPAddress}}" "farhand-$1-1"; }
robot=$(address robot robot_side)
far_netem=$(address netem robot_side)
# Asked from the operator's network; netem's own port there must answer, or the probe would prove nothing.
$compose run --rm --no-deps --no-TTY --entrypoint python operator - "$robot" "$far_netem" <<'PY'
import socket
import sys

robot, far_netem = sys.argv[1:]


def reached(host, port):
    try:
        socket.create_connection((host, port), 2).close()
    except ConnectionRefusedError:
        return "there, but does not listen"
    except OSError:
        return "out of reach"
    return "listens"


away = "out of reach"
paths = [("netem-operator", 7447, "listens"), ("netem-operator", 7448, "there, but does not listen")]
paths += [("robot", 7448, away), (robot, 7448, away), ("netem-robot", 7448, away), (far_netem, 7448, away)]
for host, port, wanted in paths:
    found = reached(host, port)
    print(f"operator -> {host}:{port}: {found}")
    if found != wanted:
        sys.exit(f"the networks are not apart: expected {wanted!r}")
PY
$compose down --timeout 10 >/dev/null 2>&1

[ $# -gt 0 ] || set -- 5g-urban
worst=0
for network in "$@"; do
    start=$(seconds)
    code=0
    NETWORK=$network timeout 240 $compose up --no-build || code=$?
    echo "$network: exit code $code after $(($(seconds) - start)) s"
    [ "$code" = 0 ] || worst=$code
    $compose down --timeout 10 >/dev/null 2>&1
done
exit "$worst"
