"""A plan: the document of the command, and its schedule as columns."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ._document import Document

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Plan(Document):
    """A plan, ``centrical-plan/1``: value, bound, mountings, prediction."""

    @property
    def schedule(self) -> dict[str, NDArray[np.generic]]:
        """The visits in their order, as columns: what ``pandas.DataFrame`` and ``polars.DataFrame`` take.

        ``mounting`` from 1, ``position``, ``radius`` [m], ``speed`` [rad/s], ``angle`` [rad], ``duration`` [s].
        """
        visits = [(n, mounting, visit) for n, mounting in enumerate(self.mountings, 1) for visit in mounting.plateaus]
        return {
            "mounting": np.array([n for n, _, _ in visits], dtype=np.int64),
            "position": np.array([mounting.position for _, mounting, _ in visits], dtype=np.str_),
            "radius": np.array([mounting.radius for _, mounting, _ in visits], dtype=np.float64),
            "speed": np.array([visit.speed for _, _, visit in visits], dtype=np.float64),
            "angle": np.array([visit.angle for _, _, visit in visits], dtype=np.float64),
            "duration": np.array([visit.duration for _, _, visit in visits], dtype=np.float64),
        }
