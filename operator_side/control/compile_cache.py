"""Where the solver's compiled code is kept between runs, see common/compiled.py.

NOTICE says in one line where it cannot be kept, and is empty else.
"""

from pathlib import Path

from farhand.common.compiled import Compiler

compiled = Compiler(Path(__file__).with_name("newton_kernel.py"))
NOTICE = compiled.notice
