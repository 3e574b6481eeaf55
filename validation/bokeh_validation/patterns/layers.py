"""The layered method: near edges, lights and thin things over what is in focus, and what must not change at all.

Red is what is near, green what is in focus, blue a light: so each can be told from the others in one picture. Levels
are alike, since the method compares brightness with that of the neighbourhood.
"""

from functools import partial
from math import ceil

import numpy as np

from bokeh_validation import apertures, methods
from bokeh_validation.patterns.model import Case, Check, Outputs, Probe, depth_of, flat, pixel_center
from bokeh_validation.reference import polygons

CAMERA = methods.Camera(aperture_diameter=1.0, focal_length=0.05, focus_distance=2.0, max_coc=1.0)
SIZE = (96, 64)
LIGHT = 800.0
# Blue around the lights: a half float near zero would count thousands of steps for a filter's rounding beside a light
AMBIENT = 0.125
# One store in a half float that is cut off: a step of 2^-10 at most
STEP = 2.0**-10
# From a near share of 0.998 a pixel counts as covered
WHOLE = 0.002
INFINITY = float("inf")


def metres(coc: float, height: int) -> float:
    """Depth at which the signed CoC is so many pixels."""
    camera = CAMERA
    magnification = camera.focal_length / (camera.focus_distance - camera.focal_length)
    farthest = camera.aperture_diameter * magnification / camera.sensor_height * height
    return camera.focus_distance / (1.0 - coc / farthest)


def settings(aperture: str = "hexagon", **changes) -> methods.Settings:
    """The layered method through CAMERA."""
    return methods.Settings("layered", aperture, camera=CAMERA, **changes)


