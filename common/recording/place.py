"""Where a run's recording is."""

from pathlib import Path

from farhand.common.errors import RunFileError

RECORDING = "run.mcap"


def recording_at(run: Path, *, called: str = "") -> Path:
    """The recording of a run, by its folder or its file; raises RunFileError where there is none.

    Args:
        run: the folder or the file.
        called: how errors begin; empty: `run RUN`.
    """
    called = called or f"run {run}"
    wanted = f"expected a run's folder or its {RECORDING}"
    try:
        found = run / RECORDING if run.is_dir() else run
        if found.is_file():
            return found
        if found is not run:
            raise RunFileError(f"{called}: holds no {RECORDING}; {wanted}")
        why = "is neither file nor folder" if run.exists() else "no such file"
    except OSError as error:
        raise RunFileError(f"{called}: cannot be read: {error.strerror or error}") from None
    raise RunFileError(f"{called}: {why}; {wanted}")
