"""A SpaceMouse by HID; in one thread, which sends nothing."""

from typing import Any

from farhand.common.errors import InputError
from farhand.operator_side.devices.cap_report import at_rest, take_report
from farhand.operator_side.devices.reading import Reading

LACKING = "needs hidapi; install it with `pip install 'farhand[spacemouse]'`"
NO_RIGHT = "is plugged in, and may not be opened: see to the rights of its file (a udev rule, docs/seat.md)"
LOOKS_EVERY_NS = 500_000_000
REPORT_BYTES = 64
MOST_REPORTS = 64
_3DCONNEXION, _LOGITECH = 0x256F, 0x046D
_OF_LOGITECH = range(0xC603, 0xC630)
_MULTI_AXIS = (1, 8)  # usage page and usage: a multi-axis controller


class SpacemouseSource:
    """Reads the first SpaceMouse whose name has `name` in it; raises InputError where hidapi is not there.

    Args:
        name: part of the device's name; empty: any.
        hid: the library, in place of hidapi.
    """

    def __init__(self, name: str = "", hid: Any = None) -> None:
        self._hid = _library() if hid is None else hid
        self._wanted, self._name = name.lower(), ""
        self._device: Any = None
        self._inputs = at_rest()
        self._plugged = 0
        self._looked_ns: int | None = None
        self.trouble = ""

    def read(self, now_ns: int) -> Reading | None:
        """See Source."""
        if self._device is None and not self._look(now_ns):
            return None
        try:
            for _ in range(MOST_REPORTS):
                report = bytes(self._device.read(REPORT_BYTES))
                if not report:
                    break
                take_report(report, self._inputs)
        except (OSError, ValueError):
            self.close()
            return None
        return Reading(self._name, self._plugged, dict(self._inputs), now_ns)

    def rumble(self, strength: float) -> None:
        """It cannot."""

    def found(self) -> list[dict[str, object]]:
        """See Source."""
        return [
            {
                "name": _name(each),
                "kind": "spacemouse",
                "mapping": "HID",
                "axes": 6,
                "buttons": None,
                "hats": 0,
            }
            for each in self._there()
        ]

    def close(self) -> None:
        """See Source."""
        if self._device is not None:
            self._device.close()
            self._device = None

    def _look(self, now_ns: int) -> bool:
        """Open one, if it is there; looks twice a second."""
        if self._looked_ns is not None and now_ns - self._looked_ns < LOOKS_EVERY_NS:
            return False
        self._looked_ns, self.trouble = now_ns, ""
        for each in self._there():
            if self._wanted not in _name(each).lower():
                continue
            device = self._hid.device()
            try:
                device.open_path(each["path"])
                device.set_nonblocking(True)
            except (OSError, ValueError):
                self.trouble = f"{_name(each)} {NO_RIGHT}"
                continue
            self._device, self._name, self._inputs, self.trouble = device, _name(each), at_rest(), ""
            self._plugged += 1
            return True
        return False

    def _there(self) -> list[dict[str, Any]]:
        """Those that are plugged in, each once: of several interfaces, the one with the axes."""
        found = [each for each in self._hid.enumerate() if _is_spacemouse(each)]
        axes = [each for each in found if (each.get("usage_page"), each.get("usage")) == _MULTI_AXIS]
        return axes or found


def _is_spacemouse(each: dict[str, Any]) -> bool:
    vendor, product = each["vendor_id"], each["product_id"]
    return vendor == _3DCONNEXION or (vendor == _LOGITECH and product in _OF_LOGITECH)


def _name(each: dict[str, Any]) -> str:
    return (each.get("product_string") or "SpaceMouse")[:64]


def _library() -> Any:
    try:
        import hidraw
    except ImportError:
        try:
            import hid as hidraw
        except ImportError:
            raise InputError(f"--steer spacemouse: {LACKING}") from None
    return hidraw
