"""The float64 reference as a driver: the same passes, the formulas instead of a device."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from bokeh_validation.drivers.base import STORAGE, Textures
from bokeh_validation.frame import apertures
from bokeh_validation.reference import aberration, layered, listings, segments
from bokeh_validation.reference.gather import Leakage, Table, at_center, gather
from bokeh_validation.reference.images import Image, stored
from bokeh_validation.reference.lines import lines
from bokeh_validation.reference.precision import SOFTWARE, Precision
from bokeh_validation.shaders.entries import ADAPTIVE, COPY, DEPTH, EDGE, FIRST, GRID, LATERAL, LINE, SECOND, VIEW
from bokeh_validation.shaders.passes import Pass, target_area, target_size


class Reference:
    """NumPy, float64, rounded to the targets' format between passes. No language, no device."""

    name = "reference"
    adapter = "NumPy float64"
    software = True
    precision = SOFTWARE
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
        return {name: images[name].value.astype(STORAGE[storage]) for name in keep}

    def images(
        self,
        passes: Sequence[Pass],
        textures: Textures,
        size: tuple[int, int],
        storage: str = "half",
        precision: Precision | None = None,
        rounding: str = "nearest",
        given: Textures | None = None,
    ) -> dict[str, Image]:
        """Every pass's output in float64; with `precision`, each with its acceptance interval.

        rounding  how the targets round, see images.stored
        given     name -> what a device has in a target: what later passes read in place of the result for it. Each
                  interval is then that of one pass.
        """
        dtype = STORAGE[storage]
        live: dict[str, Image] = {}
        results_of: dict[str, Image] = {}
        scales: dict[str, int] = {}
        for item in passes:
            whole = target_size(item.scale, size)
            if item.viewport is None:
                results = _run_pass(item, live, textures, whole, precision)
            else:
                results = _run_in_viewport(item, live, scales, textures, precision)
            for name, image in zip(item.outputs, results, strict=True):
                kept = stored(image, dtype, rounding)
                if item.viewport is not None:
                    area = target_area(item.scale, item.viewport)
                    kept = _drawn(kept, area, live.get(name), whole)
                live[name] = kept
                scales[name] = item.scale
                results_of[name] = live[name]
                if given is not None and name in given:
                    live[name] = _exactly(given[name], precision)
        return results_of


# The shaders keep so far from the texels around a viewport, texels: BokehSetViewport
VIEWPORT_INSET = 1.0 / 128.0


def _exactly(pixels: np.ndarray, precision: Precision | None) -> Image:
    """What a device has in a target, without doubt."""
    value = pixels.astype(np.float64)
    if precision is None:
        return Image(value)
    return Image(value, np.zeros_like(value), np.zeros(value.shape[:2], bool))


def _run_in_viewport(
    item: Pass, live: Mapping[str, Image], scales: Mapping[str, int], textures: Textures, precision
) -> list[Image]:
    """What a pass writes into its viewport, from that part of its textures where it is told so; tables are read whole.

    scales  of the targets in `live`: the part is in texels of each

    The interval counts the inset as an error of the sampler's place, which it is at the edge and nowhere else.
    """
    x, y, width, height = item.viewport
    if not item.constants["BOKEH_VIEWPORT"]:
        return _run_pass(item, live, textures, target_size(item.scale, (width, height)), precision)
    rows, columns = slice(y, y + height), slice(x, x + width)
    part = {name: pixels[rows, columns] for name, pixels in textures.items()}
    if "KernelSamp" in item.inputs:
        part[item.inputs["KernelSamp"]] = textures[item.inputs["KernelSamp"]]
    if precision is not None:
        precision = replace(precision, subtexel=precision.subtexel + VIEWPORT_INSET)
    parts = {}
    for name in set(live).intersection(item.inputs.values()):
        x, y, width, height = target_area(scales[name], item.viewport)
        parts[name] = live[name].part(slice(y, y + height), slice(x, x + width))
    return _run_pass(item, parts, part, target_size(item.scale, item.viewport[2:]), precision)


def _drawn(image: Image, viewport: tuple[int, int, int, int], over: Image | None, size: tuple[int, int]) -> Image:
    """An image drawn into a rectangle of a target of that size, over what it held; a new target holds 0."""
    x, y, width, height = viewport
    shape = (size[1], size[0])

    def whole(part: np.ndarray | None, kept: np.ndarray | None) -> np.ndarray | None:
        if part is None:
            return None
        result = np.zeros((*shape, *part.shape[2:]), part.dtype) if kept is None else kept.copy()
        result[y : y + height, x : x + width] = part
        return result

    before = over or Image(None)
    return Image(
        whole(image.value, before.value), whole(image.error, before.error), whole(image.undecided, before.undecided)
    )


def _run_pass(item: Pass, live: Mapping[str, Image], textures: Textures, size, precision) -> list[Image]:
    """What a pass writes to each of its targets."""
    values = item.given()
    if item.spec.layers:
        inputs = {slot: live[name] for slot, name in item.inputs.items()}
        return layered.run_pass(item.spec, inputs, size, values, item.constants, precision)
    role = item.spec.role
    if role == DEPTH:
        depth = textures[item.inputs["DepthSamp"]].astype(np.float64)
        metres = listings.linear_depth(depth, round(values["BokehDepthKind"]), values["BokehNear"], values["BokehFar"])
        return [Image(np.stack([metres, metres, metres, np.ones_like(metres)], axis=-1))]
    if role == COPY:
        coc = _coc(item, values, textures)
        return [listings.coc_map(textures[item.inputs["ColorSamp"]], coc, precision is not None)]
    if role == LATERAL:
        return [aberration.lateral(live[item.inputs["ColorSamp"]], values["BokehLateral"], precision)]
    if role == VIEW:
        return [_debug(live[item.inputs["ColorSamp"]], textures[item.inputs["DepthSamp"]], values)]
    filters = _Filters(item, values, live, textures, size, precision)
    if role in (ADAPTIVE, FIRST, SECOND, EDGE):
        return filters.along_lines()
    table = Table(_offsets(item, values, textures, size), size[1])
    filtered = gather(filters.color, filters.depth, table, filters.leakage, values["BokehBlurCoC"] > 0.5, precision)
    return [filters.combined(filtered)]


