"""Named networks: a profile's name alone, or `model:FILE` for a model fitted by `farhand trace fit`."""

from functools import lru_cache
from typing import ClassVar

from farhand.netem.impairments.base import Context
from farhand.netem.impairments.delay import DelayWord, Sampler
from farhand.netem.models.profiles import PROFILES, Profile, load_model
from farhand.netem.words.reader import Reader, path_text


def profile_names() -> tuple[str, ...]:
    """Names of the built-in profiles."""
    return tuple(PROFILES)


class ProfileWord(DelayWord, frozen=True):
    """A built-in profile.

    Attributes:
        name: in farhand.netem.models.profiles.PROFILES.
    """

    name: str

    def text(self) -> str:
        """Canonical word."""
        return self.name

    def sampler(self, context: Context) -> Sampler:
        """The profile's model."""
        return _sampler(PROFILES[self.name], context)


class ModelWord(DelayWord, frozen=True):
    """A fitted model.

    Attributes:
        path: the file that `farhand trace fit --out` wrote.
    """

    path: str
    word: ClassVar[str] = "model"

    @classmethod
    def parse(cls, reader: Reader) -> "ModelWord":
        """`:FILE`."""
        reader.example = "model:fitted.toml"
        reader.expect(":", "the file of a fitted model")
        return cls(reader.path("the file of a fitted model"))

    def text(self) -> str:
        """Canonical word."""
        return f"model:{path_text(self.path)}"

    def prepare(self) -> None:
        """Read the file; raises InputError."""
        _load(self.path)

    def sampler(self, context: Context) -> Sampler:
        """The fitted model."""
        return _sampler(_load(self.path), context)


@lru_cache(maxsize=8)
def _load(path: str) -> Profile:
    return load_model(path)


def _sampler(profile: Profile, context: Context) -> Sampler:
    """Jitter and losses of its own for each key; stalls and outages come to all keys at once."""
    return profile.sampler(
        context.rng("delay"),
        context.direction,
        schedule=context.shared_rng("episodes"),
        origin_ns=context.origin_ns,
    )
