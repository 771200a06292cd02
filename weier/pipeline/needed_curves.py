"""The curves that the cases of a scene need, each with its kind and its key.

A curve is a surface, a method with all settings, loads, and the numerics of the code. Curves of one *kind* have all
but the surface in common. The key of a curve within its kind is that of its surface, without phases where the method
has none, so that scenes share curves, and the profiles of an ensemble share those without phases.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from weier.api.task import CurveTask
from weier.digests import DIGITS, digest
from weier.kernels.arrays import Array, Flags, Indices
from weier.methods.method import CURVE_SECONDS
from weier.methods.registry import find_method
from weier.methods.settings import all_settings
from weier.scene.cases import Scene
from weier.scene.identity import Keys, distinct
from weier.scene.study import CaseProduct
from weier.theory.conduction import full_contact_pressure

if TYPE_CHECKING:
    from weier.pipeline.store import Store

SURFACE = "surface"  # stands for the method in rows that describe a surface


@dataclass(frozen=True)
class Kind:
    """The settings that curves of one kind share.

    method, settings : the method with all its settings, or SURFACE
    loads : mean pressures in p_0*, or in Pa with `modulus`
    contact_edges : whether the edges of contacts are kept
    modulus : composite modulus in Pa, which converts the loads of a trace to p_0*
    """

    method: str
    settings: Mapping[str, Any]
    loads: Sequence[float]
    contact_edges: bool = False
    modulus: float | None = None

    @cached_property
    def name(self) -> str:
        """The name of its folder."""
        return f"{self.method}-{digest(asdict(self))[:DIGITS]}"

    def curve_of(self, surface: Any) -> CurveTask:
        """Return the curve of a surface, with its loads in p_0*."""
        loads = np.array(self.loads)
        if self.modulus is not None:
            loads /= full_contact_pressure(self.modulus, surface.lambda_0, surface.g_0)
        return CurveTask(surface, self.method, self.settings, loads)


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
    """Curves of one kind for cases of a product.

    cases, positions : numbers of the cases in the scene, and their positions in the product
    """

    kind: Kind
    product: CaseProduct
    cases: Indices
    positions: Indices

    def only(self, rows: Indices | Flags) -> Part:
        """Return the part with some of its curves."""
        return Part(self.kind, self.product, self.cases[rows], self.positions[rows])

    @cached_property
    def keys(self) -> Keys:
        """The key of each curve within its kind."""
        uses_phases = self.kind.method == SURFACE or find_method(self.kind.method).uses_phases
        return (self.product.surface_keys if uses_phases else self.product.keys_without_phases)[self.positions]

    @cached_property
    def seconds(self) -> Array:
        """The expected seconds of each curve on one core, which hardly depend on phases."""
        if self.kind.method == SURFACE:
            return np.full(len(self.positions), CURVE_SECONDS)
        first, number = distinct(self.product.keys_without_phases[self.positions])
        cases = map(self.product.case, self.positions[first].tolist())
        return np.array([self.kind.curve_of(case.profile).expected for case in cases])[number]


def each_once(parts: Iterable[Part]) -> list[Part]:
    """Return the parts reduced so that each curve is in the first one that has it."""
    found, known = list[Part](), dict[str, Keys]()
    for part in parts:
        earlier = known.get(part.kind.name, part.keys[:0])
        first, _ = distinct(part.keys)
        found.append(part.only(first[~np.isin(part.keys[first], earlier)]))
        known[part.kind.name] = np.concatenate([earlier, found[-1].keys])
    return found


def share(wanted: Iterable[Part], number: int, count: int) -> list[Part]:
    """Return the share of job `number` of `count` of wanted curves, whichever of them are solved.

    They are dealt to the jobs in turn, from the longest one to the shortest. Equally long ones come in the order of
    their keys, as good as random: in the order of cases, all of a new seed might meet the same job.
    """
    parts = each_once(wanted)
    keys = np.concatenate([part.keys for part in parts])
    seconds = np.round(np.concatenate([part.seconds for part in parts]), 6)  # last bits differ between processors
    own = np.zeros(seconds.size, bool)
    own[np.lexsort((keys, -seconds))[number::count]] = True
    ends = np.cumsum([len(part.keys) for part in parts])
    return [part.only(mine) for part, mine in zip(parts, np.split(own, ends[:-1]), strict=True)]


class Curves:
    """The curves of a scene, and the store that has the solved ones.

    parts : by product and method, in their order
    surfaces : what describes the surfaces, by product
    """

    def __init__(self, scene: Scene, store: Store) -> None:
        self.scene, self.store = scene, store
        self.parts, self.surfaces = list[Part](), list[Part]()
        for number, product in enumerate(scene.products):
            cases = np.flatnonzero(scene.product_of_cases == number)
            if cases.size:
                own = product, cases, scene.position_in_product[cases]
                self.surfaces.append(Part(Kind(SURFACE, {"trace": "trace" in product.axes}, ()), *own))
                self.parts += [Part(kind_of(product, method, scene), *own) for method in product.methods]

    def parts_for(self, studies: Collection[str] | None = None) -> list[Part]:
        """Return the parts that these studies need, or all parts; surfaces come first."""
        wanted = np.full(self.scene.count, studies is None)
        for study in studies or ():
            wanted[self.scene.cases_of_study(study)] = True
        parts = [part.only(wanted[part.cases]) for part in (*self.surfaces, *self.parts)]
        return [part for part in parts if part.cases.size]
