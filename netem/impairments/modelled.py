"""Named networks: a profile's name alone, or `model:FILE` for a model fitted by `farhand trace fit`."""

from functools import lru_cache
from typing import ClassVar

from farhand.netem.impairments.base import ImpairmentContext
from farhand.netem.impairments.delay import DelayWord
from farhand.netem.models.profiles import PROFILES, Profile, load_model
from farhand.netem.recordings.playback import DelaySampler
from farhand.netem.words.reader import SpecReader, path_text


class ProfileWord(DelayWord, frozen=True):
    """A built-in profile.

    Attributes:
        profile: its name, which is the word.
    """

    profile: str

    @classmethod
    def parse(cls, reader: SpecReader) -> "ProfileWord":
        """Nothing: the name says all."""
        return cls(reader.word)

    @classmethod
    def describe(cls, name: str) -> tuple[str, str]:
        """The profile's name, and what it says of itself."""
        return name, PROFILES[name].description

    def text(self) -> str:
        """Canonical word."""
        return self.profile

    @property
    def cause(self) -> str:
        """The profile, which loses by its model."""
        return self.profile

    def prepare(self) -> None:
        """Have its samplers' tables ready."""
        PROFILES[self.profile].prepare()

    def sampler(self, context: ImpairmentContext) -> DelaySampler:
        """The profile's model."""
        return _sampler(PROFILES[self.profile], context)


class ModelWord(DelayWord, frozen=True):
    """A fitted model.

    Attributes:
        path: the file that `farhand trace fit --out` wrote.
    """

    path: str
    name: ClassVar[str] = "model"
    example: ClassVar[str] = "model:fitted.toml"
    description: ClassVar[str] = "a model that `farhand trace fit` wrote"

    @classmethod
    def parse(cls, reader: SpecReader) -> "ModelWord":
        """`:FILE`."""
        reader.expect(":", "the file of a fitted model")
        return cls(reader.path("the file of a fitted model"))

    def text(self) -> str:
        """Canonical word."""
        return f"model:{path_text(self.path)}"

    def prepare(self) -> None:
        """Read the file, and have its samplers' tables ready; raises InputError."""
        _load(self.path).prepare()

    def sampler(self, context: ImpairmentContext) -> DelaySampler:
        """The fitted model."""
        return _sampler(_load(self.path), context)


@lru_cache(maxsize=8)
def _load(path: str) -> Profile:
    return load_model(path)


def _sampler(profile: Profile, context: ImpairmentContext) -> DelaySampler:
    """Jitter and losses of its own for each key; stalls and outages come to all keys at once."""
    return profile.sampler(
        context.rng("delay"),
        context.direction,
        schedule=context.shared_rng("episodes"),
        origin_ns=context.origin_ns,
    )
