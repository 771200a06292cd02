"""Base class of the pydantic models of scene files, types of values, and messages for their mistakes."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationError
from pydantic_core import ErrorDetails
from pydantic_core.core_schema import CoreSchema, no_info_before_validator_function

from weier.checks import shown, suggestion
from weier.scene.mistakes import Mistake


class Section(BaseModel):
    """A mapping in a scene file, with these keys and no others."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    @property
    def given(self) -> dict[str, Any]:
        """The values of the keys in the file, in the order of the model."""
        return {name: value for name, value in self if name in self.model_fields_set}

    @classmethod
    def keys(cls) -> dict[str, str]:
        """Return the description of each key, by its name in files."""
        return {
            of.alias or name: f"{of.description}{' Required.' if of.is_required() else ''}"
            for name, of in cls.model_fields.items()
        }


class OneOrMore:
    """A list, which may be written as a single entry; duplicates count once."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return no_info_before_validator_function(as_list, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        listed = handler(schema)
        return {"anyOf": [listed["items"], listed]}


def as_list(value: Any) -> Any:
    """Return a list unchanged, and any other value as a list of one."""
    return value if isinstance(value, list) else [value]


def distinct(values: list[Any]) -> list[Any]:
    """Return each of some plain values once."""
    return list({json.dumps(value): value for value in values}.values())


def mistakes_of(error: ValidationError, raw: Any) -> Iterator[Mistake]:
    """Yield the mistakes of the plain values of a file, with their keys in the file.

    Pydantic's locations also contain markers of keys, and list positions of values written without a list.
    """
    for found in error.errors():
        keys, value, section = list[str | int](), raw, raw
        for key in found["loc"]:
            if isinstance(value, list) and isinstance(key, int):
                keys, value, section = [*keys, key], value[key], value
            elif isinstance(value, dict) and key != "[key]" and (isinstance(key, str) or key in value):
                keys, value, section = [*keys, key], value.get(key), value
        yield Mistake(tuple(keys), _words(found, section))


def _words(error: ErrorDetails, section: Any) -> str:
    """Return pydantic's message and the given value, or the message of a validator of weier.

    An unknown key is compared with the keys of the kind of section that shares most keys with this section.
    """
    if error["type"] == "value_error":
        return str(error["ctx"]["error"])
    if error["type"] == "missing":
        return error["msg"]
    if error["type"] == "extra_forbidden":
        known = max((of.keys() for of in Section.__subclasses__()), key=lambda keys: len(keys & section.keys()))
        return f"{error['msg']}{suggestion(error['loc'][-1], known)}"
    return f"{error['msg']}, got {shown(error['input'])}"
