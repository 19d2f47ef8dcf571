"""The general purpose registers that programs and clients share."""

INTEGERS, FLOATS, BITS = 48, 48, 128


class Registers:
    """Inputs are written by clients and read by the program, outputs the other way round.

    Attributes:
        inputs, outputs: by RTDE's names, such as `input_int_register_0`.
    """

    def __init__(self) -> None:
        self.inputs: dict[str, int | float | bool] = _zeros("input")
        self.outputs: dict[str, int | float | bool] = _zeros("output")


def _zeros(way: str) -> dict[str, int | float | bool]:
    found: dict[str, int | float | bool] = {f"{way}_int_register_{i}": 0 for i in range(INTEGERS)}
    found.update({f"{way}_double_register_{i}": 0.0 for i in range(FLOATS)})
    found.update({f"{way}_bit_register_{i}": False for i in range(BITS)})
    return found
