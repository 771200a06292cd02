"""Parts of scene files as models, whose errors are mistakes in plain words: all of them at once."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self, TypeVar

from pydantic import (
    BaseModel,
    ConfigDict,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ModelWrapValidatorHandler,
    PrivateAttr,
    ValidationError,
    model_validator,
)
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError
from pydantic_core.core_schema import (
    CoreSchema,
    no_info_after_validator_function,
    no_info_before_validator_function,
)

from weier.checks import checked_word, nearest, shown, suggestion
from weier.scene.mistakes import Mistake

# Names in the places of pydantic that are no keys of the file: of a wrong key of a mapping, and of alternatives.
TAGS = KEY, NUMBER, LIST, RANGE = "[key]", "[number]", "[list]", "[range]"
Item = TypeVar("Item")
SAME_WORD = 0.7  # The value of an unknown key of this similarity (difflib) to a known one is validated, too.

# Types of errors of pydantic, as the wanted kinds of values in plain words.
KINDS = {
    **dict.fromkeys(("string_type", "string_unicode"), "a text"),
    **dict.fromkeys(("int_type", "int_from_float"), "a whole number"),
    **dict.fromkeys(("dict_type", "model_type"), "a mapping"),
    "float_type": "a number",
    "bool_type": "true or false",
    "list_type": "a list",
}
# Types of errors of pydantic about limits, as conditions in plain words, and the names of the limits.
LIMITS = {
    "greater_than": ("more than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than_equal": ("at most", "le"),
}


class Part(BaseModel):
    """A mapping in a scene file, with these keys and no others.

    `synonyms` has the key that is meant by other names of it.
    """

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)
    synonyms: ClassVar[Mapping[str, str]] = {}
    _given: dict[str, Any] = PrivateAttr(default_factory=dict)

    @property
    def given(self) -> dict[str, Any]:
        """The values of the keys in the file, in its order."""
        return self._given

    @classmethod
    def keys(cls) -> dict[str, str]:
        """Return the description of each key, by its name in files."""
        return {of.alias or name: of.description or "" for name, of in cls.model_fields.items()}

    @classmethod
    def rules(cls, values: Mapping[str, Any]) -> Iterator[Mistake]:
        """Yield mistakes that concern several keys; the values may have mistakes of their own."""
        yield from ()

    @model_validator(mode="wrap")
    @classmethod
    def _validate(cls, values: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Report all mistakes in plain words; the value of a misspelt key is validated as that of the known key."""
        if not isinstance(values, dict):
            return handler(values)
        spelling = cls._spelling(values)
        known = {key: values[spelt] for key, spelt in spelling.items()}
        mistakes = [Mistake((key,), cls._unknown(key)) for key in values if key not in spelling]
        try:
            made = handler(known)
        except ValidationError as error:
            mistakes += [Mistake(found["loc"], cls._words(found)) for found in error.errors()]
        mistakes += cls.rules(known)
        if mistakes:
            places = [(*(spelling.get(str(key), key) for key in keys[:1]), *keys[1:]) for keys, _ in mistakes]
            raise all_of(Mistake(place, text) for place, (_, text) in zip(places, mistakes, strict=True)) from None
        fields = {of.alias or name: name for name, of in cls.model_fields.items()}
        made._given = {key: getattr(made, fields[key]) for key in known}
        return made

    @classmethod
    def _spelling(cls, values: Mapping[str, Any]) -> dict[str, str]:
        """Return the known keys that are given, in the order of the file, each as it is spelt there."""
        known = cls.keys()
        near = {key: key if key in known else cls.synonyms.get(key, nearest(key, known, SAME_WORD)) for key in values}
        # The right spelling of a key wins over another one of it.
        return {name: name if name in values else key for key, name in near.items() if name}

    @classmethod
    def _unknown(cls, key: str) -> str:
        known = cls.keys()
        return f"there is no such key, only {', '.join(known)}{suggestion(cls.synonyms.get(key, key), known)}"

    @classmethod
    def _words(cls, error: ErrorDetails) -> str:
        if error["type"] == "missing":
            return f"this key is missing: {cls.keys()[str(error['loc'][0])]}"
        return words(error)


