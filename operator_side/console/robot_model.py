"""A robot's drawing for pages: its URDF with the light meshes that are used against collisions, and nothing else."""

import xml.etree.ElementTree as ElementTree
from pathlib import Path

from farhand.common.errors import InputError


class RobotModel:
    """Args:
    folder: of robot descriptions, which `package://example-robot-data/robots/` stands for.
    urdf: file in it.

    Raises:
        InputError: it cannot be read.

    Attributes:
        urdf: what pages get; its meshes lie beside it.
        meshes: files by what it calls them.
    """

    def __init__(self, folder: Path, urdf: str) -> None:
        try:
            root = ElementTree.parse(folder / urdf).getroot()
        except (OSError, ElementTree.ParseError) as error:
            raise InputError(f"{folder / urdf}: cannot be read as URDF: {error}") from None
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
        path = (folder / uri.partition("/robots/")[2]).resolve()
        if not path.is_relative_to(folder.resolve()) or path.suffix.lower() != ".stl" or not path.is_file():
            raise InputError(f"{uri}: no mesh (STL) of the robots' descriptions in {folder}")
        name = f"{len(self.meshes)}-{path.name}"
        self.meshes[name] = path
        return name
