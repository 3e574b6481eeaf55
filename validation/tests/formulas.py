"""Compute the targets of each pass, except those of the layers, in float64, from the paper's formulas and the polygons'
geometry.

Written independently of the shaders' text, which interpreter.py runs: tests/shaders/test_reference.py compares the
two. Textures are (H, W, 4): linear colour, CoC in alpha.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np
import rays
from lines import Line, lines

from bokeh_validation.frame.methods import FOCUS, LENS
from bokeh_validation.reference import listings, sampling
from bokeh_validation.shaders.entries import (
    ADAPTIVE,
    COPY,
    DEPTH,
    EDGE,
    FIRST,
    GRID,
    LATERAL,
    LINE,
    SECOND,
    STEADY,
    TABLE,
    VIEW,
)
from bokeh_validation.shaders.passes import Pass

# Interleaved gradient noise (Jimenez 2014); each frame adds 33/64, 8 p + 1 times in pass p
NOISE = (0.06711056, 0.00583715, 52.9829189)
FRAME_STEP, FRAMES, PASS_STEPS = 33 / 64, 64, 8
MOST_LATERAL = 0.1
# one sample of every pixel: index of its texture, its position relative to the pixel in texels, and its weight
Sample = tuple[int, np.ndarray, np.ndarray, np.ndarray | float]


def run_pass(render_pass: Pass, inputs: Mapping[str, np.ndarray]) -> list[np.ndarray]:
    """Return what a pass writes to each of its targets, given slot -> texture."""
    values, role = render_pass.given(), render_pass.spec.role
    depth = inputs["DepthSamp"][..., 0] if "DepthSamp" in inputs else None
    if role == DEPTH:
        kind, near, far = (values[f"Bokeh{name}"] for name in ("DepthKind", "Near", "Far"))
        metres = listings.linear_depth(depth, round(kind), near, far)
        return [np.stack([metres, metres, metres, np.ones_like(metres)], axis=-1)]
    color = inputs["ColorSamp"]
    if role == COPY:
        return [_coc_map(render_pass.entry, values, color, depth)]
    if role == LATERAL:
        return [_lateral(color, values["BokehLateral"])]
    if role == STEADY:
        return [_steady(*(inputs[slot] for slot in render_pass.spec.textures), values["BokehStableBlend"])]
    if role == VIEW:
        return [_debug(color, depth, values)]
    if role in (LINE, GRID, TABLE):
        filtered = [gather([color], depth, _fixed(render_pass, inputs), values, values["BokehBlurCoC"] > 0.5)]
    elif role == ADAPTIVE:
        filtered = _along_line(render_pass, inputs, depth)
    else:
        filtered = _exact(render_pass, inputs)
    if "ColorSampB" in inputs and role in (LINE, ADAPTIVE):
        # Listing 4
        combine = np.maximum if values["BokehUseMax"] > 0.5 else np.minimum
        return [combine(filtered[0], inputs["ColorSampB"])]
    return filtered


def _coc_map(entry: str, values: Mapping[str, float], color: np.ndarray, depth: np.ndarray | None) -> np.ndarray:
    """Compute the CoC map (Listing 1)."""
    if entry == "BokehConstantCoC":
        coc = np.clip(values["BokehConstantCoC"], 0.0, values["BokehMaxCoC"])
    else:
        stored = ("DepthKind", "Near", "Far") if entry == "BokehSignedCoCMap" else ()
        kind, near, far = [values[f"Bokeh{name}"] for name in stored] or (0.0, 0.0, 0.0)
        if entry == "BokehSignedCoCMap":
            depth = _of_image(depth, values)
        coc = _signed_coc(listings.linear_depth(depth, round(kind), near, far), values)
        coc = np.abs(coc) if entry == "BokehCoCMap" else _beside_lights(color, coc)
    value = np.empty((*color.shape[:2], 4))
    value[..., :3], value[..., 3] = listings.safe_color(color[..., :3]), coc
    return value


def _beside_lights(color: np.ndarray, coc: np.ndarray) -> np.ndarray:
    """Take over the CoC of the brightest of the four neighbours, the light, if it is nearer.

    Two kinds of pixel take it over:

      * A dark pixel. The light's CoC fades in while the light is 4 to 8 times as bright as the pixel. If the sharper of
        the two has a CoC of one pixel or less, each keeps its own; up to two pixels, the change fades in.
      * A pixel on the rim of a light, darker than the light. The light's CoC fades in while the pixel is 1.3 to 1.5
        times as bright as its darkest neighbour. It keeps its own CoC if that is at most one pixel, unless the light is
        blurred, in front of the focus, and at least 64 to 128 times as bright as the darkest neighbour.

    Between a pixel behind the focus and a light in front of it, the CoC switches without a ramp.
    """
    light = listings.safe_color(color[..., :3]).sum(axis=-1)
    neighbours, neighbour_cocs = (
        np.array([padded[1:-1, 2:], padded[1:-1, :-2], padded[2:, 1:-1], padded[:-2, 1:-1]])
        for padded in (np.pad(light, 1, mode="edge"), np.pad(coc, 1, mode="edge"))
    )
    brightest = neighbours.argmax(axis=0)[None]
    brightness, light_coc = (np.take_along_axis(values, brightest, 0)[0] for values in (neighbours, neighbour_cocs))
    brightness_here = np.maximum(light, 1e-7)
    ratio = np.maximum(brightness / brightness_here, 1.0)
    dark = np.clip(ratio / 4.0 - 1.0, 0.0, 1.0)
    dark *= np.clip(np.minimum(np.abs(coc), np.abs(light_coc)) * len(coc) - 1.0, 0.0, 1.0)
    darkest = np.maximum(neighbours.min(axis=0), 1e-7)
    rim = np.clip(5.0 * brightness_here / darkest - 6.5, 0.0, 1.0) * np.clip(10.0 * ratio - 10.0, 0.0, 1.0)
    rim *= 1.0 + np.clip(ratio * brightness_here / darkest / 64.0 - 1.0, 0.0, 1.0)
    bright = (rim - 1.0) * np.clip(-light_coc * len(coc) - 1.0, 0.0, 1.0)
    rim = np.minimum(rim, 1.0) * np.clip(np.abs(coc) * len(coc) - 1.0, 0.0, 1.0)
    weight = np.maximum(dark, np.maximum(rim, bright))
    weight = np.where((light_coc < 0.0) & (coc > 0.0), np.round(weight), weight)
    return coc + (np.minimum(coc, light_coc) - coc) * weight


def _of_image(depth: np.ndarray, values: Mapping[str, float]) -> np.ndarray:
    """Return the rectangle of a depth buffer that the image covers; it has as many texels as the image."""
    (height, width), (x, y, w, h) = depth.shape, [values[f"BokehDepth{name}"] for name in ("X", "Y", "Width", "Height")]
    return depth[round(y * height) : round((y + h) * height), round(x * width) : round((x + w) * width)]


def _signed_coc(depth: np.ndarray, values: Mapping[str, float]) -> np.ndarray:
    """Compute the signed CoC of a lens with an in-focus range, and factors and limits for each side."""
    aperture, focal, focus, sensor, max_coc = (values[name] for name in LENS)
    ranges, scales, limits = ([values[f"Bokeh{side}{quantity}"] for side in sides] for quantity, sides in FOCUS.items())
    nearest, farthest = min(focus, listings.MAX_DEPTH) - ranges[0], min(focus, listings.MAX_DEPTH) + ranges[1]
    # in front of the range, the lens is focused at its near end; behind it, at the far end
    of_ends = [
        listings.circle_of_confusion(depth, aperture, focal, end, sensor, max_coc) for end in (nearest, farthest)
    ]
    front, back = (np.minimum(scale * coc, limit) for scale, coc, limit in zip(scales, of_ends, limits, strict=True))
    return np.where(depth < nearest, -front, np.where(depth > farthest, back, 0.0))


def _texels(render_pass: Pass, size: tuple[int, int]) -> tuple[float, float]:
    """Return the scale from offsets in image heights to texels; x uses the aspect ratio that the shaders are given."""
    return size[0] / render_pass.given()["BokehAspectRatio"], size[1]


def _fixed(render_pass: Pass, inputs: Mapping[str, np.ndarray]) -> Iterator[Sample]:
    """Yield samples that are the same for every pixel, scaled by its CoC: along lines from end to end (Listing 2), or
    from a table.
    """
    coc = inputs["ColorSamp"][..., 3]
    if render_pass.spec.role == TABLE:
        places = inputs["KernelSamp"][0, :, :2] * [render_pass.given()["BokehSqueeze"], 1.0]
    else:
        positions = np.linspace(-1.0, 1.0, render_pass.samples)[:, None]
        places = np.concatenate([line.segment.middle + positions * line.segment.half for line in lines(render_pass)])
    for x, y in places * _texels(render_pass, coc.shape[::-1]):
        yield 0, x * coc, y * coc, 1.0


def gather(
    sources: Sequence[np.ndarray],
    depth: np.ndarray,
    samples: Iterable[Sample],
    values: Mapping[str, float],
    blur_coc: bool,
) -> np.ndarray:
    """Return the weighted mean of samples around each pixel (Listing 3); the pixel itself if every sample is rejected.

    sources   textures to sample; the first one has the centre pixels
    depth     for the leakage test
    samples   see Sample
    values    parameters by name
    blur_coc  whether alpha is averaged too
    """
    center, leakage = sources[0], (values["BokehBleedingBias"], values["BokehBleedingMult"])
    size, (row, column) = center.shape[1::-1], np.mgrid[0 : len(center), 0 : center.shape[1]] + 0.5
    color, total = np.zeros_like(center), np.zeros(center.shape[:2])
    for source, x, y, weight in samples:
        sample = sampling.bilinear(sources[source], column + x, row + y)
        near = depth.reshape(-1)[sampling.nearest_index(column + x, row + y, size)]
        leak = listings.leakage_weight(near, sample[..., 3], listings.safe_depth(depth), center[..., 3], *leakage)
        color += sample * (leak * weight)[..., None]
        total += leak * weight
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.where(total[..., None] > 0.0, color / total[..., None], center)
    return mean if blur_coc else np.concatenate([mean[..., :3], center[..., 3:]], axis=-1)


def _along_line(render_pass: Pass, inputs: Mapping[str, np.ndarray], depth: np.ndarray) -> list[np.ndarray]:
    """Compute `BokehAdaptive`."""
    color, values = inputs["ColorSamp"], render_pass.given()
    (line,) = lines(render_pass, color.shape[1::-1])
    samples = ((0, x, y, end - begin) for x, y, begin, end in cells(render_pass, line, color[..., 3]))
    return [gather([color], depth, samples, values, values["BokehBlurCoC"] > 0.5)]


def is_exact(render_pass: Pass) -> bool:
    """Return whether a pass belongs to an exact polygon."""
    return render_pass.spec.role in (FIRST, SECOND, EDGE) and not render_pass.spec.layers


def nearest(render_pass: Pass, line: Line) -> float | None:
    """Return the place of a line that is taken for the nearest to the pixel, 0 to 1; None if it is a ray of a hexagon.

    In a square that is the middle. In octagons and decagons of n edges per half, it is the end of the last line of the
    second pass and the beginning of the others; in the first pass it falls by 0.69 from line to line, and is the middle
    for a line in the middle of the half.
    """
    sides = render_pass.spec.sides or round(render_pass.given()["BokehSides"])
    half = sides // 2
    if sides in (4, 6):
        return 0.5 if sides == 4 else None
    if render_pass.spec.role == SECOND:
        return float(line.edge == half)
    return float(np.clip(0.5 + 0.69 * (half / 2 - line.edge), 0.0, 1.0))


def _exact(render_pass: Pass, inputs: Mapping[str, np.ndarray]) -> list[np.ndarray]:
    """Compute the passes of exact polygons: for each target, the lines that contribute to it."""
    center, is_first = inputs["ColorSamp"], render_pass.spec.role != SECOND
    coc, pass_lines = center[..., 3], lines(render_pass, center.shape[1::-1])
    along = [
        rays.gathered(cells(render_pass, line, coc), inputs[line.slot], coc, nearest(render_pass, line))
        for line in pass_lines
    ]
    # a line of length 0 has gathered nothing
    sharp = filter_coc(np.abs(coc), len(coc), render_pass.spacing) == 0.0
    targets = []
    for target in range(len(pass_lines[0].shares)):
        shares = [line.shares[target] for line in pass_lines]
        value = rays.target(list(zip(along, shares, strict=True)), center, is_first)
        targets.append(np.where(sharp[..., None], center, value))
    return targets


def cells(render_pass: Pass, line: Line, coc: np.ndarray) -> Iterator[rays.Cell]:
    """Yield the samples of a line, one per cell: x and y in texels, and where the cell begins and ends, as fractions
    of the line.

    With a spacing, cells have that length, counted from the line's beginning, and the last one is shorter.
    """
    values, (height, width), segment = render_pass.given(), coc.shape, line.segment
    spacing = render_pass.spacing
    line_coc = filter_coc(np.abs(coc), height, spacing)
    length = 2.0 * segment.half_length * line_coc * height
    count = (
        np.clip(length / spacing, 1.0, render_pass.samples)
        if spacing > 0.0
        else np.full_like(line_coc, render_pass.samples)
    )
    # the exact passes have fixed indices
    index = values["BokehPassIndex"] if render_pass.spec.role == ADAPTIVE else float(render_pass.spec.role == SECOND)
    jitter = max(values["BokehJitter"], 0.0) * noise((width, height), values["BokehFrame"], index)
    phase = 0.5 + jitter * np.clip(length / count - 1.0, 0.0, 1.0)
    middle, half = (field.reshape(2, *(field.shape[1:] or (1, 1))) for field in (segment.middle, segment.half))
    across, down = _texels(render_pass, (width, height))
    for i in range(int(np.ceil(count.max()))):
        begin = np.minimum(i, count)
        end = np.minimum(i + 1.0, count)
        position = 2.0 * (begin + (end - begin) * phase) / count - 1.0
        x, y = (middle + half * position) * line_coc
        yield x * across, y * down, begin / count, end / count


def filter_coc(coc, image_height: float, spacing: float):
    """Return the CoC that a line uses: 0 up to half a pixel, the full CoC from one pixel on, ramped between them."""
    if spacing <= 0.0:
        return coc
    return coc * np.clip(2.0 * coc * image_height - 1.0, 0.0, 1.0)


def noise(size: tuple[int, int], frame: float, pass_index: float = 0) -> np.ndarray:
    """Return interleaved gradient noise for a pass of a frame, (H, W), -0.5 to 0.5."""
    steps = FRAME_STEP * ((PASS_STEPS * pass_index + 1) * (frame % FRAMES) + pass_index)
    y, x = np.mgrid[0 : size[1], 0 : size[0]]
    return (NOISE[2] * ((NOISE[0] * x + NOISE[1] * y) % 1.0) + steps) % 1.0 - 0.5


def _lateral(picture: np.ndarray, amount: float) -> np.ndarray:
    """Compute lateral colour: red is enlarged by `amount` relative to green, blue reduced."""
    (height, width), amount = picture.shape[:2], min(max(amount, -MOST_LATERAL), MOST_LATERAL)
    value, (y, x) = picture.copy(), np.mgrid[0:height, 0:width] + 0.5
    for channel, scale in ((0, 1.0 + amount), (2, 1.0 - amount)):
        at_x, at_y = (x - width / 2) / scale + width / 2, (y - height / 2) / scale + height / 2
        value[..., channel] = sampling.bilinear(picture[..., channel : channel + 1], at_x, at_y)[..., 0]
    return value


def _steady(picture: np.ndarray, history: np.ndarray, velocity: np.ndarray, share: float) -> np.ndarray:
    """Compute the stabilised map.

    The previous frame's CoC, fetched from where each pixel was, is clamped between the nearest of 3 x 3 and the
    pixel's own, then blended with it; `share` is the weight of this frame. `velocity` is in uv.
    """
    (height, width), coc = picture.shape[:2], picture[..., 3]
    moved = np.where(np.isfinite(velocity[..., :2]), velocity[..., :2], np.inf)
    y, x = np.mgrid[0:height, 0:width] + 0.5
    at_x, at_y = x - moved[..., 0] * width, y - moved[..., 1] * height
    was_inside = (at_x >= 0.0) & (at_x <= width) & (at_y >= 0.0) & (at_y <= height)
    previous = sampling.bilinear(history[..., 3:], np.where(was_inside, at_x, x), np.where(was_inside, at_y, y))[..., 0]
    nearest = -sampling.neighbourhood(-coc[..., None])[..., 0]
    previous = np.where(np.isnan(previous), nearest, np.clip(previous, nearest, coc))
    value = picture.copy()
    value[..., 3] = np.where(was_inside, coc + (previous - coc) * np.clip(1.0 - share, 0.0, 1.0), coc)
    return value


def _debug(image: np.ndarray, depth: np.ndarray, values: Mapping[str, float]) -> np.ndarray:
    """Compute the debug view: colour, depth, CoC, or near and far field."""
    mode, focus, s2 = values["BokehDebugMode"], values["BokehFocusDistance"], listings.safe_depth(depth)
    amount = np.clip(np.abs(image[..., 3]) / max(values["BokehMaxCoC"], listings.MIN_DEPTH), 0.0, 1.0)
    opaque = np.ones_like(amount)
    if mode > 2.5:
        near = np.stack([amount, 0.5 * amount, 0 * amount, opaque], axis=-1)
        far = np.stack([0.1 * amount, 0.4 * amount, amount, opaque], axis=-1)
        return np.where((s2 < focus)[..., None], near, far)
    grey = amount if mode > 1.5 else s2 / (s2 + focus)
    return np.stack([grey, grey, grey, opaque], axis=-1) if mode > 0.5 else image
