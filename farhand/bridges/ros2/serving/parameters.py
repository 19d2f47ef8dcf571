"""The node's parameters, as `ros2 param` asks for them: all of them read-only, what the command line said."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from farhand.bridges.ros2.cdr.types import Types
from farhand.bridges.ros2.graph.node import RosNode, ServiceCall

NOT_SET, BOOL, INTEGER, DOUBLE, STRING = range(5)
"""Types of rcl_interfaces/msg/ParameterType."""
Value = bool | int | float | str
READ_ONLY = "is read-only: say it on the command line of `farhand ros2`"


class Parameters:
    """Args:
    types: of the distribution.
    values: by name; what stands behind each is its description.
    """

    def __init__(self, types: Types, values: Mapping[str, tuple[Value, str]]) -> None:
        self._types, self._values = types, values

    def serve(self, node: RosNode, refused: Any) -> None:
        """Answer for a node; `refused` is called with why a request was none."""
        for name, take in (
            ("list_parameters", self._list),
            ("get_parameters", self._get),
            ("get_parameter_types", self._kinds),
            ("describe_parameters", self._describe),
            ("set_parameters", self._set),
            ("set_parameters_atomically", self._set_all),
        ):
            service = "".join(word.capitalize() for word in name.split("_"))
            node.serve(f"~/{name}", f"rcl_interfaces/srv/{service}", take, refused)

    def _list(self, call: ServiceCall) -> None:
        prefixes = list(call.request.prefixes)
        names = [
            n for n in self._values if not prefixes or any(n == p or n.startswith(f"{p}.") for p in prefixes)
        ]
        found = sorted({n.rpartition(".")[0] for n in names} - {""})
        make = self._types.make
        call.answer(result=make("rcl_interfaces/msg/ListParametersResult", names=names, prefixes=found))

    def _get(self, call: ServiceCall) -> None:
        call.answer(values=[self._value(name) for name in call.request.names])

    def _kinds(self, call: ServiceCall) -> None:
        call.answer(types=np.array([self._kind(name) for name in call.request.names], dtype=np.uint8))

    def _describe(self, call: ServiceCall) -> None:
        found = [
            self._types.make(
                "rcl_interfaces/msg/ParameterDescriptor",
                name=name,
                type=self._kind(name),
                description=self._values[name][1] if name in self._values else "",
                additional_constraints="",
                read_only=True,
                dynamic_typing=False,
                floating_point_range=[],
                integer_range=[],
            )
            for name in call.request.names
        ]
        call.answer(descriptors=found)

    def _set(self, call: ServiceCall) -> None:
        call.answer(results=[self._no(each.name) for each in call.request.parameters])

    def _set_all(self, call: ServiceCall) -> None:
        names = ", ".join(each.name for each in call.request.parameters)
        call.answer(result=self._no(names))

    def _no(self, name: str) -> Any:
        reason = f"{name} {READ_ONLY}"
        return self._types.make("rcl_interfaces/msg/SetParametersResult", successful=False, reason=reason)

    def _kind(self, name: str) -> int:
        if name not in self._values:
            return NOT_SET
        value = self._values[name][0]
        kinds = {bool: BOOL, int: INTEGER, float: DOUBLE, str: STRING}
        return kinds[type(value)]

    def _value(self, name: str) -> Any:
        kind, value = self._kind(name), self._values.get(name, ("", ""))[0]
        return self._types.make(
            "rcl_interfaces/msg/ParameterValue",
            type=kind,
            bool_value=value if kind == BOOL else False,
            integer_value=value if kind == INTEGER else 0,
            double_value=value if kind == DOUBLE else 0.0,
            string_value=value if kind == STRING else "",
            byte_array_value=np.zeros(0, dtype=np.uint8),
            bool_array_value=np.zeros(0, dtype=np.bool_),
            integer_array_value=np.zeros(0, dtype=np.int64),
            double_array_value=np.zeros(0),
            string_array_value=[],
        )
