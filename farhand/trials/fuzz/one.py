"""One target in a process under atheris: `python -m farhand.trials.fuzz.one NAME [libFuzzer's options] CORPUS`."""

import sys
from pathlib import Path

from farhand.common.process.signals import die_with_parent

LONG = 1500
"""Bytes: of longer maps the decoding and encoding would take most of the time."""
KERNELS = Path(__file__).resolve().parents[2] / "robot_side" / "kernel"
COMPILED = (
    *(f"farhand.robot_side.kernel.{path.stem}" for path in KERNELS.glob("*.py")),
    "farhand.operator_side.control.newton_kernel",
    "farhand.operator_side.control.checks.body_kernel",
    "farhand.common.compiled",
)
"""Translated by Numba, which takes no instrumented code."""
LIBRARIES = ("tomllib", "mcap", "rosbags", "xml")
"""Of the edges that are made of Python; they are instrumented as well."""


def main() -> None:
    """Fuzz until libFuzzer's options say that it is over, or there is a finding, which ends it with another code."""
    import atheris

    die_with_parent()
    name, *options, corpus = sys.argv[1:]
    with atheris.instrument_imports(include=["farhand", *LIBRARIES], exclude=list(COMPILED)):
        from farhand.trials.fuzz.registry import target_called

        target = target_called(name)
    import numpy as np

    from farhand.trials.fuzz.mutation import by_shape

    said = [int(option.removeprefix("-seed=")) for option in options if option.startswith("-seed=")]
    take, rng = target.start(), np.random.default_rng(said)

    def change(data: bytes, longest: int, seed: int) -> bytes:
        if seed % 3 and len(data) < LONG:
            found = by_shape(target, data[target.head :], rng)
            if found is not None:
                return bytes((data[: target.head] + found)[:longest])
        return bytes(atheris.Mutate(data, longest))

    for index, seed in enumerate(target.seeds()):
        (Path(corpus) / f"seed-{index}").write_bytes(seed)
    options = [name, f"-max_len={target.longest}", *options, corpus]
    atheris.Setup(options, take, custom_mutator=change if target.shape in ("map", "json") else None)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
