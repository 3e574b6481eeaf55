"""The float64 reference as a driver: the same passes, the formulas instead of a device."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from bokeh_validation import apertures
from bokeh_validation.drivers.base import Textures, storage_type
from bokeh_validation.passes import Pass
from bokeh_validation.reference import listings
from bokeh_validation.reference.listings import Image
from bokeh_validation.reference.precision import Precision


class Reference:
    """NumPy, float64, rounded to the targets' format between passes. No language, no device."""

    name = "reference"
    adapter = "NumPy float64"
    software = True
    rounding = "nearest"

    def __init__(self, adapter: str | None = None):
        del adapter

    def run(
        self,
        passes: Sequence[Pass],
        textures: Textures,
        size: tuple[int, int],
        storage: str = "half",
        keep: Iterable[str] = ("result",),
    ) -> dict[str, np.ndarray]:
        """See drivers.base.Driver.run."""
        images = self.images(passes, textures, size, storage)
        return {name: images[name].value.astype(storage_type(storage)) for name in keep}

    def images(
        self,
        passes: Sequence[Pass],
        textures: Textures,
        size: tuple[int, int],
        storage: str = "half",
        precision: Precision | None = None,
        rounding: str = "nearest",
    ) -> dict[str, Image]:
        """Every pass's output in float64; with `precision`, each with its acceptance interval.

        rounding  how the targets round, see listings.stored
        """
        dtype = storage_type(storage)
        live: dict[str, Image] = {}
        for item in passes:
            live[item.output] = listings.stored(_run_pass(item, live, textures, size, precision), dtype, rounding)
        return live


def _run_pass(item: Pass, live: Mapping[str, Image], textures: Textures, size, precision) -> Image:
    values = item.values()
    if item.entry == "BokehCoCMap":
        depth = listings.safe_depth(textures[item.inputs["DepthSamp"]].astype(np.float64))
        coc = listings.circle_of_confusion(
            depth,
            values["BokehApertureDiameter"],
            values["BokehFocalLength"],
            values["BokehFocusDistance"],
            values["BokehSensorHeight"],
            values["BokehMaxCoC"],
        )
        return listings.coc_map(textures[item.inputs["ColorSamp"]], coc, precision is not None)
    if item.entry == "BokehConstantCoC":
        coc = np.clip(values["BokehConstantCoC"], 0.0, values["BokehMaxCoC"])
        return listings.coc_map(textures[item.inputs["ColorSamp"]], coc, precision is not None)
    if item.entry == "BokehDebug":
        return _debug(live[item.inputs["ColorSamp"]], textures[item.inputs["DepthSamp"]], values)
    filtered = listings.gather(
        live[item.inputs["ColorSamp"]],
        textures[item.inputs["DepthSamp"]],
        _offsets(item, values, textures, size),
        values["BokehBleedingBias"],
        values["BokehBleedingMult"],
        values["BokehBlurCoC"] > 0.5,
        precision,
    )
    if item.entry == "BokehDepthOfFieldFinal":
        return listings.combine(filtered, live[item.inputs["ColorSampB"]], values["BokehUseMax"] > 0.5)
    return filtered


def _offsets(item: Pass, values: Mapping[str, float], textures: Textures, size: tuple[int, int]) -> np.ndarray:
    """Sample offsets in units of the image height, (N, 2): the shaders' uv offsets times the aspect ratio in x.

    The shaders divide x by the aspect ratio that they are told; uv times the real size undoes it only if that is right.
    """
    aspect = values["BokehAspectRatio"]
    to_heights = np.array([size[0] / size[1], 1.0])
    if item.entry in ("BokehDepthOfField", "BokehDepthOfFieldFinal"):
        return apertures.make_offsets(values["BokehAngle"], aspect, item.samples) * to_heights
    if item.entry == "BokehNaiveGrid":
        u = apertures.make_offsets(values["BokehAngle"], aspect, item.samples)
        v = apertures.make_offsets(values["BokehAngleB"], aspect, item.samples)
        return (v[:, None] + u[None, :]).reshape(-1, 2) * to_heights
    if item.entry == "BokehNaiveGather":
        table = textures[item.inputs["KernelSamp"]][0, :, :2].astype(np.float64)
        return table / np.array([aspect, 1.0]) * to_heights
    raise KeyError(f"the reference has no pass {item.entry!r}")


def _debug(image: Image, depth: np.ndarray, values: Mapping[str, float]) -> Image:
    """Section [9] of the libraries."""
    mode, focus = values["BokehDebugMode"], values["BokehFocusDistance"]
    s2 = listings.safe_depth(depth.astype(np.float64))
    amount = np.clip(image.value[..., 3] / max(values["BokehMaxCoC"], listings.MIN_DEPTH), 0.0, 1.0)
    one = np.ones_like(amount)
    if mode > 2.5:
        near = np.stack([amount, 0.5 * amount, 0 * amount, one], axis=-1)
        far = np.stack([0.1 * amount, 0.4 * amount, amount, one], axis=-1)
        return Image(np.where((s2 < focus)[..., None], near, far))
    if mode > 1.5:
        return Image(np.stack([amount, amount, amount, one], axis=-1))
    if mode > 0.5:
        grey = s2 / (s2 + focus)
        return Image(np.stack([grey, grey, grey, one], axis=-1))
    return Image(image.value)
