"""A robot's drawing for pages: its URDF with the light meshes that are used against collisions, and nothing else."""

import xml.etree.ElementTree as ElementTree
from pathlib import Path

from farhand.common.errors import InputError

EXAMPLES = "package://example-robot-data/robots/"


class RobotModel:
    """Args:
    folder: where the meshes are.
    urdf: file in it, or one by its absolute path.
    begins: how the names of meshes begin; it stands for the folder.

    Raises:
        InputError: it cannot be read.

    Attributes:
        urdf: what pages get; its meshes lie beside it.
        meshes: files by what it calls them.
    """

    def __init__(self, folder: Path, urdf: str | Path, begins: str = EXAMPLES) -> None:
        try:
            root = ElementTree.parse(folder / urdf).getroot()
        except (OSError, ElementTree.ParseError) as error:
            raise InputError(f"{folder / urdf}: cannot be read as URDF: {error}") from None
        self._begins = begins
        self.meshes: dict[str, Path] = {}
        for link in root.iter("link"):
            for visual in link.findall("visual"):
                link.remove(visual)
            for collision in link.findall("collision"):
                collision.tag = "visual"
                for mesh in collision.iter("mesh"):
                    mesh.set("filename", self._mesh(folder, mesh.get("filename", "")))
        for other in ("transmission", "gazebo"):
            for each in root.findall(other):
                root.remove(each)
        self.urdf = ElementTree.tostring(root)

    def _mesh(self, folder: Path, uri: str) -> str:
        path = (folder / uri.partition(self._begins)[2]).resolve()
        known = path.is_relative_to(folder.resolve()) and path.suffix.lower() in (".stl", ".obj")
        if not known or not path.is_file():
            raise InputError(f"{uri}: no mesh (STL, OBJ) of the robots' descriptions in {folder}")
        name = f"{len(self.meshes)}-{path.stem}.stl"  # as pages get it
        self.meshes[name] = path
        return name
