"""Validation of scene files by `schema.json`, with messages in plain words."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from difflib import get_close_matches
from importlib.resources import files
from itertools import groupby
from typing import TYPE_CHECKING, Any

from weier.checks import shown, suggestion
from weier.methods.registry import names
from weier.scene.mistakes import Keys, Mistake
from weier.surface.measured.units import UNITS

if TYPE_CHECKING:
    from jsonschema import ValidationError

# The types of JSON schema in plain words.
KINDS = {
    "string": "a text",
    "object": "a mapping",
    "array": "a list",
    "integer": "a whole number",
    "number": "a number",
    "boolean": "true or false",
}
# The limits of JSON schema in plain words.
LIMITS = {"minimum": "at least", "maximum": "at most", "exclusiveMinimum": "more than"}
# The names of numpy.linspace and others for the keys of a range.
SYNONYMS = {"n": "count", "num": "count", "start": "from", "min": "from", "stop": "to", "end": "to", "max": "to"}
SAME_WORD = 0.8  # A key of this similarity (difflib) is taken for a missing key, misspelt.


def schema() -> dict[str, Any]:
    """The JSON schema of scene files, with the names of all methods there are."""
    loaded = json.loads(files("weier.scene").joinpath("schema.json").read_text(encoding="utf-8"))
    loaded["$defs"]["method"]["enum"] = names()
    loaded["$defs"]["parameter"]["enum"] = ["method", *loaded["$defs"]["profile"]["properties"], "trace"]
    loaded["$defs"]["unit"]["enum"] = list(UNITS)
    return loaded


def mistakes_of_form(raw: Any) -> list[Mistake]:
    """The violations of the schema by the plain values of a file, each with its keys."""
    import jsonschema  # The import takes longer than the rest of a scene.

    known = schema()
    errors = jsonschema.Draft202012Validator(known).iter_errors(raw)
    return [mistake for error in errors for mistake in _mistakes(error, known)]


def _mistakes(error: ValidationError, known: Mapping[str, Any]) -> Iterator[Mistake]:
    keys: Keys = tuple(error.absolute_path)
    value, kind = error.instance, error.validator
    if "propertyNames" in error.absolute_schema_path:
        keys = (*keys, value)
    if kind == "additionalProperties":
        allowed = error.schema["properties"]
        for key in value.keys() - allowed.keys():
            meant = suggestion(SYNONYMS.get(key, key), allowed) or suggestion(key, allowed)
            yield Mistake((*keys, key), f"there is no such key, only {', '.join(allowed)}{meant}")
    elif kind == "required":
        yield from _missing(error, keys, known)
    elif kind == "anyOf":
        yield from _of_alternatives(error, keys, known)
    else:
        yield Mistake(keys, _words(error))


def _missing(error: ValidationError, keys: Keys, known: Mapping[str, Any]) -> Iterator[Mistake]:
    """The missing keys, except those that are misspelt or have a synonym, which is a mistake by itself."""
    of_all = error.schema.get("properties", known["properties"])
    for key in error.validator_value:
        given = [*error.instance, *(SYNONYMS[key] for key in error.instance if key in SYNONYMS)]
        if not get_close_matches(key, given, cutoff=SAME_WORD):
            yield Mistake((*keys, key), f"this key is missing: {of_all[key]['description']}")


def _of_alternatives(error: ValidationError, keys: Keys, known: Mapping[str, Any]) -> Iterator[Mistake]:
    """The mistakes by the alternative whose type the value has, or else a list of all alternatives."""
    by_alternative = groupby(error.context, lambda cause: cause.schema_path[0])
    causes = [list(group) for _, group in by_alternative]
    fitting = [group for group in causes if not any(cause.validator == "type" and not cause.path for cause in group)]
    if fitting:
        for cause in min(fitting, key=len):
            yield from _mistakes(cause, known)
    else:
        yield Mistake(keys, f"this must be {kind_of(error.schema, known)}, got {shown(error.instance)}")


def _words(error: ValidationError) -> str:
    """The condition on a value, and the given value."""
    wanted, value = error.validator_value, error.instance
    match error.validator:
        case "enum":
            return f"this must be one of {', '.join(wanted)}, got {shown(value)}{suggestion(value, wanted)}"
        case "type":
            kinds = wanted if isinstance(wanted, list) else [wanted]
            return f"this must be {' or '.join(KINDS[kind] for kind in kinds)}, got {shown(value)}"
        case "minimum" | "maximum" | "exclusiveMinimum" as limit:
            return f"this must be {LIMITS[limit]} {wanted}, got {shown(value)}"
        case "minItems" | "minProperties" | "minLength":
            return f"this must have at least {wanted} {'entry' if wanted == 1 else 'entries'}"
        case "maxItems":
            return f"this must have at most {wanted} entries, got {len(value)}"
        case "uniqueItems":
            return f"each of these may stand once, got {shown(value)}"
        case "pattern" | "maxLength":
            return f"this must be {error.schema['description']}, got {shown(value)}"
        case "oneOf":
            choices = [choice["required"][0] for choice in wanted]
            given = " and ".join(choice for choice in choices if isinstance(value, dict) and choice in value)
            return f"one of {', '.join(choices)} must be given, and not {given or 'none'}"
        case "not":
            return str(wanted["description"])
        case "dependentRequired":
            return "; ".join(f"{key} needs {', '.join(others)}" for key, others in wanted.items() if key in value)
    return str(error.message)


def kind_of(part: Mapping[str, Any], known: Mapping[str, Any]) -> str:
    """The values that a part of the schema allows, in words."""
    if "$ref" in part:
        of = known["$defs"][part["$ref"].rpartition("/")[2]]
        return of.get("title") or kind_of(of, known)
    if "title" in part:
        return str(part["title"])
    if "enum" in part:
        return ", ".join(part["enum"])
    if "anyOf" in part:
        return " or ".join(dict.fromkeys(kind_of(alternative, known) for alternative in part["anyOf"]))
    if part.get("type") == "array":
        return "a list of " + re.sub(r"^a (\w+)$", r"\1s", kind_of(part["items"], known))
    kinds = part.get("type", "object")
    return " or ".join(KINDS[kind] for kind in (kinds if isinstance(kinds, list) else [kinds]))
