"""`python -m farhand.trials.kernel.user_mode_linux FOLDER COMMAND...`: a command in a kernel that has tc-netem.

User-mode Linux is a kernel that runs as an ordinary process (Debian: `apt install user-mode-linux`). It sees
the files of this host, read-only but for FOLDER and a /run of its own, and no network but what is made in
it; the command is root there and nothing outside. One processor, and system calls that are slow.
"""

import argparse
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

GRACE = 5.0
"""How much longer the kernel may last than this process lets it (s): its own end, should this one die."""

MODULES = ("drivers/net/veth.ko", "net/sched/sch_netem.ko")
_LIBRARY = Path("/usr/lib/uml/modules")

# The kernel's helper processes would outlive it; those of a process namespace end with its first.
_ALONE = ["setpriv", "--pdeathsig", "KILL", "unshare", "--pid", "--mount-proc", "--fork", "--kill-child"]
_ALONE += ["sh", "-c", '"$@"; exit', "sh"]  # that first one must not be the kernel itself

_FIRST_PROCESS = """\
#!/bin/sh
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t tmpfs tmpfs /run
mkdir -p /dev/shm && mount -t tmpfs tmpfs /dev/shm
mount -t hostfs -o {folder} none {folder}
mkdir -p /run/tmp
export TMPDIR=/run/tmp HOME=/run/tmp NUMBA_CACHE_DIR={folder}/compiled PYTHONDONTWRITEBYTECODE=1
ip link set lo up
( sleep {timeout:.0f}; echo o >/proc/sysrq-trigger ) &
for module in {modules}; do insmod "$module"; done
cd {place}
( {command} ) >{job}/stdout 2>{job}/stderr </dev/null
echo $? >{job}/code
echo o >/proc/sysrq-trigger
"""


def why_not() -> str:
    """Why this kernel cannot be started here, or an empty string."""
    if os.geteuid() != 0:
        return "needs root"
    if shutil.which("linux.uml") is None or not _modules():
        return "user-mode Linux with its modules is not installed (apt install user-mode-linux)"
    return ""


def run_inside(
    command: list[str], folder: Path, timeout: float, memory: str = "1500M"
) -> tuple[int, str, str]:
    """Run a command in that kernel, in the folder where this process is.

    Args:
        command: what to run.
        folder: what it may write to.
        timeout: after how long the kernel is ended, and the exit code is 124 (s).
        memory: that the kernel has.

    Returns:
        Exit code, stdout and stderr of the command; code 125 where the kernel did not come up.
    """
    folder = folder.resolve()
    with tempfile.TemporaryDirectory(prefix=".uml-", dir=folder) as job:
        first = Path(job) / "init"
        first.write_text(
            _FIRST_PROCESS.format(
                folder=shlex.quote(str(folder)),
                modules=" ".join(map(shlex.quote, _modules())),
                place=shlex.quote(str(Path.cwd())),
                command=shlex.join(command),
                job=shlex.quote(job),
                timeout=timeout + GRACE,
            )
        )
        first.chmod(0o755)
        root = ["root=/dev/root", "rootfstype=hostfs", "rootflags=/", "ro", f"init={first}"]
        consoles = ["con=null", "con0=null,fd:1", "quiet"]
        whole = [*_ALONE, "linux.uml", f"mem={memory}", *root, *consoles, f"uml_dir={job}/"]
        kernel = subprocess.Popen(
            whole,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        try:
            said, _ = kernel.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            os.killpg(kernel.pid, 9)
            kernel.communicate()
            return 124, _read(f"{job}/stdout"), f"{_read(f'{job}/stderr')}\nended after {timeout:g} s"
        code = _read(f"{job}/code").strip()
        if not code:
            return 125, "", said
        return int(code), _read(f"{job}/stdout"), _read(f"{job}/stderr")


def _modules() -> list[str]:
    """Paths of the modules, all of one kernel; none where one is missing."""
    for kernel in sorted(_LIBRARY.glob("*/kernel"), reverse=True):
        found = [str(kernel / name) for name in MODULES]
        if all(Path(name).is_file() for name in found):
            return found
    return []


def _read(path: str) -> str:
    try:
        return Path(path).read_text(errors="replace")
    except OSError:
        return ""


def main() -> int:
    """Run the command, print what it printed, end as it ended."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--timeout", type=float, default=600.0, help="end it after so long, s")
    parser.add_argument("folder", type=Path, help="what the command may write to")
    parser.add_argument("command", nargs=argparse.REMAINDER)
    options = parser.parse_args()
    problem = why_not()
    if not problem and not options.folder.is_dir():
        problem = f"{options.folder}: there is no such folder"
    if problem:
        print(f"user-mode Linux: {problem}", file=sys.stderr)
        return 2
    code, out, errors = run_inside(options.command, options.folder, options.timeout)
    sys.stdout.write(out)
    sys.stderr.write(errors)
    return code


if __name__ == "__main__":
    sys.exit(main())
