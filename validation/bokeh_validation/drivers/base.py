"""The one interface of all drivers: passes and textures in, textures out."""

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bokeh_validation.errors import Unavailable
from bokeh_validation.passes import Pass, target_area, target_size
from bokeh_validation.reference import images, precision

Textures = Mapping[str, np.ndarray]

# Parts of the names of devices that are programs on this machine's cores -> whose they are
SOFTWARE = {"llvmpipe": "Mesa", "softpipe": "Mesa", "swiftshader": "SwiftShader", "microsoft basic render": "WARP"}


def software_device(adapter: str) -> str:
    """'Mesa', 'SwiftShader' or 'WARP' where a device is a program of theirs; '' for a GPU."""
    return next((owner for part, owner in SOFTWARE.items() if part in adapter.lower()), "")


def precision_of(adapter: str) -> precision.Precision:
    """What the reference has to allow a device."""
    known = {"Mesa": precision.SOFTWARE, "SwiftShader": precision.SWIFTSHADER}
    return known.get(software_device(adapter), precision.GPU)


@dataclass(frozen=True)
class Timing:
    """How long a job took, seconds, each for one draw of all its passes.

    wall   of the clock, from the first command to the device's being done
    cpu    of this process on all cores meanwhile: what a software driver costs, whatever else the machine does
    query  of the device's own timer; None where it has none
    """

    wall: float
    cpu: float
    query: float | None


class Stopwatch:
    """Wall and CPU time from its making."""

    def __init__(self) -> None:
        self.wall, self.cpu = time.perf_counter(), time.process_time()

    def timing(self, repeats: int) -> Timing:
        """What passed since, for each of the repeats, without a query."""
        wall, cpu = time.perf_counter() - self.wall, time.process_time() - self.cpu
        return Timing(wall / repeats, cpu / repeats, None)


class Job:
    """Passes with their textures and targets on a device, to be drawn many times.

    A subclass has `driver` with upload() and target(), and says what a texture is like: shape_of().
    """

    def __init__(self, driver: "TimedDriver", storage: str, share: "Job | None"):
        self.driver, self.storage, self.share = driver, storage, share
        self.live = dict(share.live) if share else {}
        self.made = []

    def upload(self, textures: Textures) -> None:
        """All textures that no other job has."""
        for name in set(textures) - set(self.live):
            self.live[name] = self._made(self.driver.upload(textures[name]))

    def targets(self, item: Pass, kept: frozenset[str], size: tuple[int, int]) -> list:
        """A target for each output of a pass: what is drawn over, what another job has, or a new one."""
        found, wanted = [], target_size(item.scale, size)
        for name in item.outputs:
            target = self.live[name] if name in kept else self.share.live.get(name) if self.share else None
            if target is None or self.shape_of(target) != (wanted, item.channels):
                target = self._made(self.driver.target(wanted, self.storage, item.channels))
            found.append(target)
        return found

    def _made(self, texture):
        self.made.append(texture)
        return texture

    def shape_of(self, texture) -> tuple[tuple[int, int], int]:
        """((width, height), channels)."""
        raise NotImplementedError

    def draw(self) -> None:
        """Give the passes to the device once; does not wait."""
        raise NotImplementedError

    def timed(self, repeats: int) -> Timing:
        """Draw `repeats` times without a pause and wait for the end."""
        raise NotImplementedError

    def pixels(self, texture) -> np.ndarray:
        """What is in a texture, of any shape."""
        raise NotImplementedError

    def read(self, name: str) -> np.ndarray:
        """A target after the last draw, (H, W, 4) of its own size; see four_channels()."""
        (width, height), channels = self.shape_of(self.live[name])
        return four_channels(self.pixels(self.live[name]).reshape(height, width, channels))

    def release(self) -> None:
        """Free the textures and targets."""
        raise NotImplementedError


class Driver:
    """A real runtime, or the reference.

    name      what --driver takes
    adapter   the device behind it, as the runtime names it
    software  True where the texture unit is Mesa's software one: exact float32 filtering
    """

    name: str
    adapter: str
    software: bool

    @cached_property
    def rounding(self) -> str:
        """How its half-float targets round, 'nearest' or 'zero': measured, see half_rounding()."""
        return half_rounding(self)

    def run(
        self,
        passes: Sequence[Pass],
        textures: Textures,
        size: tuple[int, int],
        storage: str = "half",
        keep: Iterable[str] = ("result",),
    ) -> dict[str, np.ndarray]:
        """Run the passes in order and return the textures named in `keep`.

        textures  (H, W, 4) float16 or float32, or (H, W) float32 for depth
        size      (width, height) of every target of scale 1
        storage   'half' or 'float': format of the targets between and after the passes
        returns   name -> (H, W, 4) of the target's size, float16 or float32 by `storage`; where it has two channels,
                  the others are 0 and 1

        A pass with a viewport draws nothing outside of it; uv runs 0 .. 1 over it. What an earlier pass has left in its
        targets stays around it; a target that no earlier pass has made is 0 there, also where a texture of that name
        was handed in.

        Raises ValueError as drawn_over() does.
        """
        raise NotImplementedError


