#!/bin/sh
# Proves one Python newer than 3.11: the pinned dependencies, a demo, and the tests in virtual time, in an environment of
# its own. Only where a wheel of pybullet for it is kept (make-environment.sh builds one); else says that it is skipped.
set -eu
cd "$(dirname "$0")/.."
kept="${XDG_CACHE_HOME:-$HOME/.cache}/farhand/wheels"
pinned=$(sed -n 's/^pybullet==\([0-9.]*\).*/\1/p' requirements.lock)
python=""
for minor in 13 12 14; do
    ls "$kept"/pybullet-"$pinned"-cp3$minor-*.whl >/dev/null 2>&1 || continue
    for candidate in "python3.$minor" "$HOME"/.pyenv/versions/3.$minor.*/bin/python; do
        if "$candidate" -c "import sys, venv, ensurepip; sys.exit(sys.version_info[:2] != (3, $minor))" >/dev/null 2>&1; then
            python=$candidate
            break 2
        fi
    done
done
if [ -z "$python" ]; then
    echo "farhand: no Python newer than 3.11 is proved here: there is none with a kept wheel of pybullet in $kept"
    exit 0
fi
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
trap 'exit 130' INT TERM HUP
echo "farhand: proving $("$python" --version)"
"$python" -m venv "$place/venv"
# Farhand is installed too: its pytest plugin, and the version in every result, are those of an installed package.
"$place/venv/bin/python" -m pip install -qq --disable-pip-version-check --find-links "$kept" --constraint requirements.lock \
    --editable ".[dev,dask,parquet,gamepad,spacemouse]"
"$place/venv/bin/python" -m farhand demo --scenario point-obstacle --out "$place/demo"
"$place/venv/bin/python" -m pytest -q -m "not realtime and not hosts and not slow and not long" --ignore tests/docker -p no:cacheprovider
