#!/bin/sh
# docker/systemd/try.sh: boots a container with systemd as its first process, and tries what the units promise.
# Needs the image `farhand` and an engine that may give a container SYS_ADMIN. Two minutes; takes all down again.
set -eu
cd "$(dirname "$0")"
trap 'docker rm --force farhand-systemd >/dev/null 2>&1' EXIT
docker build --quiet --tag farhand-systemd . >/dev/null 2>&1
# As little as systemd needs to make control groups, and namespaces for the units, of its own.
docker run --detach --name farhand-systemd --env container=docker --cap-add SYS_ADMIN --cap-add SYS_NICE \
    --security-opt seccomp=unconfined --security-opt apparmor=unconfined --tmpfs /run --tmpfs /run/lock \
    farhand-systemd >/dev/null
timeout 300 docker exec farhand-systemd python /promises.py first
timeout 60 docker restart farhand-systemd >/dev/null
echo "restarted"
timeout 120 docker exec farhand-systemd python /promises.py boot
