"""Tables as CSV or Parquet, row by row, so that a long run needs no more memory than a short one."""

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol, TextIO

from farhand.exports.tables import Column, Row

ROWS = 20_000
"""In a row group of Parquet."""


class TableFile(Protocol):
    """One table."""

    def add(self, row: Row) -> None:
        """Write a row; what it does not name is missing."""
        ...

    def close(self) -> None:
        """Finish the file."""
        ...


class CsvFile:
    """Args:
    path: its file.
    columns: of the table.
    """

    def __init__(self, path: Path, columns: tuple[Column, ...]) -> None:
        self._file: TextIO = path.open("w", newline="", encoding="utf-8")
        self._names = [column.name for column in columns]
        self._bools = {column.name for column in columns if column.kind == "bool"}
        self._writer = csv.writer(self._file)
        self._writer.writerow(self._names)

    def add(self, row: Row) -> None:
        """See TableFile."""
        self._writer.writerow([self._text(row.get(name)) for name in self._names])

    def close(self) -> None:
        """See TableFile."""
        self._file.close()

    @staticmethod
    def _text(value: Any) -> Any:
        return str(value).lower() if isinstance(value, bool) else value


class ParquetFile:
    """Args: see CsvFile."""

    def __init__(self, path: Path, columns: tuple[Column, ...]) -> None:
        import pyarrow as pa
        import pyarrow.parquet as pq

        kinds = {"int": pa.int64(), "float": pa.float64(), "bool": pa.bool_(), "text": pa.string()}
        self._schema = pa.schema(
            [
                pa.field(each.name, kinds[each.kind], metadata={"unit": each.unit, "meaning": each.meaning})
                for each in columns
            ]
        )
        self._names = [column.name for column in columns]
        self._table = pa.Table
        self._writer = pq.ParquetWriter(path, self._schema, compression="zstd")
        self._rows: list[Row] = []

    def add(self, row: Row) -> None:
        """See TableFile."""
        self._rows.append(row)
        if len(self._rows) >= ROWS:
            self._flush()

    def close(self) -> None:
        """See TableFile."""
        self._flush()
        self._writer.close()

    def _flush(self) -> None:
        if self._rows:
            self._writer.write_table(self._table.from_pylist(self._rows, schema=self._schema))
        self._rows = []


FORMS: Mapping[str, type[CsvFile] | type[ParquetFile]] = {"csv": CsvFile, "parquet": ParquetFile}


def describe(folder: Path, tables: Mapping[str, tuple[Column, ...]]) -> None:
    """Write what every column of every table is: columns.csv."""
    with (folder / "columns.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["table", "column", "type", "unit", "meaning"])
        for name, columns in tables.items():
            writer.writerows([name, each.name, each.kind, each.unit, each.meaning] for each in columns)
