"""The curves that the cases of a scene need, each with its kind and its key.

A curve is a surface, a method with all settings, loads, and the numerics of the code. Curves of one *kind* have all
but the surface in common. The key of a curve within its kind is that of its surface, without phases where the method
has none, so that scenes share curves, and the profiles of an ensemble share those without phases.
"""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from weier.digests import DIGITS, digest
from weier.kernels.arrays import Array, Flags, Indices
from weier.methods.method import CURVE_SECONDS
from weier.methods.registry import find_method, methods_run_by
from weier.methods.settings import all_settings
from weier.scene.case import Case
from weier.scene.cases import Scene
from weier.scene.identity import Keys, digest_of_keys, key_of
from weier.scene.study import SEEDS, CaseProduct
from weier.theory.conduction import full_contact_pressure

if TYPE_CHECKING:
    from weier.pipeline.store import Store
    from weier.surface.measured.trace import Trace
    from weier.surface.waves import Waves

SURFACE = "surface"  # in place of a method: what describes a surface itself
CLOSED = "closed_form"  # group of the methods that need no compiled kernels of their own


class Kind(NamedTuple):
    """What curves have in common.

    method, settings : the method with all its settings, or SURFACE
    loads : in p_0*, or in Pa with `modulus`
    contact_edges : whether the edges of contacts are kept
    modulus : composite modulus in Pa, from which a trace has its loads in p_0*
    """

    method: str
    settings: Mapping[str, Any]
    loads: Sequence[float]
    contact_edges: bool = False
    modulus: float | None = None

    @property
    def name(self) -> str:
        """The name of its folder."""
        return f"{self.method}-{digest(self._asdict())[:DIGITS]}"

    @property
    def group(self) -> str:
        """The compiled method whose kernels it needs, or CLOSED."""
        if self.method == SURFACE or not any(method.numerical for method in methods_run_by(self.method)):
            return CLOSED
        return self.method

    @property
    def uses_phases(self) -> bool:
        """Whether its curves depend on phases."""
        return self.method == SURFACE or find_method(self.method).uses_phases

    def loads_for(self, surface: Waves) -> Array:
        """Return the loads of a surface in p_0*."""
        loads = np.array(self.loads)
        if self.modulus is None:
            return loads
        trace = cast("Trace", surface)
        return loads / full_contact_pressure(self.modulus, trace.lambda_0, trace.g_0)


def kind_of(product: CaseProduct, method: str, scene: Scene) -> Kind:
    """Return the kind of the curves of a product by one of its methods.

    A series has its loads in p_0*, so that scenes with other bodies share its curves.
    """
    settings = dict(sorted(all_settings(find_method(method), product.settings.get(method, {})).items()))
    loads, modulus = product.loads, None
    if scene.in_si and (bodies := scene.interface):
        is_trace = "trace" in product.axes
        loads = loads if is_trace else bodies.normalised_pressure(loads)
        modulus = bodies.composite_modulus if is_trace else None
    return Kind(method, settings, loads.tolist(), scene.contact_edges, modulus)


@dataclass(frozen=True)
class Part:
    """The curves of one kind for the cases of a product.

    first : number of its first case in the scene; the others follow
    positions : of its cases in the product
    """

    kind: Kind
    product: CaseProduct
    first: int
    positions: Indices

    @property
    def cases(self) -> slice:
        """The numbers of its cases in the scene."""
        return slice(self.first, self.first + len(self.positions))

    @cached_property
    def keys(self) -> Keys:
        """The key of each curve within its kind."""
        own = self.product.surface_keys if self.kind.uses_phases else self.product.keys_without_phases
        return own[self.positions]

    def case(self, number: int) -> Case:
        """Return one of its cases."""
        return self.product.case(int(self.positions[number]))

    def seconds(self) -> Array:
        """Return the expected seconds of each curve, which hardly depend on phases."""
        if self.kind.method == SURFACE:
            return np.full(len(self.positions), CURVE_SECONDS)
        shape = [len(values) for values in self.product.axes.values()]
        costs = np.zeros([1 if name in SEEDS else len(values) for name, values in self.product.axes.items()])
        for place in np.ndindex(costs.shape):
            case = self.product.case(int(np.ravel_multi_index(place, shape)))
            costs[place] = case.seconds(self.kind.method, self.kind.loads_for(case.profile))
        return np.broadcast_to(costs, shape).ravel()[self.positions]


