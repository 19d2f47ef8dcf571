#!/bin/sh
# Makes .venv with the pinned dependencies. PYTHON names another interpreter; `make-environment.sh tests` adds what
# tests, checks, Dask, Parquet and a SpaceMouse need.
#
# pybullet has wheels for Python 3.10 and 3.11 only. For a newer one it is built from its source, once; the wheel is
# kept in $XDG_CACHE_HOME/farhand/wheels (~/.cache/farhand/wheels).
set -eu
cd "$(dirname "$0")/.."
kept="${XDG_CACHE_HOME:-$HOME/.cache}/farhand/wheels"

fail() { echo "farhand: $1" >&2; exit 2; }

suits() { "$1" -c 'import sys; sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, 14))' >/dev/null 2>&1; }

version() { "$1" -c 'import sys; print("%d.%d" % sys.version_info[:2])'; }

advice="install one (Debian: apt install python3.11 python3.11-venv; elsewhere: uv python install 3.11, or pyenv install 3.11) and say make PYTHON=python3.11"
python=""
if [ -n "${PYTHON:-}" ]; then
    suits "$PYTHON" || fail "$PYTHON is not Python 3.10 to 3.14; $advice"
    python=$PYTHON
else
    for candidate in python3.11 python3.10 python3 python python3.13 python3.12 python3.14; do
        if suits "$candidate"; then python=$candidate; break; fi
    done
    [ -n "$python" ] || fail "no Python 3.10 to 3.14 found; $advice"
fi

"$python" -c 'import venv, ensurepip' >/dev/null 2>&1 \
    || fail "$python has no venv module; on Debian: apt install python$(version "$python")-venv"

stays() {
    [ -x .venv/bin/python ] && suits .venv/bin/python && .venv/bin/python -m pip --version >/dev/null 2>&1 || return 1
    [ -z "${PYTHON:-}" ] || [ "$(version .venv/bin/python)" = "$(version "$python")" ]
}

pinned=$(sed -n 's/^\(pybullet==[0-9.]*\).*/\1/p' requirements.lock)

# A kept wheel of another version is none: pip would not take it, and build anew, without a word and for itself alone.
needs_build() {
    case $(version "$1") in 3.10 | 3.11) return 1 ;; esac
    tag=cp$(version "$1" | tr -d .)
    ! ls "$kept"/pybullet-"${pinned#*==}"-"$tag"-*.whl >/dev/null 2>&1
}

# Before anything is installed or taken away, what may be wanting to build pybullet.
future=$python
! stays || future=.venv/bin/python
if needs_build "$future"; then
    echo "farhand: pybullet has no wheel for Python $(version "$future"): it is built from its source, once, in 5 to 10 minutes"
    echo "farhand: (longer on a busy machine; nothing is printed meanwhile), and kept in $kept; with Python 3.11 (make PYTHON=python3.11) nothing has to be built"
    needed="on Debian and Ubuntu: apt install g++ python$(version "$future")-dev"
    command -v c++ >/dev/null 2>&1 || command -v g++ >/dev/null 2>&1 || fail "building pybullet needs a C++ compiler; $needed"
    "$future" -c 'import os, sys, sysconfig; sys.exit(not os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")))' \
        || fail "building pybullet needs the headers of Python $(version "$future"); $needed"
fi

stays || { rm -rf .venv; "$python" -m venv .venv; }

pip() { .venv/bin/python -m pip "$@" -qq --disable-pip-version-check; }

if needs_build .venv/bin/python; then
    mkdir -p "$kept"
    pip wheel --no-deps --wheel-dir "$kept" "$pinned" || fail "pybullet could not be built; $advice"
fi

extras="[gamepad]"
[ "${1:-}" != tests ] || extras="[dev,dask,parquet,gamepad,spacemouse]"
what="1.3 GB"
[ "${1:-}" != tests ] || what="1.9 GB, with what tests and checks need"
echo "farhand: installing the pinned dependencies into .venv ($what; one to four minutes the first time)"
pip install --find-links "$kept" --constraint requirements.lock --editable ".$extras"
# Environments that were made before had only the UR5's description left.
if ! ls -d .venv/lib/python3*/site-packages/cmeel.prefix/share/example-robot-data/robots/panda_description/meshes/collision >/dev/null 2>&1; then
    pip install --no-deps --force-reinstall "$(sed -n 's/^\(example-robot-data==[0-9.]*\).*/\1/p' requirements.lock)"
fi
.venv/bin/python scripts/slim_environment.py .venv
.venv/bin/python -m farhand.laboratory.warm | sed -u "s/^/farhand: /"
touch .venv/.ready
[ "${1:-}" != tests ] || touch .venv/.ready-tests
echo "farhand: ready, .venv/bin/farhand"