@dataclass(frozen=True, init=False)
class OneOf:
    """A word out of some: those given, or those that a function returns when a word is checked."""

    choices: Callable[[], Collection[str]]

    def __init__(self, *choices: str, of: Callable[[], Collection[str]] | None = None) -> None:
        object.__setattr__(self, "choices", of or (lambda: choices))

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return no_info_after_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return handler(schema) | {"enum": list(self.choices())}

    def _check(self, word: str) -> str:
        return checked_word("this", word, self.choices())


@dataclass(frozen=True)
class Pattern:
    """A text that fits a regular expression, which is the condition in words."""

    pattern: str
    condition: str

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return no_info_after_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return handler(schema) | {"pattern": f"^{self.pattern}$"}

    def _check(self, text: str) -> str:
        if not re.fullmatch(self.pattern, text):
            raise ValueError(f"this must be {self.condition}, got {shown(text)}")
        return text


@dataclass(frozen=True)
class OneOrMore:
    """A list, in place of which a single entry may stand.

    types, words : the types that the value may have, and the value in words; by default any
    """

    types: tuple[type, ...] = (object,)
    words: str = ""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return no_info_before_validator_function(self._listed, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        listed = handler(schema)
        return {"anyOf": [listed["items"], listed]}

    def _listed(self, value: Any) -> Any:
        if not isinstance(value, self.types) or (self.words and isinstance(value, bool)):
            raise ValueError(f"this must be {self.words}, got {shown(value)}")
        return as_list(value)


def as_list(value: Any) -> Any:
    """Return a list as it is, and another value as a list of one."""
    return value if isinstance(value, list) else [value]


def check_once(values: list[Item]) -> list[Item]:
    """Refuse a list in which a value stands twice."""
    if any(value in values[:position] for position, value in enumerate(values)):
        raise ValueError(f"each of these may stand once, got {shown(values)}")
    return values


def words(error: ErrorDetails) -> str:
    """Return the condition that an error of pydantic is about, and the given value."""
    kind, value, details = error["type"], error["input"], error.get("ctx", {})
    if kind == "mistake":
        return str(details["text"])
    if kind == "value_error":
        return str(details["error"])
    if kind in LIMITS:
        condition, limit = LIMITS[kind]
        return f"this must be {condition} {details[limit]:g}, got {shown(value)}"
    if kind in ("too_short", "string_too_short"):
        least = details["min_length"]
        return f"this must have at least {least} {'entry' if least == 1 else 'entries'}"
    if kind == "too_long":
        return f"this must have at most {details['max_length']} entries, got {details['actual_length']}"
    if kind == "union_tag_invalid":
        wanted = " or ".join(f"a {name}" for name in re.findall(r"\w+", details["expected_tags"]))
        return f"this must be {wanted}, got a {details['tag'].strip('[]')}"
    return f"this must be {KINDS[kind]}, got {shown(value)}" if kind in KINDS else error["msg"]


def all_of(mistakes: Iterable[Mistake]) -> ValidationError:
    """Return several mistakes as the error of a validator, with their keys below its value."""
    errors = [
        InitErrorDetails(type=PydanticCustomError("mistake", "{text}", {"text": text}), loc=keys, input=None)
        for keys, text in mistakes
    ]
    return ValidationError.from_exception_data("a scene", errors)


def mistakes_of(error: ValidationError, raw: Any) -> Iterator[Mistake]:
    """Yield the mistakes of the plain values of a file, with their keys in the file.

    The places of pydantic also have names of alternatives, and positions within lists that stand for a single value.
    """
    for found in error.errors():
        keys, value = list[str | int](), raw
        for key in found["loc"]:
            if isinstance(value, list) and isinstance(key, int):
                keys, value = [*keys, key], value[key]
            elif isinstance(value, dict) and isinstance(key, str) and key not in TAGS:
                keys, value = [*keys, key], value.get(key)
        yield Mistake(tuple(keys), words(found))
