"""The keys of scene files as models: types, limits and descriptions.

Messages, the JSON schema for editors and the tables of keys follow from them: a new key is one field here, and
`python -m weier.scene` writes `config/scene.schema.json` and the table of `config/README.md` again.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Annotated, Any, ClassVar, NamedTuple

import numpy as np
from pydantic import (
    AfterValidator,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    ValidationInfo,
    field_validator,
)

from weier.checks import checked_word, nearest, shown, suggestion
from weier.data.bodies import Bodies
from weier.methods import auto
from weier.methods.registry import find_method, names
from weier.methods.settings import checked_settings
from weier.scene.cases import NAME, NAME_IN_WORDS
from weier.scene.figure import ALL, FREE, MEAN, PERCENTILES, Axis, Figure, Grouping
from weier.scene.mistakes import Keys, Mistake, Mistakes
from weier.scene.part import LIST, NUMBER, RANGE, OneOf, OneOrMore, Part, Pattern, all_of, as_list, check_once
from weier.scene.study import MAX_CASES, check_number, check_value
from weier.scene.yaml import number
from weier.surface.loads import check_pascal, check_range, listed_loads
from weier.surface.measured.artefacts import DETREND, MAX_GAP, MISSING, REFUSE
from weier.surface.measured.instruments import AXES
from weier.surface.measured.text import SEPARATORS
from weier.surface.measured.trace import ENDS, MIRRORED
from weier.surface.measured.units import UNITS
from weier.surface.profile import Profile
from weier.theory.conduction import RANGES
from weier.units import NORMALISED_PRESSURE, PASCAL, factor, mixed
from weier.units import NUMBER as QUANTITY

MAX_LINE = 200  # characters of a title
LINE = rf"[^\x00-\x1f\x7f\ud800-\udfff]{{0,{MAX_LINE}}}"
MAX_RANGE_VALUES = 10**6  # The values of a range are a list in memory.
# Settings that are words are checked on this profile, since they are valid for all profiles or for none.
ONE_WAVE = Profile(1.5, 2, 1)
ABSENT: Any = None  # The value of a key that a file need not have.
NUMBERS = "a number, a range, or a list of these"
FILES = "the name of a file, or a list of these"
NUMBER_TYPES = int, float, str, dict, list
SCALE = "log, linear, or {scale, from, to}"


def _check_number(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"this must be a number, got {shown(value)}")
    return value


def _check_channel(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, int | str):
        raise ValueError(f"this must be a text or a whole number, got {shown(value)}")
    return value


def _as_whole(value: Any) -> Any:
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _as_axis(value: Any) -> Any:
    if not isinstance(value, str | dict):
        raise ValueError(f"this must be {SCALE}, got {shown(value)}")
    return {"scale": value} if isinstance(value, str) else value


def _kind(value: Any) -> str:
    return RANGE if isinstance(value, dict | Range) else LIST if isinstance(value, list) else NUMBER


def _parameters() -> list[str]:
    """Return the parameters that figures can show."""
    return ["method", *ProfileKeys.keys(), "trace"]


class Range(Part):
    """Numbers in equal steps or ratios."""

    model_config = ConfigDict(title="a range")
    # The names of numpy.linspace and others.
    synonyms: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("n", "num"), "count"),
        **dict.fromkeys(("start", "min"), "from"),
        **dict.fromkeys(("stop", "end", "max"), "to"),
    }
    first: float = Field(alias="from", description="First value.")
    last: float = Field(alias="to", description="Last value.")
    count: Several = Field(description="Number of values, both ends included.")
    spacing: Annotated[str, OneOf("linear", "log")] = Field(
        "linear", description="Equal steps (linear, the default) or equal ratios (log)."
    )

    def values(self) -> list[float]:
        """Return the numbers; those that are whole as integers."""
        if self.count > MAX_RANGE_VALUES:
            raise ValueError(f"a range must have at most {MAX_RANGE_VALUES} values, got {self.count}")
        if self.spacing == "log" and not min(self.first, self.last) > 0:
            raise ValueError(f"a range in equal ratios must lie above 0, got {min(self.first, self.last):g}")
        if not np.isfinite(self.last - self.first):
            raise ValueError(f"a range must have finite ends, got {self.first:g} and {self.last:g}")
        space = np.geomspace if self.spacing == "log" else np.linspace
        return [int(v) if v.is_integer() else v for v in space(self.first, self.last, self.count).tolist()]


class LoadRange(Range):
    """Mean pressures in equal steps or ratios."""

    model_config = ConfigDict(title="a range of loads")
    unit: Line = Field("", description="Unit of both ends, such as MPa, for two bodies; p_0* by default.")


# Kinds of values, each with its limits, and with its name in messages and tables.
# A limit behind the validator of whole floats would not be in the JSON schema.
Position = Annotated[int, Field(ge=0), BeforeValidator(_as_whole)]
Count = Annotated[int, Field(ge=1), BeforeValidator(_as_whole)]
Several = Annotated[int, Field(ge=2), BeforeValidator(_as_whole)]
Number = Annotated[
    float | str, PlainValidator(_check_number, json_schema_input_type=float | str), Field(title="a number")
]
Line = Annotated[str, Pattern(LINE, f"one line of at most {MAX_LINE} characters"), Field(title="a text")]
Name = Annotated[str, Pattern(NAME, NAME_IN_WORDS), Field(title="a name")]
Names = Annotated[list[Name], Field(min_length=1, title="a list of names")]
MethodName = Annotated[str, OneOf(of=names)]
Methods = Annotated[list[MethodName], Field(min_length=1), AfterValidator(check_once)]
Parameter = Annotated[str, OneOf(of=_parameters)]
Unit = Annotated[str, OneOf(*UNITS)]
FileName = Annotated[str, Field(min_length=1, title="the name of a file")]

NumberOrRange = Annotated[Annotated[Number, Tag(NUMBER)] | Annotated[Range, Tag(RANGE)], Discriminator(_kind)]
Numbers = Annotated[list[NumberOrRange], Field(min_length=1, title=NUMBERS), OneOrMore(NUMBER_TYPES, NUMBERS)]
LoadOrRange = Annotated[Annotated[Number, Tag(NUMBER)] | Annotated[LoadRange, Tag(RANGE)], Discriminator(_kind)]
Phase = Annotated[
    Annotated[Number, Tag(NUMBER)] | Annotated[list[float], Tag(LIST)] | Annotated[Range, Tag(RANGE)],
    Discriminator(_kind),
]
Phases = Annotated[
    list[Phase], Field(min_length=1, title=f"{NUMBERS}, or of lists"), OneOrMore(NUMBER_TYPES, NUMBERS)
]
Sign = Annotated[str, Field(min_length=1, max_length=1, title="one sign")]
Word = Annotated[Line, Field(title="a text")]
Words = Annotated[list[Word], Field(title="a text, or a list of these"), OneOrMore()]
MissingValues = Annotated[
    list[Number], Field(min_length=1, title="a number or a text, or a list of these"), OneOrMore()
]
Wavelengths = Annotated[
    list[Number], Field(min_length=1, title="a number, or a list of these"), AfterValidator(check_once), OneOrMore()
]
Columns = Annotated[
    list[Position], Field(min_length=1, max_length=2, title="a whole number, or two of these"), OneOrMore()
]
FileNames = Annotated[
    list[FileName], Field(min_length=1, title=FILES), AfterValidator(check_once), OneOrMore((str, list), FILES)
]
Parameters = Annotated[list[Parameter], Field(min_length=1), AfterValidator(check_once), OneOrMore()]


def distinct(values: list[Any]) -> list[Any]:
    """Return each of some plain values once."""
    return list({json.dumps(value): value for value in values}.values())


def values_of(parts: list[Any]) -> list[Any]:
    """Return the values of a list of numbers and ranges."""
    return [value for part in parts for value in (part.values() if isinstance(part, Range) else [part])]


class Loads(NamedTuple):
    """Mean pressures, increasing, in p_0* or Pa, and the unit in which they were given; Pa if in several."""

    values: list[float]
    unit: str = NORMALISED_PRESSURE

    @property
    def in_si(self) -> bool:
        """Whether the values are in Pa."""
        return self.unit != NORMALISED_PRESSURE


def _loads(parts: list[Any]) -> Loads:
    """Return the loads of a scene, all with a unit of pressure or all without."""
    given = [one for part in parts for one in _with_units(part)]
    if not (named := [unit for _, unit in given if unit]):
        loads, _ = listed_loads([value for value, _ in given])
        check_range(loads)
        return Loads(loads.tolist())
    if len(named) < len(given):
        raise ValueError(mixed("loads", named[0]))
    loads, _ = listed_loads([value * factor("loads", unit, PASCAL) for value, unit in given])
    check_pascal(loads)
    return Loads(loads.tolist(), named[0] if len({*named}) == 1 else PASCAL)


def _with_units(part: Any) -> list[tuple[float, str]]:
    """Return the numbers of a number or range, each with its unit or an empty text."""
    if isinstance(part, LoadRange):
        return [(float(value), part.unit) for value in part.values()]
    text = QUANTITY.fullmatch(part) if isinstance(part, str) else None
    return [(float(text[1]), text[2])] if text else [(number("a load", part), "")]


class ProfileKeys(Part):
    """A product of parameters of the series: each combination of their values is a case."""

    model_config = ConfigDict(title="a profile")
    D: Numbers = Field(description="Fractal dimension, between 1 and 2.")
    gamma: Numbers = Field(description='Ratio of wavelengths: 5 or "5/2".')
    m: Numbers = Field(description="Number of terms, or inf.")
    phases: Phases = Field(
        [],
        description="Phases in radians, as in weier.Profile: a number for all terms but the first, or a list of m; "
        "or a list of several of these.",
    )
    seed: Numbers = Field([], description="Seed of random phases.")

    @field_validator("*")
    @classmethod
    def _values(cls, parts: list[Any], info: ValidationInfo) -> list[Any]:
        """Return each value once. Too many are refused before they are made, since each is checked."""
        name, most = str(info.field_name), (info.context or {}).get("max_cases", MAX_CASES)
        check_number(sum(part.count if isinstance(part, Range) else 1 for part in parts), most)
        values = distinct(values_of(parts))
        for value in values:
            check_value(name, value)
        return values

    @classmethod
    def rules(cls, values: Mapping[str, Any]) -> Iterator[Mistake]:
        """Yield a mistake if phases are both given and drawn."""
        if {"phases", "seed"} <= values.keys():
            yield Mistake((), "a profile takes phases or a seed, not both")


class TraceKeys(Part):
    """Measured heights, as `weier.Trace.read` takes them."""

    model_config = ConfigDict(title="a trace")
    file: FileNames = Field(
        description="A text or instrument file, a folder or a pattern such as lab/*.csv (files in natural order), or "
        "a list of these, relative to the folder of the scene."
    )
    shortest: Wavelengths = Field(
        ABSENT,
        description="Shortest wavelength, in m or in x_unit or unit; two steps by default. A list makes one case per "
        "file and value.",
    )
    longest: Number = Field(
        ABSENT,
        description="Longest wavelength of the series that is fitted to the spectrum, in m or in x_unit or unit; by "
        "default a quarter of the length, or less where the spectrum rolls off.",
    )
    length: Number = Field(
        ABSENT, description="Length of the trace if the file does not give it, in m or in x_unit or unit."
    )
    ends: Annotated[str, OneOf(*ENDS)] = Field(
        ABSENT, description=f"Extension of the trace beyond its ends; {MIRRORED} by default."
    )
    unit: Unit = Field(ABSENT, description="Unit of positions, length, shortest and heights, overriding the file.")
    x_unit: Unit = Field(ABSENT, description="Unit of positions, length and shortest.")
    height_unit: Unit = Field(ABSENT, description="Unit of heights.")
    skip: Position = Field(ABSENT, description="Number of lines above the table of a text file.")
    rows: Count = Field(ABSENT, description="Number of rows of the table.")
    columns: Columns = Field(ABSENT, description="Column of heights, from 0, or columns of positions and heights.")
    delimiter: Sign = Field(ABSENT, description='Column separator; " " stands for blanks.')
    decimal: Annotated[str, OneOf(".", ",")] = Field(ABSENT, description="Decimal mark.")
    thousands: Annotated[str, OneOf(*SEPARATORS)] = Field(ABSENT, description="Thousands separator.")
    encoding: Line = Field(ABSENT, description="Encoding of a text file, by its Python name.")
    comment: Words = Field(ABSENT, description='Prefixes of lines to skip; "" stands for empty lines.')
    detrend: Annotated[str, OneOf(*DETREND)] = Field(
        ABSENT,
        description="Component removed from the heights: mean, tilt (a straight line, the default) or form (a "
        "parabola).",
    )
    missing: Annotated[str, OneOf(*MISSING)] = Field(
        ABSENT, description=f"Treatment of missing heights; {REFUSE} by default."
    )
    max_gap: Count = Field(
        ABSENT, description=f"Longest run of missing heights that is interpolated; {MAX_GAP} by default."
    )
    missing_value: MissingValues = Field(
        ABSENT,
        description="Numbers, in the unit of the heights, and words for missing heights.",
    )
    line: Position = Field(
        ABSENT, description="Index of the line of a map, from 0; with across alone, each line is a case."
    )
    across: Annotated[str, OneOf(*AXES)] = Field(
        ABSENT, description="Axis of the lines of a map, across its grooves."
    )
    channel: Annotated[str | int, PlainValidator(_check_channel, json_schema_input_type=str | int)] = Field(
        ABSENT, description="Channel of the file, by name or number from 0."
    )


def _check_settings(settings: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """Check each setting separately, those of a misspelt method as those of the method it means."""
    found = Mistakes()
    for name, own in settings.items():
        found.attempt((name,), partial(checked_word, "this", name, names()), None)
        if method := name if name in names() else nearest(name, names()):
            for setting, value in own.items():
                found.attempt((name, setting), partial(_check_setting, method, setting, value), None)
    if found:
        raise all_of(found.listed())
    return settings


def _check_setting(name: str, setting: str, value: Any) -> None:
    """Refuse a setting that is invalid for every profile and all other settings."""
    method = find_method(name)
    checked_settings(method, {setting: value})
    if isinstance(value, str):
        method.check(ONE_WAVE, **{setting: value})


Settings = Annotated[
    dict[Annotated[str, Field(json_schema_extra=lambda schema: schema.update(enum=names()))], dict[str, Any]],
    Field(title="settings by method"),
    AfterValidator(_check_settings),
]


LoadList = Annotated[
    list[LoadOrRange],
    Field(min_length=1, title=NUMBERS),
    OneOrMore(NUMBER_TYPES, NUMBERS),
    AfterValidator(_loads),
]


class StudyKeys(Part):
    """A set of profiles or measured heights, and how they are solved."""

    model_config = ConfigDict(
        title="a study", json_schema_extra={"oneOf": [{"required": [key]} for key in ("product", "cases", "trace")]}
    )
    product: ProfileKeys = Field(ABSENT, description="Profiles: all combinations of the given values.")
    cases: Annotated[list[ProfileKeys], Field(min_length=1)] = Field(ABSENT, description="Profiles, one by one.")
    trace: TraceKeys = Field(ABSENT, description="Measured heights.")
    loads: LoadList = Field(ABSENT, description="Loads of this study, instead of the scene's, in the same unit.")
    methods: Methods = Field(ABSENT, description="Methods of this study, instead of the scene's.")
    settings: Settings = Field(ABSENT, description="Settings of this study, instead of the scene's.")

    @classmethod
    def rules(cls, values: Mapping[str, Any]) -> Iterator[Mistake]:
        """Yield a mistake unless a study has one kind of surfaces."""
        kinds = "product", "cases", "trace"
        given = [kind for kind in kinds if kind in values]
        if len(given) != 1:
            yield Mistake((), f"one of {', '.join(kinds)} must be given, and not {' and '.join(given) or 'none'}")

    @property
    def count(self) -> int:
        """The number of cases; a map or a pattern of files is one until its lines or files are counted."""
        if self.trace:
            return len(self.trace.file) * len(self.trace.shortest or [None])
        return sum(math.prod(map(len, axes.values())) for _, axes in self.products)

    @property
    def products(self) -> list[tuple[Keys, dict[str, Any]]]:
        """The axes of each product, with its keys in the file; each trace is one."""
        if self.product:
            return [(("product",), self.product.given)]
        if self.cases:
            return [(("cases", position), case.given) for position, case in enumerate(self.cases)]
        files, given = self.trace.file, self.trace.given
        places: list[Keys] = [("trace", "file", number) for number in range(len(files))]
        traces = [{"trace": given | {"file": file}} for file in files]
        return list(zip(places if len(files) > 1 else [("trace", "file")], traces, strict=True))


class InterfaceKeys(Part):
    """The values of `weier.Interface`."""

    model_config = ConfigDict(title="the values of weier.Interface")
    mu_1: Number = Field(ABSENT, description="Shear modulus of the first body, in Pa; inf for a rigid one.")
    mu_2: Number = Field(ABSENT, description="Shear modulus of the second body.")
    E_1: Number = Field(
        ABSENT, description="Young's modulus of the first body, E = 2 mu (1 + nu), in Pa, instead of mu_1."
    )
    E_2: Number = Field(ABSENT, description="Young's modulus of the second body, instead of mu_2.")
    nu_1: Number = Field(description="Poisson's ratio of the first body, in (-1, 0.5].")
    nu_2: Number = Field(description="Poisson's ratio of the second body.")
    rho_1: Number = Field(description="Resistivity of the first body, in ohm m.")
    rho_2: Number = Field(description="Resistivity of the second body.")
    hardness_1: Number = Field(
        ABSENT, description="Hardness of the first body, in Pa: results say where contacts come near the lower one."
    )
    hardness_2: Number = Field(ABSENT, description="Hardness of the second body.")
    lambda_0: Number = Field(
        ABSENT, description="Wavelength of the coarsest wave of the series, in m; traces have their own."
    )
    g_0: Number = Field(
        ABSENT, description="Amplitude of the coarsest wave of the series, in m; traces have their own."
    )

    @classmethod
    def rules(cls, values: Mapping[str, Any]) -> Iterator[Mistake]:
        """Yield a mistake for each body without exactly one modulus."""
        for kinds in ("mu_1", "E_1"), ("mu_2", "E_2"):
            given = [kind for kind in kinds if kind in values]
            if len(given) != 1:
                yield Mistake((), f"one of {', '.join(kinds)} must be given, and not {' and '.join(given) or 'none'}")

    def checked(self) -> InterfaceKeys:
        """Return these keys, if the values are possible."""
        self.bodies()
        return self

    def bodies(self) -> Bodies:
        """Return the two bodies."""
        return Bodies(**self.values)

    @property
    def values(self) -> dict[str, float]:
        """The numbers in SI units, by the names of the keys."""
        return {name: number(name, value, RANGES[name][2]) for name, value in self.given.items()}


class AxisKeys(Part):
    """The scale and the ends of an axis."""

    model_config = ConfigDict(title="an axis")
    scale: Annotated[str, OneOf("linear", "log")] = Field("", description="Scale of the axis, linear or log.")
    first: float = Field(ABSENT, alias="from", description="Start of the axis.")
    last: float = Field(ABSENT, alias="to", description="End of the axis.")

    def checked(self) -> AxisKeys:
        """Return these keys, if the ends and the scale are possible."""
        ends = [end for end in self.axis[1:] if end is not None]
        if not np.isfinite(ends).all():
            raise ValueError("the ends of an axis must be finite")
        if self.scale == "log" and min(ends, default=1.0) <= 0:
            raise ValueError(f"a logarithmic axis must lie above 0, got {min(ends):g}")
        if len(ends) == 2 and ends[0] >= ends[1]:
            raise ValueError(f"an axis must begin below its end, got {ends[0]:g} to {ends[1]:g}")
        return self

    @property
    def axis(self) -> Axis:
        """The axis."""
        return Axis(self.scale, self.first, self.last)


Scale = Annotated[
    AxisKeys,
    Field(title=SCALE),
    AfterValidator(AxisKeys.checked),
    BeforeValidator(_as_axis, json_schema_input_type=Annotated[str, OneOf("linear", "log")] | AxisKeys),
]
Inches = Annotated[float, Field(gt=0, le=100)]


Percentile = Annotated[float, Field(ge=0, le=100)]


def _check_band(band: list[float] | str) -> list[float] | str:
    if not isinstance(band, str) and (len(band) != 2 or band[0] >= band[1]):
        raise ValueError(f"a band is two percentiles, the lower one first, got {band}")
    return band


class FigureKeys(Part):
    """What a figure draws, from which studies, and how."""

    model_config = ConfigDict(title="a figure")
    draw: Name = Field(description="A module of weier.figures.")
    studies: Names = Field([], description="The studies it shows.")
    title: Line = Field("", description="Title of the figure, one line.")
    x: Scale = Field(ABSENT, description="Axis of loads: scale and ends.")
    y: Scale = Field(ABSENT, description="Other axis: scale and ends.")
    size: Annotated[list[Inches], Field(min_length=2, max_length=2)] = Field(
        ABSENT, description="Width and height in inches; a journal column is 3.5 wide."
    )
    colour: Parameter = Field("", description="Parameter shown by the colour of a curve.")
    facet: Annotated[Parameters, Field(max_length=2)] = Field(
        [],
        description="Parameter with one value per panel; or two, for the rows and columns of panels.",
    )
    median_over: Parameters = Field(
        [],
        alias="median over",
        description="Parameters over which a median is drawn, in a band.",
    )
    band: Annotated[
        list[Percentile] | Annotated[str, OneOf("all", "mean")],
        Field(title="two percentiles, all or mean"),
        AfterValidator(_check_band),
    ] = Field(
        [*PERCENTILES],
        description="Percentiles of the band; or all, from the smallest to the largest curve; or mean, the mean with "
        "its standard error instead of the median.",
    )
    behind: Names = Field(
        [],
        description="Studies whose curves, by the most accurate method, form a grey band behind those of the same D, "
        "gamma and m.",
    )

    @classmethod
    def rules(cls, values: Mapping[str, Any]) -> Iterator[Mistake]:
        """Yield a mistake for each parameter that is shown in two ways."""
        parts = [as_list(values.get(key, [])) for key in ("colour", "facet", "median over")]
        for name in set[str]().union(*(filter(lambda name: isinstance(name, str), part) for part in parts)):
            if sum(name in part for part in parts) > 1:
                yield Mistake((), f"{name} can be the colour, the facet or one to take the median over, not two")

    @property
    def _band(self) -> tuple[float, float]:
        if isinstance(self.band, str):
            return ALL if self.band == "all" else MEAN
        return self.band[0], self.band[1]

    def figure(self, interface: Bodies | None) -> Figure:
        """Return the figure, in SI units with an interface."""
        return Figure(
            draw=self.draw,
            studies=tuple(self.studies),
            title=self.title,
            grouping=Grouping(self.colour, tuple(self.facet), tuple(self.median_over), self._band),
            behind=tuple(self.behind),
            x=self.x.axis if self.x else FREE,
            y=self.y.axis if self.y else FREE,
            size=(self.size[0], self.size[1]) if self.size else None,
            interface=interface,
        )


def _check_tolerance(value: Any) -> Any:
    return checked_settings(auto.METHOD, {"tolerance": number("tolerance", value)})["tolerance"]


class SceneKeys(Part):
    """What to solve and what to draw: studies of profiles under one list of loads, and figures made from them."""

    model_config = ConfigDict(title="a scene")
    title: Annotated[Line, Field(min_length=1)] = Field(description="Subject of the scene, one line.")
    max_cases: Count = Field(MAX_CASES, description=f"Largest number of cases of the scene; {MAX_CASES} by default.")
    loads: LoadList = Field(
        description="Positive mean pressures in p_0*, in any order: a number, a range, or a list of these. With the "
        "key interface also in Pa, as {unit: MPa, from: 1, to: 100, count: 20} or [1 MPa, 10 MPa]: all cases then "
        "have these pressures, and the data are in SI units and this unit. Files have each load once, increasing."
    )
    methods: Methods = Field([], description="Methods for every case; `weier solve --help` lists them.")
    tolerance: Annotated[Number, AfterValidator(_check_tolerance)] = Field(
        ABSENT,
        description="Accepted error of the compliance, in g_0, for all methods that take one; for auto without any.",
    )
    max_seconds: Annotated[float, Field(gt=0)] = Field(
        ABSENT,
        description="Limit of the expected seconds of the solution, checked before it begins; none by default.",
    )
    settings: Settings = Field(
        {}, description="Settings of each method, as keywords of weier.solve: {bem: {points_per_wave: 16}}."
    )
    contact_edges: bool = Field(
        False, description="Keep the edges of all contacts, for figures that draw contact_tree."
    )
    interface: Annotated[InterfaceKeys, AfterValidator(InterfaceKeys.checked)] = Field(
        ABSENT,
        description="The two bodies and the scale of their roughness, as in weier.Interface, for loads in Pa and "
        "figures in SI units. Values may have units, as in 210 GPa.",
    )
    studies: Annotated[dict[Name, StudyKeys], Field(min_length=1)] = Field(
        description="Named sets of profiles: each a product of D, gamma, m and phases or seed, a list of cases, or a "
        "trace of measured heights, optionally with its own methods and settings. A profile of several studies is "
        "solved once."
    )
    figures: dict[Name, FigureKeys] = Field(
        {},
        description="Named figures: kind, studies, title, size, axes, the parameters shown by colour, facet and "
        "median over, and bands of ensembles.",
    )
    claims: dict[Name, Names] = Field(
        {},
        description="Statements of the paper to check: their names in weier.pipeline.claims, and their studies.",
    )

    @classmethod
    def rules(cls, values: Mapping[str, Any]) -> Iterator[Mistake]:
        """Yield mistakes in keys that go together, and in names of studies that the scene does not have."""
        if not values.keys() & {"methods", "tolerance"}:
            yield Mistake(("methods",), f"this key is missing: {cls.keys()['methods']}")
        studies, figures, claims, bodies = (
            value if isinstance(value := values.get(key), dict) else {}
            for key in ("studies", "figures", "claims", "interface")
        )
        scale = [name for name in ("g_0", "lambda_0") if name not in bodies]
        if bodies and scale and not all(isinstance(study, dict) and "trace" in study for study in studies.values()):
            yield Mistake(("interface",), f"{' and '.join(scale)} must be given, the scale of the series in m")
        lists: list[tuple[Keys, Any]] = [(("claims", name), listed) for name, listed in claims.items()]
        for name, figure in figures.items():
            if isinstance(figure, dict):
                lists += [(("figures", name, key), figure.get(key)) for key in ("studies", "behind")]
        for place, listed in lists:
            for position, study in enumerate(listed if isinstance(listed, list) else ()):
                if isinstance(study, str) and study not in studies:
                    what = f"there is no study {shown(study)}, only {', '.join(studies) or 'none':.300}"
                    yield Mistake((*place, position), f"{what}{suggestion(study, studies)}")


class SoundKeys(SceneKeys):
    """The keys of a scene without those that have mistakes: none is needed, and none needs another one."""

    title: Line = ""
    loads: LoadList = Field([])
    studies: dict[Name, StudyKeys] = Field({})

    @classmethod
    def rules(cls, values: Mapping[str, Any]) -> Iterator[Mistake]:
        """Yield nothing: the rules of the scene are about the whole file."""
        yield from ()
