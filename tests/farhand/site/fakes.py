"""What stands in place of an operator's loop and of Zenoh, where a desk answers requests."""

import msgspec


class Asked:
    """A request and its answer."""

    payload = b"{}"
    answer = None

    def reply(self, answer):
        self.answer = msgspec.json.decode(answer)


class Direct:
    """A slot that is served at once."""

    def do(self, change):
        return change(0)


class Silent:
    """A session on which nobody asks."""

    def declare_queryable(self, key, take):
        return None
