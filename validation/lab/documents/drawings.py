"""List the documents' images: the function that draws each, its shaders and its inputs."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bokeh_validation import locks, paths, pictures, shaders, truth
from bokeh_validation.drivers.base import Driver
from bokeh_validation.truth import ray_traced
from lab import other_effects
from lab.documents import chart, figures, frame_graph, gallery, likeness
from lab.other_effects.effects import EFFECTS
from lab.rasterised import motion, motion_maps, random_score


class Animation(NamedTuple):
    """Hold 8-bit rgb frames, milliseconds per frame, and the quality of the WebP."""

    frames: list[np.ndarray]
    milliseconds: int
    quality: int


# Name -> image; a text is an SVG
Drawn = dict[str, np.ndarray | Animation | str]


@dataclass(frozen=True)
class Drawing:
    """Describe images that one function draws.

    names   of their files, without suffix
    draw    driver -> name -> image. Raises Unavailable if this machine lacks something that it needs
    stems   shader files that it draws with
    inputs  files that it reads
    folder  below the repository's root
    """

    names: tuple[str, ...]
    draw: Callable[[Driver], Drawn]
    stems: tuple[str, ...]
    inputs: tuple[Path, ...] = ()
    folder: str = "docs/images"

    def digest(self) -> str:
        """Return a hash of the shaders' text, without comments, and of the inputs, which changes if any of these do."""
        # the languages are known to be equivalent, and comments draw nothing
        texts = [shaders.COMMENT.sub("", shaders.file_text("glsl", stem)) for stem in self.stems]
        return locks.digest([*(" ".join(text.split()) for text in texts), *self.inputs])


PAPER, LAYERED = ("bokeh", "bokeh_paper", "bokeh_passes"), ("bokeh", "bokeh_layers", "bokeh_passes")
ALL = ("bokeh", "bokeh_paper", "bokeh_layers", "bokeh_lens", "bokeh_passes")
MARKET, CANOPY = ray_traced.MARKET, ray_traced.CANOPY
# Seeds of the random scenes in docs/results.md
SEEDS = range(80)


def cats_eye(driver: Driver) -> Drawn:
    """Draw the cat's eye for which docs/methods/character.md gives a command."""
    image = truth.picture(driver, MARKET, "layered ultra", "octagon", cats_eye=0.6)
    return {"character_cats_eye": pictures.display(image, tone_map=True)}


def worst(driver: Driver) -> Drawn:
    """Draw the parts of the random scenes in which layered medium is worst."""
    return {"random_worst": random_score.sheet(random_score.by_processes(["layered medium"], driver.name, None, SEEDS))}


def pan(driver: Driver) -> Drawn:
    """Draw a pan by two methods next to the truth."""
    _, frames = motion.measured("pan", list(motion.SHOWN), driver.name)
    return {"motion_pan": Animation(frames, motion.MILLISECONDS, motion.QUALITY)}


def pan_maps(driver: Driver) -> Drawn:
    """Draw where the error varies in the pan, for docs/methods/layered-evidence.md."""
    return {"motion_maps": motion_maps.sheet(driver)}


def focus_pull(driver: Driver) -> Drawn:
    """Draw the README's first image."""
    return {"focus_pull": Animation(gallery.pull(driver), gallery.PULL_MILLISECONDS, gallery.PULL_QUALITY)}


def graph(_: Driver) -> Drawn:
    """Draw the passes and textures of `layered` for docs/methods/layered.md."""
    return {"frame_graph": frame_graph.draw()}


def flip_by_method(_: Driver) -> Drawn:
    """Draw the chart of docs/results.md."""
    return {"flip_by_method": chart.draw()}


def others(_: Driver, name: str) -> Drawn:
    """Draw other effects next to this package's methods in Chromium, all on the same device."""
    return {f"peers_{name}": other_effects.of_scene(name, list(EFFECTS), anew=False)[1]}


def files_of(scene: ray_traced.SceneFile) -> tuple[Path, ...]:
    """Return the pinhole image of a scene and its truth."""
    return scene.source, paths.SCENES / f"{scene.name}_hex.exr"


def _figure(draw: Callable[[Driver], Drawn], *names: str, stems: Iterable[str] = PAPER, **others) -> Drawing:
    return Drawing(tuple(f"figure_{name}" for name in names), draw, tuple(stems), **others, folder="docs/reproduction")


DRAWINGS = (
    Drawing(("focus_pull",), focus_pull, LAYERED, (MARKET.source,)),
    *(
        Drawing((name,), partial(gallery.gallery, name=name), ALL, gallery.sources(name))
        for name in gallery.PICTURES
    ),
    # a test compares these two with the data that they are drawn from
    Drawing(("frame_graph",), graph, ()),
    Drawing(("flip_by_method",), flip_by_method, ()),
    Drawing(("lights_apart",), gallery.apart, ALL),
    Drawing(("opacity",), gallery.opacity, LAYERED, (MARKET.source,)),
    Drawing(("icon",), gallery.icon, LAYERED, (MARKET.source,)),
    Drawing(("character_cats_eye",), cats_eye, ALL, (MARKET.source,)),
    *(
        Drawing(tuple(likeness.names(scene)), partial(likeness.likeness, scene=scene), ALL, files_of(scene))
        for scene in (*ray_traced.SCENES, ray_traced.WINTER)
    ),
    Drawing(("random_worst",), worst, LAYERED),
    Drawing(("motion_pan",), pan, LAYERED),
    Drawing(("motion_maps",), pan_maps, LAYERED),
    *(
        Drawing((f"peers_{scene.name}",), partial(others, name=scene.name), ALL, files_of(scene))
        for scene in ray_traced.SCENES
    ),
    _figure(figures.photographs, *(f"01_{letter}" for letter in figures.VIEWS)),
    _figure(figures.coc_blur, "07", inputs=(CANOPY.source,)),
    _figure(figures.canopy, "11", "11_own", "11_wide", inputs=files_of(CANOPY)),
    _figure(figures.apertures_of_points, "09", "12"),
    _figure(figures.two_under_max, "13"),
)  # fmt: skip
BY_NAME = {name: drawing for drawing in DRAWINGS for name in drawing.names}
