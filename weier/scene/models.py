"""The keys of scene files as models: types, limits and descriptions.

The tables of keys follow from them: a new key is one field here, and `python docs/scene_keys.py` writes the table of
`config/README.md` again.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, Self

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainValidator,
    ValidationError,
    ValidationInfo,
    create_model,
    field_validator,
    model_validator,
)

from weier.checks import shown
from weier.data.bodies import Bodies
from weier.methods.registry import find_method
from weier.scene.case import Case, random_parameters
from weier.scene.cases import NAME
from weier.scene.figure import Figure, Grouping
from weier.scene.study import check_value
from weier.scene.trace_keys import TRACE_KEYS, TraceKey
from weier.scene.yaml import Keys, Mistake, number
from weier.surface.loads import check_range, listed_loads
from weier.units import NORMALISED_PRESSURE, PASCAL, factor
from weier.units import NUMBER as QUANTITY

ABSENT: Any = None  # default of an optional key
MAX_CASES = 10_000  # default limit; a typing error could ask for hours of work
SURFACES = ("product", "cases", "trace", "random")  # a study has exactly one of these keys


class Section(BaseModel):
    """A mapping in a scene file, with these keys and no others."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


def distinct(values: list[Any]) -> list[Any]:
    """Return each of some plain values once."""
    return list({json.dumps(value): value for value in values}.values())


class Range(Section):
    """Numbers in equal steps or ratios."""

    first: float = Field(alias="from", description="First value.")
    last: float = Field(alias="to", description="Last value.")
    count: Annotated[Whole, Field(ge=2, le=10**6)] = Field(description="Number of values, both ends included.")
    spacing: Literal["linear", "log"] = Field(
        "linear", description="Equal steps (linear, the default) or equal ratios (log)."
    )

    @model_validator(mode="after")
    def _possible(self) -> Self:
        least = 0.0 if self.spacing == "log" else -math.inf
        if not (least < min(self.first, self.last) and math.isfinite(self.last - self.first)):
            raise ValueError(
                f"a range must have finite ends, above 0 in equal ratios, got {self.first} and {self.last}"
            )
        return self

    def values(self) -> list[float]:
        """Return the numbers, whole numbers as integers."""
        space = np.geomspace if self.spacing == "log" else np.linspace
        return [int(v) if v.is_integer() else v for v in space(self.first, self.last, self.count).tolist()]


class LoadRange(Range):
    """Mean pressures in equal steps or ratios."""

    unit: Line = Field(
        NORMALISED_PRESSURE, description="Unit of both ends, such as MPa, for two bodies; p_0* by default."
    )


def _number(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"this must be a number, got {shown(value)}")
    return value


def _number_or_range(value: Any) -> Any:
    return Range.model_validate(value) if isinstance(value, dict) else _number(value)


def _phase(value: Any) -> Any:
    return [_number(one) for one in value] if isinstance(value, list) else _number_or_range(value)


def _load(value: Any) -> tuple[list[float], str]:
    """Return the values of a number or range, and their unit."""
    if isinstance(value, dict):
        found = LoadRange.model_validate(value)
        return found.values(), found.unit
    text = QUANTITY.fullmatch(value) if isinstance(value, str) else None
    return [float(text[1]) if text else number("a load", value)], (text and text[2]) or NORMALISED_PRESSURE


# Kinds of values
OneOrMore = BeforeValidator(lambda value: value if isinstance(value, list) else [value])
Number = Annotated[Any, PlainValidator(_number)]
TraceNumber = Annotated[Number, AfterValidator(partial(number, "this"))]
NumberOrRange = Annotated[Any, PlainValidator(_number_or_range)]
Phase = Annotated[Any, PlainValidator(_phase)]
Load = Annotated[Any, PlainValidator(_load)]
Whole = Annotated[int, Field(strict=False)]  # accepts 1e4
Position = Annotated[Whole, Field(ge=0)]
Line = Annotated[str, Field(pattern=r"^[^\x00-\x1f\x7f]*$", max_length=200)]
Name = Annotated[str, Field(pattern=f"^{NAME}$")]
FileName = Annotated[str, Field(min_length=1)]
Parameter = Literal["method", "D", "gamma", "m", "phases", "seed", "trace"]
MethodName = Annotated[str, AfterValidator(lambda name: find_method(name).name)]
Names = Annotated[list[Name], Field(min_length=1)]
Methods = Annotated[list[MethodName], Field(min_length=1), AfterValidator(distinct)]
Numbers = Annotated[list[NumberOrRange], Field(min_length=1), OneOrMore]
Phases = Annotated[list[Phase], Field(min_length=1), OneOrMore]
Parameters = Annotated[list[Parameter], Field(min_length=1), AfterValidator(distinct), OneOrMore]
FileNames = Annotated[list[FileName], Field(min_length=1), AfterValidator(distinct), OneOrMore]
Settings = dict[MethodName, dict[str, Any]]


