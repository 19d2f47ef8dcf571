#!/bin/sh
# The image's entry: `docker run farhand ARGUMENTS` is `farhand ARGUMENTS`; `part ROLE` is a part of the demo,
# `keys` makes its certificates.
set -eu
# The compiled solver lies in the image, read-only, but numba wants a folder that it can write.
if [ ! -d "$NUMBA_CACHE_DIR" ]; then
    mkdir -p "$NUMBA_CACHE_DIR"
    cp -R -p /opt/app/compiled/. "$NUMBA_CACHE_DIR" 2>/dev/null || true
fi
if [ "${1:-}" = part ]; then
    shift
    exec python /opt/app/docker/part.py "$@"
fi
if [ "${1:-}" = keys ]; then
    exec sh /opt/app/docker/keys.sh
fi
exec python -m farhand "$@"
