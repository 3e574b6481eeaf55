"""Probe layered with near and far lights: alone, next to something sharp, and behind something near."""

from functools import partial

import numpy as np

from bokeh_validation.probes.highlight import Bokeh, block, polygon_of
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat, overlap, pixel_center
from bokeh_validation.probes.near_edges import CAMERA, SIZE, STEP, UNCOVERED, checker, edge_spread, metres, settings

LIGHT = 800.0
# Blue around the lights; a half float near zero would be off by thousands of steps from a filter's rounding next to a
# light
AMBIENT = 0.125

# ------------------------------------------------------------------------------------------------------ isolated lights

LIGHT_COCS = (-80, -24, -12, 12, 24, 80)
# Side of the light in pixels -> minimum overlap at a CoC of 80 pixels with 18 samples per edge, 2.2 pixels apart. A
# sample is a tent of 4 pixels; at a wider spacing dots appear.
LIGHT_PIXELS = {1: 0.9, 3: 0.94, 9: 0.97}
LIGHTS = (*((coc, "medium") for coc in LIGHT_COCS), (-80, "high"), (80, "high"))


def light_bokeh(coc: float, pixels: int, size: tuple[int, int]) -> Bokeh:
    """Return the bokeh of the upper left pixel of a light in the middle. `coc` is in pixels, `pixels` the light's
    side.
    """
    first = [(length - pixels) // 2 for length in size]
    return Bokeh(polygon_of("hexagon", 0.0, coc), size, pixel_center(*first))


def light_case(coc: float, pixels: int, preset: str = "medium") -> Case:
    """Return a blue light on a dark far plane of the same depth, or a near one over a green checker in focus.

    coc     pixels, negative in front of the focus
    pixels  side of the light
    """
    side = abs(coc) + pixels + 24
    size = side + 8, side
    color, depth = flat(size), depth_of(size, metres(coc, side) if coc > 0 else CAMERA.focus_distance)
    color[..., :3] = 0.01, 0.01, AMBIENT
    if coc < 0:
        color[..., 1] = checker(size)
    light = block(((size[0] - 1) // 2, (size[1] - 1) // 2), pixels)
    color[light][..., :3] = 0.0, 0.0, LIGHT + (AMBIENT if coc > 0 else 0.0)
    depth[light] = metres(coc, side)
    label = f"{pixels} px at CoC {coc}" + (", 18 samples" if preset == "high" else "")
    return Case(label, settings(preset=preset), color, depth)


def light_spread(coc: float, pixels: int, size: tuple[int, int]) -> np.ndarray:
    """Return the fraction of the light in the middle that a lens puts on each pixel, (H, W)."""
    return mean_spread(light_bokeh(coc, pixels, size), pixels)


def mean_spread(first: Bokeh, pixels: int) -> np.ndarray:
    """Return the mean of the polygons of all pixels of a light, (H, W).

    first   the bokeh of the light's upper left pixel
    pixels  side of the light
    """
    fraction = first.coverage / first.area
    return (
        sum(np.roll(fraction, (row, column), (0, 1)) for row in range(pixels) for column in range(pixels)) / pixels**2
    )


def _judge_lights(pixels: int, outputs: dict[str, Outputs]) -> list[Check]:
    checks = []
    for (coc, preset), (label, textures) in zip(LIGHTS, outputs.items(), strict=True):
        blue, total = textures["result"][..., 2], LIGHT * pixels**2
        size = blue.shape[::-1]
        spread = light_spread(coc, pixels, size)
        # a near light hides the background behind it
        lit = blue - AMBIENT * (1.0 - (spread * pixels**2 if coc < 0 else 0.0))
        checks.append(Check(f"light kept, {label}", lit.sum() / total, 0.99, 1.01, "asked for"))
        if preset == "high":
            overlap_bound, why = LIGHT_PIXELS[pixels], "asked for at 18 samples"
        elif abs(coc) < 80:
            # a far light below 12.4 pixels is gathered, in two rings 1/5 of the CoC apart, with 19 samples: each of
            # them finds the whole light once, so they cover as many pixels of the hexagon as 19 lights
            overlap_bound = light_bokeh(coc, pixels, size).min_overlap(max(0.5, coc / 10.0) if 0 < coc < 12.4 else 0.5)
            why = "texels of half the size lie half a pixel off the pixels; the gather's rings are known to half a step"
            if 0 < coc < 12.4:
                overlap_bound = min(overlap_bound, 19 * pixels**2 / (0.6495 * coc**2))
        else:
            continue
        checks.append(
            Check(f"overlap with the polygon, {label}", overlap(lit / total, spread), overlap_bound, 1.0, why)
        )
    return checks


def light_probe(pixels: int) -> Probe:
    """Return the probe of lights of one size at every CoC, and at 80 pixels with more samples too."""
    cases = tuple(light_case(coc, pixels, preset) for coc, preset in LIGHTS)
    title = f"An isolated light of {pixels} pixels becomes a hexagon of the same light, near and far"
    shows = (
        "A hexagon over the background, no brighter and no darker than the light; small ones at 80 pixels show dots."
    )
    return Probe(f"layered-light-{pixels}", title, shows, cases, partial(_judge_lights, pixels), pixels not in (3, 9))


# ----------------------------------------------------------------------------- far lights behind near objects or edges

COC, NEAR_COC = 24, 16
EDGE = 47  # first column behind the silhouette; odd, so the edge falls inside a texel of the half-size layer
BEHIND = 0.2
BESIDE = 8  # pixels from the silhouette to the light
COVER = EDGE + 6  # first column of the near object, which covers part of a light at EDGE
ROW = SIZE[1] // 2  # of the lights, which are 3 x 3 pixels


def far_spread(column: int) -> np.ndarray:
    """Return the fraction of the light around a column that each pixel receives, (H, W)."""
    return mean_spread(Bokeh(polygon_of("hexagon", 0.0, COC), SIZE, pixel_center(column - 1, ROW - 1)), 3)


def silhouette_case() -> Case:
    """Return green in focus at the left, and at the right a grey-red far plane with a blue light."""
    sharp = np.broadcast_to(np.arange(SIZE[0]) < EDGE, SIZE[::-1])
    color, depth = flat(SIZE), depth_of(SIZE, metres(COC, SIZE[1]))
    color[..., 0] = np.where(sharp, 0.0, BEHIND)
    color[..., 1] = np.where(sharp, checker(SIZE), 0.0)
    color[block((EDGE + BESIDE, ROW), 3)][..., 2] = LIGHT
    depth[sharp] = CAMERA.focus_distance
    return Case("silhouette", settings(), color, depth)


def _judge_silhouette(outputs: dict[str, Outputs]) -> list[Check]:
    result = outputs["silhouette"]["result"]
    sharp, behind = result[:, :EDGE], result[:, EDGE:]
    error = np.abs(sharp[..., 1] / checker(SIZE).astype(np.float16)[:, :EDGE] - 1.0).max()
    darkest = behind[..., 0].min() / float(np.float16(BEHIND))
    rim = "no dark rim: a mean of one colour; the layer and its weight are cut off three times, the image once"
    light = behind[..., 2].sum() / (far_spread(EDGE + BESIDE)[:, EDGE:].sum() * 9.0 * LIGHT)
    why = "what the silhouette hides is taken like the rest; a pixel beside it sees half of its polygon or more"
    return [
        Check("light on the sharp side", sharp[..., 2].max(), 0.0, 0.0, "nothing behind it can be sampled there"),
        Check("the sharp side, off by", error, 0.0, STEP, "a quotient that is 1 except for rounding, and its store"),
        Check("darkest behind, in units of the background", darkest, 1 - 4 * STEP, 1 + 4 * STEP, rim),
        Check("the silhouette's light behind it", behind[..., 1].max(), 0.0, 0.0, "it does not spread"),
        Check("light behind it, in units of the polygon's part there", light, 0.99, 2.0, why),
    ]


SILHOUETTE = Probe(
    "silhouette-light",
    "A far light beside a sharp silhouette stays behind it",
    "The hexagon is cut off at the silhouette, without a dark rim and without a glow on the sharp side.",
    (silhouette_case(),),
    _judge_silhouette,
)


def covered_case() -> Case:
    """Return the blue far light with a red near object at the right."""
    near = np.broadcast_to(np.arange(SIZE[0]) >= COVER, SIZE[::-1])
    color, depth = flat(SIZE), depth_of(SIZE, metres(COC, SIZE[1]))
    color[..., 0] = near
    color[..., 1] = np.where(near, 0.0, BEHIND)
    color[..., 2] = np.where(near, 0.0, AMBIENT)
    color[block((EDGE, ROW), 3)][..., 2] += LIGHT
    depth[near] = metres(-NEAR_COC, SIZE[1])
    return Case("covered", settings(), color, depth)


def _judge_covered(outputs: dict[str, Outputs]) -> list[Check]:
    result, x = outputs["covered"]["result"], np.arange(SIZE[0]) + 0.5
    blue = result[..., 2] - result[..., 1] * (AMBIENT / BEHIND)
    alpha, hidden = (edge_spread(polygon_of("hexagon", 0.0, coc), x - COVER) for coc in (NEAR_COC, COC))
    spread = far_spread(EDGE) * 9.0 * LIGHT
    covered = blue[:, alpha >= 1.0].max() / spread.max()
    # a ray from a pixel to the light crosses the near plane on the opposite side of the pixel; by similar triangles
    ratio = NEAR_COC / COC
    visible_light = spread[:, x < (COVER + (EDGE + 0.5) * ratio) / (1 + ratio)].sum()
    light_bound = (spread * (1.0 - alpha) / np.maximum(1.0 - hidden, STEP)).sum() / visible_light
    covered_name = "light where the near object covers everything, in units of the light's bokeh"
    why = "it fades with the near edge: 1 - alpha of the polygon over the fraction of the far plane in the image"
    return [
        Check(covered_name, covered, 0.0, UNCOVERED + STEP, "near weights from 0.998 on are treated as 1"),
        Check("light, in units of what the lens sees of it", blue.sum() / visible_light, 0.99, 1.01 * light_bound, why),
    ]


COVERED = Probe(
    "covered-light",
    "A near object over a far light lets it through only where the lens sees it",
    "The hexagon fades under the near edge, and is invisible where the near object covers it completely.",
    (covered_case(),),
    _judge_covered,
)

PROBES = (*(light_probe(pixels) for pixels in LIGHT_PIXELS), SILHOUETTE, COVERED)