class Pressures(NamedTuple):
    """Mean pressures, increasing, in p_0* or Pa, and the unit in which they were given."""

    values: Sequence[float] = ()
    unit: str = NORMALISED_PRESSURE

    @property
    def in_si(self) -> bool:
        """Whether the values are in Pa."""
        return self.unit != NORMALISED_PRESSURE


def _pressures(parts: list[tuple[list[float], str]]) -> Pressures:
    """Return the loads of a scene, all in one unit of pressure or all in p_0*."""
    unit, *others = {unit: None for _, unit in parts}
    if others:
        raise ValueError(f"loads must all be in one unit, got {unit} and {others[0]}")
    scale = 1.0 if unit == NORMALISED_PRESSURE else factor("loads", unit, PASCAL)
    loads, _ = listed_loads([scale * value for values, _ in parts for value in values])
    check_range(loads, unit if unit == NORMALISED_PRESSURE else PASCAL)
    return Pressures(loads.tolist(), unit)


if TYPE_CHECKING:
    Loads = Pressures
    Interface = Bodies
else:
    Loads = Annotated[list[Load], Field(min_length=1), AfterValidator(_pressures), OneOrMore]
    Interface = Annotated[dict[str, Any], AfterValidator(Bodies.from_texts)]


def _each_value(parts: list[Any], info: ValidationInfo) -> list[Any]:
    """Return each value once, checked."""
    values = distinct([v for part in parts for v in (part.values() if isinstance(part, Range) else [part])])
    for value in values:
        check_value(str(info.field_name), value)
    return values


class ProfileKeys(Section):
    """A product of parameters of the series: each combination of their values is a case."""

    D: Numbers = Field(description="Fractal dimension, between 1 and 2.")
    gamma: Numbers = Field(description='Ratio of wavelengths: 5 or "5/2".')
    m: Numbers = Field(description="Number of terms, or inf.")
    phases: Phases = Field(
        [],
        description="Phases in radians, as in weier.Profile: a number for all terms but the first, or a list of m; "
        "or a list of several of these.",
    )
    seed: Numbers = Field([], description="Seed of random phases.")

    _values = field_validator("*")(_each_value)

    @model_validator(mode="after")
    def _one_kind_of_phases(self) -> Self:
        if {"phases", "seed"} <= self.model_fields_set:
            raise ValueError("a profile takes phases or a seed, not both")
        return self


def _field(key: TraceKey) -> Any:
    """Return the field of a key of measured heights; `Trace.read` checks its value."""
    kinds = {float: TraceNumber, int: Position, str: Line}
    one: Any = Literal[key.kind] if isinstance(key.kind, tuple) else kinds[key.kind]
    if key.several:
        one = Annotated[list[one], Field(min_length=1), OneOrMore]
    return one, Field(ABSENT, description=key.says)


FILE = Field(
    description="A text file, or a pattern such as lab/*.csv (files in natural order), or a list of "
    "these, relative to the folder of the scene."
)
# Measured heights, as `weier.Trace.read` takes them.
TraceKeys: Any = create_model(
    "TraceKeys", __base__=Section, file=(FileNames, FILE), **{name: _field(key) for name, key in TRACE_KEYS.items()}
)


class RandomKeys(Section):
    """Random self-affine lines, as `weier.gaussian` makes them: one case per seed."""

    hurst: Number = Field(description="Hurst exponent H = 2 - D, between 0 and 1.")
    length: Number = Field(description="Period of the line, in m, or with a unit, as in 2 mm.")
    shortest: Number = Field(description="Shortest wavelength.")
    rolloff: Number = Field(
        ABSENT, description="Wavelength above which the spectrum is constant; the length by default."
    )
    rms_height: Number = Field(ABSENT, description="Root mean square height; it or rms_slope is required.")
    rms_slope: Number = Field(ABSENT, description="Root mean square slope.")
    seed: Numbers = Field([0], description="Seeds of the phases; 0 by default.")

    _values = field_validator("seed")(_each_value)

    @model_validator(mode="after")
    def _possible(self) -> Self:
        _ = Case({"trace": self.lines[0]}, (), {}).profile
        return self

    @property
    def lines(self) -> list[dict[str, Any]]:
        """The parameters of each line."""
        return random_parameters(self.model_dump(exclude_unset=True, exclude={"seed"}), self.seed)