def _coc(item: Pass, values: Mapping[str, float], textures: Textures) -> np.ndarray | float:
    """What a CoC map stores beside the colour."""
    if item.entry == "BokehConstantCoC":
        return np.clip(values["BokehConstantCoC"], 0.0, values["BokehMaxCoC"])
    depth = listings.safe_depth(textures[item.inputs["DepthSamp"]].astype(np.float64))
    camera = ("ApertureDiameter", "FocalLength", "FocusDistance", "SensorHeight", "MaxCoC")
    coc = listings.circle_of_confusion(depth, *(values[f"Bokeh{name}"] for name in camera))
    return listings.signed_coc(depth, coc, values["BokehFocusDistance"]) if "Signed" in item.entry else coc


class _Filters:
    """Filters of one pass: what they have in common, read from the pass once."""

    def __init__(self, item: Pass, values: Mapping[str, float], live: Mapping[str, Image], textures, size, precision):
        self.item, self.values, self.live, self.precision = item, values, live, precision
        self.depth = textures[item.inputs["DepthSamp"]] if "DepthSamp" in item.inputs else None
        self.color = live[item.inputs["ColorSamp"]]
        self.leakage = Leakage(values["BokehBleedingBias"], values["BokehBleedingMult"])
        # the exact passes know which they are
        index = values["BokehPassIndex"] if item.spec.role == ADAPTIVE else float(item.spec.role == SECOND)
        self.spacing = segments.spaced(
            size, values["BokehSpacing"], item.samples, values["BokehJitter"], values["BokehFrame"], index
        )

    def slot(self, name: str) -> Image:
        """The texture in a slot."""
        return self.live[self.item.inputs[name]]

    def center(self, name: str) -> Image:
        """The texture in a slot, read at each pixel's centre."""
        return at_center(self.slot(name), self.precision)

    def along_lines(self) -> list[Image]:
        """`BokehAdaptive` and the passes of exact polygons: for each target the lines that have a share in it."""
        found, height = lines(self.item, self.color.size), self.color.size[1]
        slots = list(dict.fromkeys(line.slot for line in found))
        sources = [self.slot(name) for name in slots]
        images = []
        for target in range(len(found[0].shares)):
            used = [line for line in found if np.any(line.shares[target])]
            pattern = segments.SampledLines(
                tuple(segments.SampledLine(line.segment, self.spacing, height) for line in used),
                tuple(line.shares[target] for line in used),
                tuple(slots.index(line.slot) for line in used),
            )
            if self.item.spec.role == ADAPTIVE:
                pattern = pattern.lines[0]
            blur_coc = self.item.spec.role == ADAPTIVE and self.values["BokehBlurCoC"] > 0.5
            filtered = [
                segments.adaptive(shifted, self.depth, pattern, self.leakage, blur_coc, self.precision)
                for shifted in self.per_channel(sources)
            ]
            images.append(self.combined(aberration.merged(*filtered) if len(filtered) > 1 else filtered[0]))
        return images

    def per_channel(self, sources: list[Image]) -> list[list[Image]]:
        """The textures with the CoC that red has, green and blue; once where all channels have the same."""
        if self.item.constants["BOKEH_CHARACTER"] < 2:
            return [sources]
        shifts = (self.values["BokehAxialRed"], 0.0, self.values["BokehAxialBlue"])
        return [[aberration.shifted(one, shift) for one in sources] for shift in shifts]

    def combined(self, image: Image) -> Image:
        """Listing 4, where the pass has a second image."""
        if self.item.spec.role not in (LINE, ADAPTIVE) or "ColorSampB" not in self.item.inputs:
            return image
        return listings.combine(image, self.center("ColorSampB"), self.values["BokehUseMax"] > 0.5)


def _offsets(item: Pass, values: Mapping[str, float], textures: Textures, size: tuple[int, int]) -> np.ndarray:
    """Sample offsets in units of the image height, (N, 2): the shaders' uv offsets times the aspect ratio in x.

    The shaders divide x by the aspect ratio that they are told; uv times the real size undoes it only if that is right.
    """
    aspect = values["BokehAspectRatio"] / values["BokehSqueeze"]
    to_heights = np.array([size[0] / size[1], 1.0])
    if item.spec.role == LINE:
        return apertures.make_offsets(values["BokehAngle"], aspect, item.samples) * to_heights
    if item.spec.role == GRID:
        u = apertures.make_offsets(values["BokehAngle"], aspect, item.samples)
        v = apertures.make_offsets(values["BokehAngleB"], aspect, item.samples)
        return (v[:, None] + u[None, :]).reshape(-1, 2) * to_heights
    table = textures[item.inputs["KernelSamp"]][0, :, :2].astype(np.float64)
    return table / np.array([aspect, 1.0]) * to_heights


def _debug(image: Image, depth: np.ndarray, values: Mapping[str, float]) -> Image:
    """Section [9] of the libraries."""
    mode, focus = values["BokehDebugMode"], values["BokehFocusDistance"]
    s2 = listings.safe_depth(depth.astype(np.float64))
    amount = np.clip(np.abs(image.value[..., 3]) / max(values["BokehMaxCoC"], listings.MIN_DEPTH), 0.0, 1.0)
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