def checker(size: tuple[int, int]) -> np.ndarray:
    """Squares of 8 pixels of 0.1 and 0.8, (H, W)."""
    y, x = np.mgrid[0 : size[1], 0 : size[0]]
    return 0.1 + 0.7 * ((x // 8 + y // 8) % 2)


def edge_spread(polygon: np.ndarray, distances: np.ndarray) -> np.ndarray:
    """Share of a polygon on the left of an upright line at each distance from its middle: the integral of its width."""
    far = 2.0 * np.abs(polygon).max() + np.abs(distances).max()
    area = abs(polygons.signed_area(polygon))
    left, right = polygon[:, 0].min(), polygon[:, 0].max()
    found = (np.asarray(distances) >= right).astype(float)
    for index, distance in enumerate(distances):
        if left < distance < right:
            half = np.array([[-far, -far], [distance, -far], [distance, far], [-far, far]])
            found[index] = abs(polygons.signed_area(polygons.clip_convex(polygon, half))) / area
    return found


def steepest(polygon: np.ndarray) -> float:
    """Largest change of the edge spread over a pixel: the polygon's largest width over its area."""
    places = np.linspace(polygon[:, 0].min(), polygon[:, 0].max(), 129)
    return float((np.diff(edge_spread(polygon, places)) / np.diff(places)).max())


def polygon_of(aperture: str, rotation: float, coc: float) -> np.ndarray:
    """Corners in pixels."""
    return abs(coc) * apertures.even_polygon(methods.EXACT[aperture], rotation)


# ----------------------------------------------------------------------------------------------------------------------
# near edges
# ----------------------------------------------------------------------------------------------------------------------

EDGE_COCS = (80, 24, 12)
HALF_PIXEL = (
    "texels of half the size lie half a pixel off the pixels: an edge is known to that, times the steepest slope"
)


def edge_size(coc: float) -> tuple[int, int]:
    """As wide as the blur and some pixels on both sides; CAMERA has no CoC above the height."""
    return 2 * ceil(coc * 0.5) + 24, max(48, coc + 8)


def near_case(label: str, coc: float, held: np.ndarray, chosen: methods.Settings) -> Case:
    """Something red and near, held (H, W) bool, over a green checker in focus."""
    height, width = held.shape
    color, depth = flat((width, height)), depth_of((width, height), CAMERA.focus_distance)
    color[..., 0] = held
    color[..., 1] = np.where(held, 0.0, checker((width, height)))
    depth[held] = metres(-coc, height)
    return Case(label, chosen, color, depth)


def edge_case(coc: float, aperture: str, rotation: float) -> Case:
    """The left half is near; the edge lies between two pixels of a texel of half the size."""
    width, height = edge_size(coc)
    held = np.broadcast_to(np.arange(width) < width // 2 + 1, (height, width))
    return near_case(f"CoC {coc}", coc, held, settings(aperture, rotation=rotation))


def _judge_edges(aperture: str, rotation: float, outputs: dict[str, Outputs]) -> list[Check]:
    checks = []
    for coc in EDGE_COCS:
        width, _ = size = edge_size(coc)
        result = outputs[f"CoC {coc}"]["result"]
        alpha, behind = result[..., 0], result[..., 1]
        edge = width // 2 + 1
        x = np.arange(width)
        polygon = polygon_of(aperture, rotation, coc)
        wanted = edge_spread(polygon, edge - x - 0.5)
        checks.append(
            Check(
                f"alpha off from the edge spread by, CoC {coc}",
                np.abs(alpha - wanted).max(),
                0.0,
                0.5 * steepest(polygon) + WHOLE + STEP,
                HALF_PIXEL,
            )
        )
        seen = x >= edge
        through = (1.0 - alpha) * checker(size)
        checks.append(
            Check(
                f"what is in focus, off from 1 - alpha of it by, CoC {coc}",
                np.abs(behind - through)[:, seen].max(),
                0.0,
                2 * STEP,
                "it adds nothing of its own: a store of red and one of green",
            )
        )
        hidden = (x < edge) & (edge - x < 0.3 * coc)
        filled = (behind / np.maximum(1.0 - alpha, STEP))[:, hidden]
        off = 3 * STEP / (1.0 - alpha[:, hidden]).min()
        checks += [
            Check(f"darkest behind the edge, CoC {coc}", filled.min(), 0.1 - off, INFINITY, FILLED),
            Check(f"brightest behind the edge, CoC {coc}", filled.max(), -INFINITY, 0.8 + off, FILLED),
        ]
    return checks


FILLED = "what is hidden is filled with a mean of what is around, 0.1 to 0.8; three stores, over 1 - alpha"


def edge_probe(aperture: str, rotation: float) -> Probe:
    """The probe of one polygon."""
    return Probe(
        f"near-edge-{aperture}",
        f"A near edge spreads over what is in focus, {aperture}",
        "beyond the paper",
        "A soft edge as a lens makes it; the checker is sharp up to the edge, and goes on behind it.",
        tuple(edge_case(coc, aperture, rotation) for coc in EDGE_COCS),
        partial(_judge_edges, aperture, rotation),
    )


BRANCH_WIDTH, BRANCH_COC, BRANCH_SIZE = 3, 24, (80, 48)


def _branch() -> np.ndarray:
    """(W,) bool, an odd column first."""
    start = BRANCH_SIZE[0] // 2 - 1
    x = np.arange(BRANCH_SIZE[0])
    return (x >= start) & (x < start + BRANCH_WIDTH)


def branch_case() -> Case:
    """An upright near line."""
    held = np.broadcast_to(_branch(), BRANCH_SIZE[::-1])
    return near_case("branch", BRANCH_COC, held, settings())


def _judge_branch(outputs: dict[str, Outputs]) -> list[Check]:
    alpha = outputs["branch"]["result"][..., 0]
    x = np.arange(BRANCH_SIZE[0])
    first = x[_branch()][0]
    polygon = polygon_of("hexagon", 0.0, BRANCH_COC)
    after, before = (edge_spread(polygon, e - x - 0.5) for e in (first + BRANCH_WIDTH, first))
    wanted = after - before
    slope = np.abs(np.diff(wanted)).max()
    return [
        Check(
            "alpha off from the spread of the line by",
            np.abs(alpha - wanted).max(),
            0.0,
            slope + WHOLE * wanted.max() + STEP,
            "its texels of half the size reach a pixel beyond it on either side, times the steepest slope",
        ),
        Check(
            "light kept, darkest row",
            alpha.sum(axis=1).min() / BRANCH_WIDTH,
            0.99,
            1.01,
            "asked for of isolated lights",
        ),
        Check("light kept, brightest row", alpha.sum(axis=1).max() / BRANCH_WIDTH, 0.99, 1.01, "the same"),
    ]


BRANCH = Probe(
    "near-branch",
    "A thin near branch becomes a soft band",
    "beyond the paper",
    "A faint red band without grain, and the checker sharp through it.",
    (branch_case(),),
    _judge_branch,
)


# ----------------------------------------------------------------------------------------------------------------------
# isolated lights
# ----------------------------------------------------------------------------------------------------------------------

LIGHT_COCS = (-80, -24, -12, 12, 24, 80)
LIGHT_PIXELS = (1, 3, 9)
# Least overlap asked for at 80 pixels with 16 samples an edge, 2.5 pixels apart: a sample is a tent of 4 pixels, and
# more of them make dots
DOTS = {1: 0.9, 3: 0.94, 9: 0.97}


def light_label(coc: float, pixels: int) -> str:
    """Names of cases and checks."""
    return f"{pixels} px at CoC {coc}"


def light_case(coc: float, pixels: int, quality: str = "medium") -> Case:
    """A blue light over a dark far plane of its own depth, or a near one over a green checker in focus."""
    side = abs(coc) + pixels + 24
    size = side + 8, side
    color = flat(size)
    color[..., :3] = 0.01, 0.01, AMBIENT
    depth = depth_of(size, metres(coc, side) if coc > 0 else CAMERA.focus_distance)
    if coc < 0:
        color[..., 1] = checker(size)
    rows, columns = (slice((length - pixels) // 2, (length + pixels) // 2) for length in size[::-1])
    color[rows, columns, :3] = 0.0, 0.0, LIGHT + (AMBIENT if coc > 0 else 0.0)
    depth[rows, columns] = metres(coc, side)
    label = light_label(coc, pixels)
    exposure = 0.3 * abs(polygons.signed_area(polygon_of("hexagon", 0.0, coc))) / (LIGHT * pixels**2)
    return Case(label, settings(quality=quality), color, depth, exposure=exposure)


def light_spread(coc: float, pixels: int, size: tuple[int, int]) -> np.ndarray:
    """Share of the light that a lens puts on each pixel: the mean of the polygons of its pixels, (H, W)."""
    polygon = polygon_of("hexagon", 0.0, coc)
    first = [(length - pixels) // 2 for length in size]
    one = polygons.coverage(polygon, size, pixel_center(*first)) / abs(polygons.signed_area(polygon))
    moved = (np.roll(one, (row, column), (0, 1)) for row in range(pixels) for column in range(pixels))
    return sum(moved) / pixels**2


def overlap(seen: np.ndarray, wanted: np.ndarray) -> float:
    """Sum of the smaller over sum of the larger."""
    return float(np.minimum(seen, wanted).sum() / np.maximum(seen, wanted).sum())


def half_pixel_overlap(coc: float, off: float = 0.5) -> float:
    """Least overlap of a hexagon whose outline is off by so many pixels: by perimeter times that of its area."""
    polygon = polygon_of("hexagon", 0.0, coc)
    area, edge = abs(polygons.signed_area(polygon)), off * polygons.perimeter(polygon)
    return (area - edge) / (area + edge)


def _judge_lights(cases: dict[str, tuple[float, int, float | None]], outputs: dict[str, Outputs]) -> list[Check]:
    checks = []
    for label, (coc, pixels, least) in cases.items():
        blue = outputs[label]["result"][..., 2]
        total = LIGHT * pixels**2
        spread = light_spread(coc, pixels, blue.shape[::-1])
        # a near light hides what is behind it
        around = AMBIENT * (1.0 - (spread * pixels**2 if coc < 0 else 0.0))
        checks.append(Check(f"light kept, {label}", (blue - around).sum() / total, 0.99, 1.01, "asked for"))
        found = overlap((blue - around) / total, spread)
        if least is not None:
            checks.append(Check(f"overlap with the polygon, {label}", found, least, 1.0, "asked for at 16 samples"))
        elif abs(coc) < 80:
            # far light below 12.4 pixels is gathered, in rings 1/7 of the CoC apart
            off = max(0.5, coc / 14.0) if 0 < coc < 12.4 else 0.5
            why = "texels of half the size lie half a pixel off the pixels; the gather's rings are known to half a step"
            checks.append(Check(f"overlap with the polygon, {label}", found, half_pixel_overlap(coc, off), 1.0, why))
    return checks


def light_probe(pixels: int) -> Probe:
    """Lights of one size at every CoC; and at 80 pixels with more samples."""
    wanted: dict[str, tuple[float, int, float | None]] = {}
    cases = []
    for coc in LIGHT_COCS:
        cases.append(light_case(coc, pixels))
        wanted[cases[-1].label] = coc, pixels, None
    for coc in (-80, 80):
        found = light_case(coc, pixels, "high")
        label = f"{found.label}, 16 samples"
        cases.append(Case(label, found.settings, found.color, found.depth, exposure=found.exposure))
        wanted[label] = coc, pixels, DOTS[pixels]
    return Probe(
        f"layered-light-{pixels}",
        f"An isolated light of {pixels} pixels becomes a hexagon of the same light, near and far",
        "beyond the paper",
        "A hexagon over what is there, no brighter and no darker than the light; small ones at 80 pixels show dots.",
        tuple(cases),
        partial(_judge_lights, wanted),
    )


LIGHTS = tuple(light_probe(pixels) for pixels in LIGHT_PIXELS)


# ----------------------------------------------------------------------------------------------------------------------
# far lights and what is in front of them
# ----------------------------------------------------------------------------------------------------------------------

COC = 24
EDGE = 47  # first column of what is behind the silhouette: within a texel of half the size
BEHIND = 0.2
BESIDE = 8  # pixels from the silhouette to the light


def _place(column: int, size: tuple[int, int] = SIZE) -> tuple[slice, slice]:
    """Three by three pixels around a column, half-way down."""
    row = size[1] // 2
    return slice(row - 1, row + 2), slice(column - 1, column + 2)


def far_spread(column: int) -> np.ndarray:
    """Share of the light of those pixels on each pixel, (H, W)."""
    polygon = polygon_of("hexagon", 0.0, COC)
    row = SIZE[1] // 2
    centers = [pixel_center(column + i, row + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    return sum(polygons.coverage(polygon, SIZE, c) for c in centers) / 9.0 / abs(polygons.signed_area(polygon))


def silhouette_case() -> Case:
    """Green in focus on the left; on the right a grey-red far plane with a blue light."""
    sharp = np.broadcast_to(np.arange(SIZE[0]) < EDGE, SIZE[::-1])
    color, depth = flat(SIZE), depth_of(SIZE, metres(COC, SIZE[1]))
    color[..., 0] = np.where(sharp, 0.0, BEHIND)
    color[..., 1] = np.where(sharp, checker(SIZE), 0.0)
    color[_place(EDGE + BESIDE)][..., 2] = LIGHT
    depth[sharp] = CAMERA.focus_distance
    return Case("silhouette", settings(), color, depth, exposure=0.3)


def _judge_silhouette(outputs: dict[str, Outputs]) -> list[Check]:
    result = outputs["silhouette"]["result"]
    sharp, behind = result[:, :EDGE], result[:, EDGE:]
    seen = far_spread(EDGE + BESIDE)[:, EDGE:].sum() * 9.0 * LIGHT
    return [
        Check("light on the sharp side", sharp[..., 2].max(), 0.0, 0.0, "nothing behind it can be sampled there"),
        Check(
            "the sharp side, off by",
            np.abs(sharp[..., 1] / checker(SIZE).astype(np.float16)[:, :EDGE] - 1.0).max(),
            0.0,
            STEP,
            "a quotient that is 1 but for rounding, and its store",
        ),
        Check(
            "darkest behind, in units of what is there",
            behind[..., 0].min() / float(np.float16(BEHIND)),
            1 - 4 * STEP,
            1 + 4 * STEP,
            "no dark rim: a mean of one colour; the layer and its share are cut off three times, the picture once",
        ),
        Check("the silhouette's light behind it", behind[..., 1].max(), 0.0, 0.0, "it does not spread"),
        Check(
            "light behind it, in units of the polygon's part there",
            behind[..., 2].sum() / seen,
            0.99,
            2.0,
            "what the silhouette hides is taken like the rest; a pixel beside it sees half of its polygon or more",
        ),
    ]


SILHOUETTE = Probe(
    "silhouette-light",
    "A far light beside a sharp silhouette stays behind it",
    "beyond the paper",
    "The hexagon is cut off at the silhouette, without a dark rim and without a glow on the sharp side.",
    (silhouette_case(),),
    _judge_silhouette,
)


NEAR_COC = 16


def covered_case() -> Case:
    """The blue far light with red near things on the right, from 6 pixels beside it on."""
    held = np.broadcast_to(np.arange(SIZE[0]) >= EDGE + 6, SIZE[::-1])
    color, depth = flat(SIZE), depth_of(SIZE, metres(COC, SIZE[1]))
    color[..., 0] = held
    color[..., 1] = np.where(held, 0.0, BEHIND)
    color[..., 2] = np.where(held, 0.0, AMBIENT)
    color[_place(EDGE)][..., 2] += LIGHT
    depth[held] = metres(-NEAR_COC, SIZE[1])
    return Case("covered", settings(), color, depth, exposure=0.3)


def _judge_covered(outputs: dict[str, Outputs]) -> list[Check]:
    result = outputs["covered"]["result"]
    edge = EDGE + 6
    blue = result[..., 2] - result[..., 1] * (AMBIENT / BEHIND)
    x = np.arange(SIZE[0]) + 0.5
    alpha = edge_spread(polygon_of("hexagon", 0.0, NEAR_COC), x - edge)
    hidden = edge_spread(polygon_of("hexagon", 0.0, COC), x - edge)
    spread = far_spread(EDGE) * 9.0 * LIGHT
    # a ray from a pixel to the light passes the near plane on the other side of the pixel, by similar triangles
    ratio = NEAR_COC / COC
    seen = spread[:, x < (edge + (EDGE + 0.5) * ratio) / (1 + ratio)].sum()
    most = (spread * (1.0 - alpha) / np.maximum(1.0 - hidden, STEP)).sum() / seen
    return [
        Check(
            "light where the near thing covers all, in units of the light's bokeh",
            blue[:, alpha >= 1.0].max() / spread.max(),
            0.0,
            WHOLE + STEP,
            "near shares from 0.998 count as 1",
        ),
        Check(
            "light, in units of what the lens sees of it",
            blue.sum() / seen,
            0.99,
            1.01 * most,
            "a lens sees it up to a line; here it fades with the near edge, and what that hides is taken like the "
            "rest: 1 - alpha of the polygon over the share of the far plane that is in the picture",
        ),
    ]


COVERED = Probe(
    "covered-light",
    "A near thing over a far light lets it through only where the lens sees it",
    "beyond the paper",
    "The hexagon fades under the near edge, and nothing of it is where that covers all.",
    (covered_case(),),
    _judge_covered,
)


# ----------------------------------------------------------------------------------------------------------------------
# what must not change, and not jump
# ----------------------------------------------------------------------------------------------------------------------

SWEEP_STEP = 0.25
# Through the focus, and where a plane goes from the gather into the near and the far layer
SWEEPS = ((-9.75, -8.25), (-3.0, 0.0), (0.0, 3.0), (12.25, 13.75))


def patches(size: tuple[int, int], seed: int = 3) -> np.ndarray:
    """Random patches of 6 pixels, 0 to 1, (H, W, 3)."""
    random = np.random.default_rng(seed)
    width, height = size
    coarse = random.random((height // 6 + 1, width // 6 + 1, 3))
    return np.kron(coarse, np.ones((6, 6, 1)))[:height, :width]


def hills(size: tuple[int, int], seed: int = 3) -> np.ndarray:
    """Random values 6 pixels apart, with straight slopes between them, 0 to 1, (H, W, 3)."""
    width, height = size
    coarse = np.random.default_rng(seed).random((height // 6 + 2, width // 6 + 2, 3))
    for axis, length in ((0, height), (1, width)):
        place = np.arange(length) / 6.0
        first = place.astype(int)
        share = (place - first).reshape((-1, 1, 1) if axis == 0 else (1, -1, 1))
        coarse = coarse.take(first, axis) * (1.0 - share) + coarse.take(first + 1, axis) * share
    return coarse


def plane_case(coc: float, size: tuple[int, int] = (40, 32)) -> Case:
    """Hills of brightness on a plane of one depth."""
    color = flat(size)
    color[..., :3] = hills(size)
    return Case(f"CoC {coc:g}", settings(), color, depth_of(size, metres(coc, size[1])))


def jump_allowed(image: np.ndarray, first: np.ndarray, last: np.ndarray, step: float) -> float:
    """How far a pixel may change where all CoC change by `step` pixels; images (H, W, 3).

    image        the picture in focus
    first, last  the pictures at both ends of a sweep

    A lens moves what a pixel sees by half of the step at most: half the step times the largest difference of
    neighbours on each axis. A plane goes into a layer within 1.2 pixels of CoC (its share is 5 (c - 6) / 6 - 2 of the
    near layer, 5 (c - 10) / 6 - 2 of the far one). What it becomes by that, the two ends of the sweep, comes at that
    rate, or at twice that where two shares are multiplied: 0.42 of it in a quarter of a pixel. The gather's first ring,
    a pixel away, comes with a weight of 2 (r - 1/2) / max(r^2, 1/4), r half the CoC less half a pixel, against
    1/4 / max(r^2, 1/4) of the middle: a half within the first quarter. So half of it is allowed; a pop is all of it.
    """
    slopes = sum(np.abs(np.diff(image, axis=axis)).max() for axis in (0, 1))
    return float(step * 0.5 * slopes + 0.5 * np.abs(last - first).max() + 2 * STEP)


def sweep_cocs() -> list[np.ndarray]:
    """The CoC of each sweep."""
    return [np.arange(first, last + SWEEP_STEP / 2, SWEEP_STEP) for first, last in SWEEPS]


def _judge_sweep(outputs: dict[str, Outputs]) -> list[Check]:
    checks = []
    image = plane_case(0.0).color[..., :3].astype(np.float64)
    for cocs in sweep_cocs():
        pictures = [outputs[f"CoC {coc:g}"]["result"][..., :3] for coc in cocs]
        steps = [np.abs(a - b).max() for a, b in zip(pictures[:-1], pictures[1:], strict=True)]
        name = f"largest change in steps of {SWEEP_STEP} pixels, CoC {cocs[0]:g} to {cocs[-1]:g}"
        allowed = jump_allowed(image, pictures[0], pictures[-1], SWEEP_STEP)
        why = "what a lens changes, and half of all that the sweep does: the derivation is at jump_allowed"
        checks.append(Check(name, max(steps), 0.0, allowed, why))
    return checks


SWEEP = Probe(
    "layered-sweep",
    "Nothing pops as the CoC goes through zero and into the layers",
    "beyond the paper",
    "Hills that get blurred a little more from picture to picture.",
    tuple(plane_case(coc) for coc in sorted({coc for cocs in sweep_cocs() for coc in cocs})),
    _judge_sweep,
)


def constant(size: tuple[int, int], depth: np.ndarray, label: str, chosen: methods.Settings | None = None) -> Case:
    """One colour at any depth."""
    color = flat(size)
    color[..., :3] = COLOR
    return Case(label, chosen or settings(), color, depth.astype(np.float32))


COLOR = (0.7, 0.3, 40.0)
# CoC of planes: in focus, gathered, going into the near and into the far layer, in a layer
PLANES = (-24.0, -9.0, -4.0, 4.0, 13.0, 24.0)


def constant_cases() -> list[Case]:
    """Planes; random depth, each pixel and in patches."""
    size = (61, 43)
    cases = [constant(size, depth_of(size, metres(coc, size[1])), f"plane at CoC {coc:g}") for coc in PLANES]
    random = np.random.default_rng(5)
    noise = random.uniform(0.8, 30.0, size[::-1])
    wide = 0.8 + 29.0 * patches(size)[..., 0]
    return [*cases, constant(size, noise, "noise"), constant(size, wide, "patches")]


def _judge_constant(outputs: dict[str, Outputs]) -> list[Check]:
    wanted = np.array(COLOR, np.float16).astype(np.float64)
    why = "a mean of one colour: a layer and its share are cut off three times each, the picture once"
    return [
        Check(f"off by, {label}", np.abs(output["result"][..., :3] / wanted - 1.0).max(), 0.0, 4 * STEP, why)
        for label, output in outputs.items()
    ]


CONSTANT = Probe(
    "layered-constant",
    "One colour stays as it is at any depth",
    "beyond the paper",
    "A plain grey-blue everywhere: no seam between layers, tiles and gather.",
    tuple(constant_cases()),
    _judge_constant,
)


def focus_case(size: tuple[int, int] = (64, 32)) -> Case:
    """Patches with lights, all in focus; powers of two, so that a fetch in the middle of a texel is a copy."""
    color = flat(size)
    color[..., :3] = patches(size)
    color[4::9, 5::11, :3] = LIGHT
    return Case("in focus", settings(), color, depth_of(size, CAMERA.focus_distance))


def _judge_focus(outputs: dict[str, Outputs]) -> list[Check]:
    off = np.abs(outputs["in focus"]["result"][..., :3] - focus_case().color[..., :3].astype(np.float64)).max()
    return [Check("off by", off, 0.0, 0.0, "nothing spreads: the picture is copied, to the bit")]


FOCUS = Probe(
    "layered-focus",
    "What is in focus stays as it is",
    "beyond the paper",
    "The picture, to the bit.",
    (focus_case(),),
    _judge_focus,
)

EDGES = (edge_probe("hexagon", 0.0), edge_probe("octagon", 17.0))
PROBES = (*EDGES, BRANCH, *LIGHTS, SILHOUETTE, COVERED, SWEEP, CONSTANT, FOCUS)