class StudyKeys(Section):
    """A set of profiles or measured heights, and how they are solved."""

    product: ProfileKeys = Field(ABSENT, description="Profiles: all combinations of the given values.")
    cases: Annotated[list[ProfileKeys], Field(min_length=1)] = Field(ABSENT, description="Profiles, one by one.")
    trace: TraceKeys = Field(ABSENT, description="Measured heights.")
    random: RandomKeys = Field(ABSENT, description="Random self-affine lines.")
    loads: Loads = Field(ABSENT, description="Loads of this study, instead of the scene's, in the same unit.")
    methods: Methods = Field(ABSENT, description="Methods of this study, instead of the scene's.")
    settings: Settings = Field(ABSENT, description="Settings of this study, instead of the scene's.")

    @model_validator(mode="after")
    def _one_kind_of_surfaces(self) -> Self:
        if len(given := [kind for kind in SURFACES if kind in self.model_fields_set]) != 1:
            raise ValueError(f"one of {', '.join(SURFACES)} must be given, and not {' and '.join(given) or 'none'}")
        return self

    @property
    def products(self) -> list[tuple[Keys, dict[str, Any]]]:
        """The axes of each product with its keys in the file; each trace is a product of its own."""
        if self.random:
            return [(("random",), {"trace": self.random.lines})]
        if self.trace:
            given = self.trace.model_dump(exclude_unset=True)
            files = enumerate(self.trace.file)
            return [(("trace", "file", position), {"trace": given | {"file": file}}) for position, file in files]
        profiles: list[tuple[Keys, ProfileKeys]] = [(("product",), self.product)]
        if self.cases:
            profiles = [(("cases", position), case) for position, case in enumerate(self.cases)]
        return [(place, profile.model_dump(exclude_unset=True)) for place, profile in profiles]


class FigureKeys(Section):
    """What a figure draws, from which studies, and how."""

    draw: Name = Field(description="A module of weier.figures.")
    studies: Names = Field([], description="The studies it shows.")
    title: Line = Field("", description="Title of the figure, one line.")
    x: Literal["linear", "log"] = Field(ABSENT, description="Scale of the axis of loads.")
    colour: Parameter = Field(ABSENT, description="Parameter shown by the colour of a curve.")
    facet: Annotated[Parameters, Field(max_length=2)] = Field(
        [], description="Parameter with one value per panel; or two, for the rows and columns of panels."
    )
    median_over: Parameters = Field(
        [], alias="median over", description="Parameters over which a median is drawn, in a band from 10 to 90 %."
    )
    behind: Names = Field(
        [],
        description="Studies whose curves, by the most accurate method, form a grey band behind those of the same D, "
        "gamma and m.",
    )

    def figure(self, interface: Bodies | None) -> Figure:
        """Return the figure, in SI units with an interface."""
        grouping = Grouping(self.colour or "", tuple(self.facet), tuple(self.median_over))
        studies, behind = tuple(self.studies), tuple(self.behind)
        return Figure(self.draw, studies, self.title, grouping, behind, self.x or "", interface)


class SceneKeys(Section):
    """What to solve and what to draw: studies of profiles under one list of loads, and figures made from them."""

    title: Annotated[Line, Field(min_length=1)] = Field(description="Subject of the scene, one line.")
    max_cases: Annotated[Whole, Field(ge=1)] = Field(
        MAX_CASES, description=f"Largest number of cases of the scene; {MAX_CASES} by default."
    )
    loads: Loads = Field(
        description="Positive mean pressures in p_0*, in any order: a number, a range, or a list of these. With the "
        "key interface also in Pa, as {unit: MPa, from: 1, to: 100, count: 20} or [1 MPa, 10 MPa]: all cases then "
        "have these pressures, and the data are in SI units and this unit. Files have each load once, increasing."
    )
    methods: Methods = Field([], description="Methods for every case; `weier solve --help` lists them.")
    tolerance: Number = Field(
        ABSENT,
        description="Accepted error of the compliance, in g_0, for all methods that take one; for auto without any.",
    )
    settings: Settings = Field(
        {}, description="Settings of each method, as keywords of weier.solve: {bem: {points_per_wave: 16}}."
    )
    contact_edges: bool = Field(
        False, description="Keep the edges of all contacts, for figures that draw contact_tree."
    )
    interface: Interface = Field(
        ABSENT,
        description="The two bodies and the scale of their roughness, with the keywords of weier.Interface, for "
        "loads in Pa and figures in SI units. Values may have units, as in 210 GPa.",
    )
    studies: Annotated[dict[Name, StudyKeys], Field(min_length=1)] = Field(
        description="Named sets of profiles: each a product of D, gamma, m and phases or seed, a list of cases, a "
        "trace of measured heights, or random lines, optionally with its own methods and settings. A profile of "
        "several studies is solved once."
    )
    figures: dict[Name, FigureKeys] = Field(
        {},
        description="Named figures: kind, studies, title, scale of loads, the parameters shown by colour, facet and "
        "median over, and bands of ensembles.",
    )
    claims: dict[Name, Names] = Field(
        {}, description="Statements of the paper to check: their names in weier.pipeline.claims, and their studies."
    )


def mistakes_of(error: ValidationError) -> Iterator[Mistake]:
    """Yield pydantic's mistakes, in its words and at its locations."""
    for found in error.errors():
        complete = found["type"] in ("missing", "extra_forbidden", "value_error")
        given = "" if complete else f", got {shown(found['input'])}"
        given += ": the documentation of scenes lists the keys" * (found["type"] == "extra_forbidden")
        yield Mistake(found["loc"], found["msg"].removeprefix("Value error, ") + given)
