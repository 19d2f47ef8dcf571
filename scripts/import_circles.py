"""Says which files or folders import each other in a circle; exit code 1 if any do.

A folder's own files count as the folder, so that a room and a room inside it are two: `netem -> netem.impairments`
alone is fine, both ways are a circle.
"""

import sys
from collections import defaultdict
from collections.abc import Iterable, Mapping

import grimp


def circles(arrows: Mapping[str, Iterable[str]]) -> list[list[str]]:
    """The strongly connected sets of more than one name (Tarjan), each in alphabetical order."""
    order: dict[str, int] = {}
    lowest: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(name: str) -> None:
        order[name] = lowest[name] = len(order)
        stack.append(name)
        for other in arrows.get(name, ()):
            if other not in order:
                visit(other)
                lowest[name] = min(lowest[name], lowest[other])
            elif other in stack:
                lowest[name] = min(lowest[name], order[other])
        if lowest[name] == order[name]:
            cut = stack.index(name)
            if len(stack) - cut > 1:
                found.append(sorted(stack[cut:]))
            del stack[cut:]

    for name in list(arrows):
        if name not in order:
            visit(name)
    return found


def main() -> int:
    """Look at farhand as it lies here."""
    graph = grimp.build_graph("farhand", exclude_type_checking_imports=True, cache_dir=None)
    files = {name: graph.find_modules_directly_imported_by(name) for name in graph.modules}
    packages = {name.rpartition(".")[0] for name in files}
    folders: defaultdict[str, set[str]] = defaultdict(set)
    for name, imported in files.items():
        own = name if name in packages else name.rpartition(".")[0]
        for other in imported:
            its = other if other in packages else other.rpartition(".")[0]
            if its != own:
                folders[own].add(its)
    found = circles(files) + circles(folders)
    for circle in found:
        print("a circle of imports:", ", ".join(circle))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
