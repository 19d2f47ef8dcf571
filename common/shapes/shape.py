"""Any shape: told apart by the key `kind`."""

from typing import TypeAlias

from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.sphere import Sphere

Shape: TypeAlias = Sphere | Capsule | Box | Plane | Mesh
