"""Writes the layout that Foxglove imports, as the code makes it: `python scripts/make_foxglove_layout.py`."""

from farhand.common.result_file import write_whole
from farhand.foxglove.layout import SHIPPED, layout_file

if __name__ == "__main__":
    write_whole(SHIPPED, layout_file())
    print(SHIPPED)
