"""The SPEC grammar: what the command line, TOML files and live control say a network is like.

    SPEC   := "none" | ITEM (space ITEM)*
    ITEM   := WORD | CLASS "[" SPEC "]"
    WORD   := a profile's name | NAME [":" parameters]        (impairments/registry.py lists the names)
    CLASS  := command | state | scene | description | camera | other

Delays and times are in ms unless a unit follows (us, ms, s, min); probabilities are 5% or 0.05; rates and
sizes carry their unit (2mbit, 64kB). The order of the words does not matter: the chain's order is that of
`farhand.netem.impairments.base.Stage`. Within the brackets of a class a word takes the place of the direction's
word of the same kind for messages of that class; `none` there lets the class pass unimpaired.
"""

import difflib

import msgspec

from farhand.common.errors import InputError
from farhand.netem.impairments.base import Word
from farhand.netem.impairments.registry import IMPAIRMENTS, word_called
from farhand.netem.words.reader import MAX_TEXT, SpecReader
from farhand.netem.words.tc_words import in_our_words, looks_like_tc

CLASSES = ("command", "state", "scene", "description", "camera", "other")


class Spec(msgspec.Struct, frozen=True):
    """What one direction of a network is like; `str` gives the canonical text.

    Attributes:
        words: for all messages, in the order of the chain.
        classes: (class, its words or None for `none`), in the order of CLASSES.
    """

    words: tuple[Word, ...] = ()
    classes: tuple[tuple[str, tuple[Word, ...] | None], ...] = ()

    def __str__(self) -> str:
        """Canonical text: parses back to an equal Spec."""
        items = [word.text() for word in self.words]
        for name, words in self.classes:
            inner = "none" if words is None else " ".join(word.text() for word in words)
            items.append(f"{name}[{inner}]")
        return " ".join(items) or "none"

    def word(self, kind: str) -> Word | None:
        """The direction's word of a kind."""
        return next((word for word in self.words if word.kind == kind), None)

    def words_for(self, message_class: str) -> tuple[tuple[Word, bool], ...]:
        """The words that messages of a class pass, each with whether it is the class's own."""
        for name, words in self.classes:
            if name == message_class:
                if words is None:
                    return ()
                own = {word.kind for word in words}
                merged = [(word, True) for word in words]
                merged += [(word, False) for word in self.words if word.kind not in own]
                return tuple(sorted(merged, key=lambda pair: _place(pair[0])))
        return tuple((word, False) for word in self.words)

    def prepare(self) -> None:
        """Open every file that the words name; raises InputError."""
        for words in (self.words, *(words or () for _, words in self.classes)):
            for word in words:
                word.prepare()

    def with_words(self, other: "Spec") -> "Spec":
        """This SPEC with the words and classes of another in place of those of the same kind."""
        kinds = {word.kind for word in other.words}
        names = {name for name, _ in other.classes}
        words = [word for word in self.words if word.kind not in kinds] + list(other.words)
        classes = [pair for pair in self.classes if pair[0] not in names] + list(other.classes)
        return _spec(words, classes)

    def without(self, name: str) -> "Spec | None":
        """This SPEC without the words of a kind, or without a class; None if it has none."""
        words = [word for word in self.words if word.kind != name]
        classes = [pair for pair in self.classes if pair[0] != name]
        if len(words) == len(self.words) and len(classes) == len(self.classes):
            return None
        return _spec(words, classes)


NONE = Spec()


def parse_spec(text: str) -> Spec:
    """The Spec that a text says; raises SpecError with one line that points at the character."""
    reader = SpecReader(text)
    if len(text) > MAX_TEXT:
        reader.fail(f"longer than {MAX_TEXT} characters", MAX_TEXT)
    reader.skip_space()
    if reader.at_end():
        reader.example = "none or gaussian:50,20 loss:1%"
        reader.fail("expected a network")
    words: list[Word] = []
    classes: list[tuple[str, tuple[Word, ...] | None]] = []
    is_none = False
    while not reader.at_end():
        start = reader.position
        reader.example = ""
        name = reader.name()
        if is_none or (name == "none" and (words or classes)):
            reader.fail("'none' stands alone", start)
        if name == "none":
            is_none = True
        elif reader.take("["):
            _check_class(name, [known for known, _ in classes], reader, start)
            classes.append((name, _class_words(reader)))
        else:
            _append(_word(name, reader, start), words, reader, start)
        _check_separated(reader, "")
    return _spec(words, classes)


def _class_words(reader: SpecReader) -> tuple[Word, ...] | None:
    words: list[Word] = []
    is_none = False
    reader.skip_space()
    while not reader.take("]"):
        start = reader.position
        reader.example = ""
        name = reader.name()
        if is_none or (name == "none" and words):
            reader.fail("'none' stands alone", start)
        if name == "none":
            is_none = True
        else:
            _append(_word(name, reader, start), words, reader, start)
        _check_separated(reader, "]")
        if reader.at_end():
            reader.fail("expected ']'")
    if not words and not is_none:
        reader.fail("expected the class's words, or none", reader.position - 1)
    return None if is_none else _in_order(words)


def _word(name: str, reader: SpecReader, start: int) -> Word:
    if looks_like_tc(name, reader.rest()):
        ours = in_our_words(reader.text[start:])
        told = f"; in a SPEC: {ours}" if ours else ", which a SPEC writes with colons: uniform:80,120 loss:1%"
        reader.fail(f"these are tc's own words{told}", start)
    if name in IMPAIRMENTS:
        try:
            word = word_called(name)
        except InputError as error:
            reader.fail(str(error), start)
        reader.word, reader.example = name, word.example
        return word.parse(reader)
    if not name:
        reader.fail("expected the name of an impairment or of a profile", start)
    close = difflib.get_close_matches(name, ["none", *IMPAIRMENTS.names()], n=1)
    hint = f"; is {close[0]!r} meant?" if close else ""
    reader.fail(
        f"no impairment and no profile is called {name!r}{hint} (`farhand networks` lists them)"
        f"{IMPAIRMENTS.ill_named()}",
        start,
    )


def _append(word: Word, words: list[Word], reader: SpecReader, start: int) -> None:
    whole = next((each for each in (word, *words) if each.alone), None)
    if whole is not None and words:
        reader.example = ""
        reader.fail(f"{whole.name!r} is a whole network and stands alone", start)
    if any(other.kind == word.kind for other in words):
        reader.example = ""
        reader.fail(f"a second {word.kind}; one is possible", start)
    words.append(word)


def _check_class(name: str, seen: list[str], reader: SpecReader, start: int) -> None:
    if name not in CLASSES:
        reader.fail(f"no class of messages is called {name!r}; there are {', '.join(CLASSES)}", start)
    if name in seen:
        reader.fail(f"the class {name!r} is there twice", start)


def _check_separated(reader: SpecReader, closing: str) -> None:
    """After an item comes white space, the closing bracket or the end."""
    position = reader.position
    reader.skip_space()
    if reader.position == position and not reader.at_end() and reader.rest()[0] != closing:
        reader.fail("expected a space or the end")


def _place(word: Word) -> tuple[int, str]:
    """By the chain's order; at one stage by kind, so that the order in the text does not matter."""
    return int(word.stage), word.kind


def _in_order(words: list[Word]) -> tuple[Word, ...]:
    return tuple(sorted(words, key=_place))


def _spec(words: list[Word], classes: list[tuple[str, tuple[Word, ...] | None]]) -> Spec:
    return Spec(_in_order(words), tuple(sorted(classes, key=lambda pair: CLASSES.index(pair[0]))))