class Curves:
    """The curves of a scene, and the store that has the solved ones.

    Attributes
    ----------
    parts : list of Part
        By product and method, in their order.
    surfaces : list of Part
        What describes the surfaces, by product.
    """

    def __init__(self, scene: Scene, store: Store) -> None:
        self.scene, self.store = scene, store
        self.parts, self.surfaces = list[Part](), list[Part]()
        starts = np.searchsorted(scene.product_of_cases, np.arange(len(scene.products) + 1))
        for product, start, end in zip(scene.products, starts.tolist(), starts[1:].tolist(), strict=False):
            if end > start:
                own = product, start, scene.position_in_product[start:end]
                self.surfaces.append(Part(Kind(SURFACE, {"trace": "trace" in product.axes}, ()), *own))
                self.parts += [Part(kind_of(product, method, scene), *own) for method in product.methods]

    def of_studies(self, studies: Collection[str] | None) -> list[tuple[Part, Indices]]:
        """Return the parts, surfaces first, that these studies need, or all, with the numbers of those curves."""
        wanted = self._cases_of(studies)
        found = [(part, np.flatnonzero(wanted[part.cases])) for part in (*self.surfaces, *self.parts)]
        return [(part, numbers) for part, numbers in found if numbers.size]

    def digest(self, studies: Collection[str] | None = None) -> str:
        """Return a digest of the curves of these studies, or of all, in the order of their cases."""
        return digest(
            [[part.kind.name, digest_of_keys(part.keys[numbers])] for part, numbers in self.of_studies(studies)]
        )

    def _cases_of(self, studies: Collection[str] | None) -> Flags:
        wanted = np.full(len(self.scene.distinct), studies is None)
        for study in studies or ():
            wanted[self.scene.cases_of_study(study)] = True
        return wanted


@dataclass(frozen=True)
class Lacking:
    """Curves of a part that no segment of the store has, by their numbers in the part."""

    part: Part
    numbers: Indices

    @cached_property
    def keys(self) -> Keys:
        """The key of each of them."""
        return self.part.keys[self.numbers]

    @cached_property
    def spread(self) -> Keys:
        """A number for each of them by which jobs share them: independent of the others and of their order."""
        return self.keys + key_of(self.part.kind.name)

    @property
    def seconds(self) -> float:
        """The expected seconds of all on one core."""
        return float(self.part.seconds()[self.numbers].sum())

    def of_job(self, number: int, count: int) -> Lacking:
        """Return those of one of several jobs."""
        return Lacking(self.part, self.numbers[self.spread % np.uint64(count) == number])


def by_group(lacking: Iterable[Lacking]) -> dict[str, list[Lacking]]:
    """Return missing curves by the kernels that they need."""
    found: dict[str, list[Lacking]] = {}
    for each in lacking:
        found.setdefault(each.part.kind.group, []).append(each)
    return found


def number_of_jobs(seconds: float, curves: int, most: int) -> int:
    """Return the number of jobs among which curves of one group are shared."""
    return max(1, min(most, curves, math.ceil(seconds / JOB_SECONDS)))


# arbitrary within a factor of two, since curves do not depend on the jobs that solve them: starting a job takes 1 s
JOB_SECONDS = 10.0


def described(kind: Kind) -> str:
    """Return a kind as text, for the file that says what the segments beside it hold."""
    return json.dumps(kind._asdict(), indent=1, sort_keys=True) + "\n"
