"""The decorator of this folder's functions."""

from pathlib import Path

from farhand.common.compiled import Compiler

compiled = Compiler(Path(__file__).parent)
