#!/bin/sh
# Makes .venv with the pinned dependencies. PYTHON names another interpreter.
set -eu
cd "$(dirname "$0")/.."

fail() { echo "farhand: $1" >&2; exit 2; }

suits() { "$1" -c 'import sys; sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, 11))' >/dev/null 2>&1; }

advice="install one (Debian: apt install python3.11 python3.11-venv; elsewhere: uv python install 3.11, or pyenv install 3.11) and say make PYTHON=python3.11"
python=""
if [ -n "${PYTHON:-}" ]; then
    suits "$PYTHON" || fail "$PYTHON is not Python 3.10 or 3.11 (pybullet has wheels for these only); $advice"
    python=$PYTHON
else
    for candidate in python3.11 python3.10 python3 python; do
        if suits "$candidate"; then python=$candidate; break; fi
    done
    [ -n "$python" ] || fail "no Python 3.10 or 3.11 found (pybullet has wheels for these only); $advice"
fi

"$python" -c 'import venv, ensurepip' >/dev/null 2>&1 \
    || fail "$python has no venv module; on Debian: apt install $("$python" -c 'import sys; print("python%d.%d-venv" % sys.version_info[:2])')"

if [ -x .venv/bin/python ] && ! suits .venv/bin/python; then rm -rf .venv; fi
[ -x .venv/bin/python ] || { rm -rf .venv; "$python" -m venv .venv; }
echo "farhand: installing the pinned dependencies into .venv (one to three minutes the first time)"
.venv/bin/python -m pip install -qq --disable-pip-version-check -r requirements.lock
.venv/bin/python -m pip install -qq --disable-pip-version-check --no-deps -e .
.venv/bin/python -m farhand.operator_side.control.warm | sed "s/^/farhand: /"
touch .venv/.ready
echo "farhand: ready, .venv/bin/farhand"
