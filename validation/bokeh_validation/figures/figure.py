"""What a figure is: pictures, the HDR images behind them, and numbers."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bokeh_validation.drivers.base import Driver
from bokeh_validation.probes.model import Case


class Table(NamedTuple):
    """Numbers of a figure, as docs/reproduction.md has them.

    columns  of the numbers; the first column, of the rows' names, has no name
    rows     (name, values); None where there is no such number
    digits   behind the point, one for each column
    """

    columns: tuple[str, ...]
    rows: Sequence[tuple[str, tuple[float | None, ...]]]
    digits: tuple[int, ...]

    def markdown(self) -> list[str]:
        """Lines of a table."""
        lines = [f"| | {' | '.join(self.columns)} |", "|" + "---|" * (1 + len(self.columns))]
        for name, values in self.rows:
            # + 0.0: no minus before a zero
            pairs = zip(values, self.digits, strict=True)
            cells = ["-" if value is None else f"{round(value, n) + 0.0:.{n}f}" for value, n in pairs]
            lines.append(f"| {name} | {' | '.join(cells)} |")
        return lines

    def as_json(self) -> dict:
        """The numbers, not rounded."""
        rows = {name: list(values) for name, values in self.rows}
        return {"columns": list(self.columns), "digits": list(self.digits), "rows": rows}


class Made(NamedTuple):
    """A finished figure.

    pictures  name -> 8-bit rgb (H, W, 3)
    images    name -> linear HDR (H, W, 4) as a driver gave it, half floats
    tables    its numbers
    """

    pictures: dict[str, np.ndarray]
    images: dict[str, np.ndarray]
    tables: tuple[Table, ...] = ()


def drawn(driver: Driver, case: Case) -> np.ndarray:
    """The result, (H, W, 4)."""
    return driver.run(case.plan.passes, case.textures(), case.size)["result"]


def named(beginning: str, images: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The images by the names of their files."""
    return {f"{beginning}_{name}": image for name, image in images.items()}
