"""Columns of numbers that grow by a row at a time and cost eight bytes a number."""

from array import array

import numpy as np

from farhand.common.geometry import Array

UNKNOWN = float("nan")


class Columns:
    """Args:
    names: of the columns; a row has a number, or None, for each.
    """

    def __init__(self, *names: str) -> None:
        self._columns = {name: array("d") for name in names}
        self._appends = tuple(column.append for column in self._columns.values())
        self.rows = 0

    def add(self, *row: float | None) -> None:
        """Take a row, in the order of the names."""
        for append, value in zip(self._appends, row, strict=True):
            append(UNKNOWN if value is None else value)
        self.rows += 1

    def shift(self, name: str, by: float) -> None:
        """Add a number to all of a column."""
        shifted = self[name] + by
        self._columns[name][:] = array("d", shifted.tobytes())

    def __getitem__(self, name: str) -> Array:
        """(rows,) a column; unknown values are NaN."""
        return np.frombuffer(self._columns[name], dtype=float)


class NamedParts:
    """Columns whose names come with the rows; what a row does not name is zero in it."""

    def __init__(self) -> None:
        self._columns: dict[str, array[float]] = {}
        self._rows = 0

    def add(self, row: dict[str, float]) -> None:
        """Take a row."""
        for name in row:
            if name not in self._columns:
                self._columns[name] = array("d", bytes(8 * self._rows))
        for name, column in self._columns.items():
            column.append(row.get(name, 0.0))
        self._rows += 1

    def arrays(self) -> dict[str, Array]:
        """(rows,) each, by name in order of appearance."""
        return {name: np.frombuffer(column, dtype=float) for name, column in self._columns.items()}
