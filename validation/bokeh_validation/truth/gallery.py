"""Pictures of the documents on market_7, shapes, focus and colour: the work behind `validation/run gallery`."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from PIL import Image

from bokeh_validation import pictures, terminal
from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import UserError
from bokeh_validation.figures import panels
from bokeh_validation.truth import suite

# caption -> method, aperture, other settings
SHAPES = {
    "square": ("layered", "square", {}),
    "hexagon": ("layered", "hexagon", {}),
    "octagon": ("layered", "octagon", {}),
    "decagon": ("layered", "decagon", {}),
    "star (paper, 33 samples a line)": ("paper", "star", {"samples": 33}),
    "anamorphic: hexagon, squeeze 0.5": ("layered", "hexagon", {"squeeze": 0.5}),
}
# left, top, width, height: far lights on the left, near ones among leaves on the right
DETAIL = (626, 20, 320, 258)
# metres -> caption, exposure
FOCUS = {1.0: ("near: focus on the leaves, 1 m", 1.1), 8.0: ("far: focus on the street, 8 m", 2.2)}

# left, top, width, height: towards a corner, for lateral colour; lights in the middle, for axial colour
CORNER, MIDDLE = (660, 0, 300, 180), (330, 0, 300, 180)
LATERAL = {"no lateral colour": 0.0, "lateral colour, 0.01": 0.01}
# where all lights are LIGHTS metres away: words of the caption -> camera, more signed CoC of red and of blue
LIGHTS = 8.0
SIDES = {
    "far": suite.MARKET.camera,
    "near": replace(suite.MARKET.camera, aperture_diameter=0.17, focus_distance=1000.0),
}
AXIAL = {"plain lens": (-0.005, 0.011), "achromat": (-0.008, -0.008)}


def drawn(
    driver: Driver, method: str, aperture: str, exposure: float = 1.6, metres: float | None = None, **changes
) -> np.ndarray:
    """market_7 as a display shows it, 8-bit rgb; with `metres`, as if all of it were so far away."""
    case = suite.scene_case(suite.MARKET, method, aperture)
    depth = case.depth if metres is None else np.full_like(case.depth, metres)
    case = replace(case, depth=depth, settings=replace(case.settings, **changes))
    return pictures.filmic(driver.run(case.plan.passes, case.textures(), case.size)["result"], exposure)


def shapes(driver: Driver) -> np.ndarray:
    """A detail by every aperture, 8-bit rgb."""
    found = [
        panels.Panel(panels.crop(drawn(driver, method, aperture, **changes), *DETAIL), caption)
        for caption, (method, aperture, changes) in SHAPES.items()
    ]
    return panels.grid([found[:3], found[3:]])


def focus(driver: Driver) -> np.ndarray:
    """The picture at half size, focused near and far, 8-bit rgb."""
    found = []
    for metres, (caption, exposure) in FOCUS.items():
        camera = replace(suite.MARKET.camera, focus_distance=metres)
        whole = drawn(driver, "layered", "hexagon", exposure, camera=camera)
        found.append(panels.Panel(np.asarray(Image.fromarray(whole).reduce(2)), caption))
    return panels.grid([found])


def color(driver: Driver) -> np.ndarray:
    """Chromatic aberration: lateral in a corner, axial of lights behind the focus and in front of it, 8-bit rgb."""
    rows = []
    for (caption, amount), (side, camera) in zip(LATERAL.items(), SIDES.items(), strict=True):
        corner = drawn(driver, "layered", "octagon", lateral=amount, preset="ultra")
        row = [panels.Panel(panels.crop(corner, *CORNER), caption)]
        for lens, axial in AXIAL.items():
            settings = {"camera": camera, "axial": axial, "spacing": 1.0, "max_samples": 65}
            lights = drawn(driver, "exact", "octagon", 1.0, LIGHTS, **settings)
            row.append(panels.Panel(panels.crop(lights, *MIDDLE), f"axial colour, {lens}: {side} lights"))
        rows.append(row)
    return panels.grid(rows)


PICTURES = {"gallery_shapes.png": shapes, "gallery_focus.png": focus, "character_color.png": color}


def gallery(
    folder: Annotated[Path, typer.Option("-o", "--output", metavar="FOLDER", help="Where the pictures go.")],
    driver: terminal.OneDriver = None,
    adapter: terminal.Adapter = None,
) -> None:
    """Draw the documents' gallery: every aperture, focus near and far, and chromatic aberration."""
    if not folder.is_dir():
        raise UserError(f"--output {folder}: there is no such folder. Make it first.")
    used = terminal.pick_driver(driver, adapter)
    for name, make in PICTURES.items():
        pictures.write_png(folder / name, pictures.coarse(make(used)))
        terminal.console.print(f"{folder / name}, by {used.name} ({used.adapter})")