class TimedDriver(Driver):
    """A driver that can draw without upload and read-back: osmesa, egl, wgpu, dxc."""

    def prepared(
        self,
        passes: Sequence[Pass],
        textures: Textures,
        size: tuple[int, int],
        storage: str = "half",
        share: Job | None = None,
    ) -> Job:
        """What `run` would draw, uploaded and compiled.

        share  a job of the same size and storage: textures and targets of a name that it has are used again, not
               uploaded and not made; a target only if it has the same size and channels. It is to be released last.

        Raises Unavailable as `run` does.
        """
        raise NotImplementedError

    def upload(self, pixels: np.ndarray):
        """Pixels as a texture; row 0 becomes the first row in memory, v = 0."""
        raise NotImplementedError

    def target(self, size: tuple[int, int], storage: str, channels: int = 4):
        """A render target that can be sampled and read back: RGBA, or RG with two channels."""
        raise NotImplementedError

    def run(self, passes, textures, size, storage="half", keep=("result",)) -> dict[str, np.ndarray]:
        """See Driver."""
        job = self.prepared(passes, textures, size, storage)
        try:
            job.draw()
            return {name: job.read(name) for name in keep}
        finally:
            job.release()


def storage_type(storage: str) -> type:
    """NumPy type of a storage name."""
    return {"half": np.float16, "float": np.float32}[storage]


def four_channels(pixels: np.ndarray) -> np.ndarray:
    """A target of (H, W, 2) or (H, W, 4) as (H, W, 4), a copy: with two channels, blue is 0 and alpha 1."""
    result = np.zeros((*pixels.shape[:2], 4), pixels.dtype)
    result[..., 3] = 1
    result[..., : pixels.shape[2]] = pixels
    return result


def drawn_over(passes: Sequence[Pass], size: tuple[int, int]) -> list[frozenset[str]]:
    """For each pass the names of those outputs that an earlier pass has made and that it draws over.

    size  (width, height) of every target of scale 1

    Raises ValueError where a pass reads what it draws over, or draws over a target of another scale or other channels,
    and for a viewport that is not within the targets or begins within a texel of them.
    """
    made: dict[str, tuple[int, int]] = {}
    found = []
    for item in passes:
        over = frozenset(set(made).intersection(item.outputs)) if item.viewport else frozenset()
        if item.viewport:
            x, y, width, height = item.viewport
            if min(x, y) < 0 or min(width, height) < 1 or x + width > size[0] or y + height > size[1]:
                raise ValueError(f"{item.entry}: viewport {item.viewport} is not within {size[0]} x {size[1]}")
            target_area(item.scale, item.viewport)
        for name in over.intersection(item.inputs.values()):
            raise ValueError(f"{item.entry} reads {name!r} and draws over it: give its output another name")
        kind = (item.scale, item.channels)
        for name in over:
            if made[name] != kind:
                raise ValueError(
                    f"{item.entry} has scale {item.scale} and {item.channels} channels, and draws over {name!r}, which "
                    f"has scale {made[name][0]} and {made[name][1]} channels"
                )
        found.append(over)
        made.update(dict.fromkeys(item.outputs, kind))
    return found


def require_targets(driver: "Driver", passes: Sequence[Pass], storage: str, limit: float) -> None:
    """Raise Unavailable where all targets of a pass together have more bytes a pixel than the device's `limit`."""
    channel = np.dtype(storage_type(storage)).itemsize
    for item in passes:
        needed = channel * item.channels * len(item.outputs)
        if needed > limit:
            raise Unavailable(f"{driver.adapter} writes {limit} bytes a pixel at once; {item.entry} needs {needed}")


def half_rounding(driver: "Driver") -> str:
    """How a driver's half-float targets round what a shader writes: 'nearest', or 'zero' for cutting off.

    Found by storing constants that lie between two half floats in the alpha of the first pass. OpenGL, Vulkan and
    Direct3D leave it open; a step in the stored CoC moves every later sample, so the reference has to store as the
    device does.
    """
    # quarters of a step above half floats of several sizes, exact in float32
    constants = np.array([base * (1 + k * 2.0**-12) for base in (0.5, 0.0625, 0.3125) for k in (1, 3)])
    passes = [
        Pass("BokehConstantCoC", {"ColorSamp": "color"}, f"{i}", {"BokehConstantCoC": float(c), "BokehMaxCoC": 1.0})
        for i, c in enumerate(constants)
    ]
    names = [name for item in passes for name in item.outputs]
    outputs = driver.run(passes, {"color": np.ones((1, 1, 4), np.float16)}, (1, 1), keep=names)
    seen = np.array([outputs[name][0, 0, 3] for name in names])
    for rounding in ("nearest", "zero"):
        if np.array_equal(seen, images.rounded(constants, np.float16, rounding)):
            return rounding
    raise RuntimeError(f"{driver.name}: half-float targets neither round to nearest nor cut off")
