"""Who has the wheel, of several programs that could steer: one, until it lets go or falls silent."""

FREE_AFTER_NS = 2_000_000_000
"""A silent driver's wheel is free after this long."""


class Wheel:
    """Attributes:
    driver: session of who has it; 0: nobody.
    name: what its device calls itself; empty: nobody has it.
    """

    def __init__(self) -> None:
        self.driver = 0
        self.name = ""
        self._heard_ns = 0

    def ask(self, session: int, name: str, now_ns: int, *, wants: bool) -> bool:
        """Note that a session was heard; whether it has the wheel now. One that is free it gets if it `wants` it."""
        self.look(now_ns)
        if self.driver == 0 and wants:
            self.driver, self.name = session, name
        if self.driver != session:
            return False
        self._heard_ns = now_ns
        return True

    def look(self, now_ns: int) -> int:
        """Who has it at `now_ns`."""
        if self.driver and now_ns - self._heard_ns > FREE_AFTER_NS:
            self.free()
        return self.driver

    def free(self) -> None:
        """Nobody's, from now on."""
        self.driver, self.name = 0, ""
