"""The kinds of numbers and names that settings and messages are made of, with their bounds. SI units."""

from typing import Annotated

from msgspec import Meta

# Magnitudes beyond this are refused as nonsense: no position in m or velocity in m/s comes near it.
Real = Annotated[float, Meta(ge=-1e6, le=1e6)]
Positive = Annotated[float, Meta(gt=0, le=1e6)]
NonNegative = Annotated[float, Meta(ge=0, le=1e6)]
Vector3 = tuple[Real, Real, Real]
Quaternion = tuple[Real, Real, Real, Real]
ZERO: Vector3 = (0.0, 0.0, 0.0)
# Names are shown on terminals: no control characters, and nothing that turns the direction of writing.
PRINTABLE = r"\A[^\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]*\Z"
Name = Annotated[str, Meta(min_length=1, max_length=64, pattern=PRINTABLE)]
