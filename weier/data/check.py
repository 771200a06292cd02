"""Whether something is as it should be: a claim of the paper, a curve at the extremes."""

from __future__ import annotations

from enum import IntEnum


class Check(IntEnum):
    """The flags of a file, and their names in its attributes.

    not_measured : the data lack what is needed
    not_decided : the data have it, and leave the question open
    """

    no = 0
    yes = 1
    not_measured = 2
    not_decided = 3

    @classmethod
    def of(cls, holds: bool | None) -> Check:
        """The check of what holds, does not, or could not be measured (None)."""
        return cls.not_measured if holds is None else cls(holds)

    @property
    def text(self) -> str:
        """In words for people."""
        return self.name.replace("_", " ")
