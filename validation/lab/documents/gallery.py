"""Draw the documents' images of market_7 and winter_3: shapes, focus, colour, controls and a focus pull."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from bokeh_validation import pictures
from bokeh_validation.drivers.base import Driver
from bokeh_validation.frame import methods
from bokeh_validation.probes import lights_apart
from bokeh_validation.probes.model import drawn as drawn_case
from bokeh_validation.reference import listings
from bokeh_validation.truth import ray_traced
from lab import captioned

CAMERA = ray_traced.MARKET.camera
# left, top, width, height: far lights on the left and near ones among leaves on the right; a corner, for lateral
# colour; lights in the middle, for axial colour
DETAIL, CORNER, MIDDLE = (626, 20, 320, 258), (660, 0, 300, 180), (330, 0, 300, 180)
NEAR = replace(CAMERA, aperture_diameter=0.17, focus_distance=1000.0)  # for lights at a distance of 8 metres
LATERAL = {"aperture": "octagon", "cut": CORNER, "preset": "ultra"}
AXIAL = {"method": "exact", "aperture": "octagon", "exposure": 1.0, "metres": 8.0, "cut": MIDDLE}
AXIAL |= {"spacing": 1.0, "samples": 65}
# change of the signed CoC for red and for blue
LENSES = {"plain lens": {"axial": (-0.005, 0.011)}, "achromat": {"axial": (-0.008, -0.008)}}

# The loop: first and last focus distance in metres, number of frames, milliseconds per frame, quality of the WebP
NEAREST, FARTHEST, PULL_FRAMES, PULL_MILLISECONDS, PULL_QUALITY = 0.9, 8.0, 24, 70, 75

# docs/artists.md: the lights and leaves at the left, smaller; the lens is f/2.8 at a bokeh scale of 4
LIGHTS = (626, 20, 240, 200)
# the farthest corner, enlarged, because a small lateral colour is one or two pixels wide
EDGES = {"cut": (810, 8, 150, 90), "zoom": 2}
# twigs near the lens, a train and a far window, where it is plain what is in focus
TRAIN = {"scene": ray_traced.WINTER, "cut": (628, 196, 304, 304)}


def wider(stop: float, scale: float, **changes: float) -> methods.Camera:
    """Return the scene's lens with another f-stop and bokeh scale."""
    return replace(CAMERA, aperture_diameter=scale * CAMERA.focal_length / stop, **changes)


# Control -> caption -> arguments of drawn()
CONTROLS = {
    "f_stop": {f"f/{stop}": {"camera": wider(stop, 4.0), "cut": LIGHTS} for stop in (8.0, 5.6, 2.8)},
    "bokeh_scale": {f"bokeh scale {scale}": {"camera": wider(2.8, scale), "cut": LIGHTS} for scale in (0.0, 1.0, 4.0)},
    "focus_distance": {
        f"focus at {metres} m": {**TRAIN, "camera": replace(ray_traced.WINTER.camera, focus_distance=metres)}
        for metres in (0.5, 1.07, 6.0)
    },
    "focus_range": {
        "no sharp range": TRAIN,
        "0.6 m behind the focus stay sharp": {**TRAIN, "focus": methods.Focus(sharp=(0.0, 0.6))},
        "near scale 0": {**TRAIN, "focus": methods.Focus(scale=(0.0, 1.0))},
    },
    "polygon": {f"{name}": {"aperture": name, "cut": LIGHTS} for name in ("square", "hexagon", "octagon", "decagon")},
    "rotation": {f"{degrees:g} degrees": {"rotation": degrees, "cut": LIGHTS} for degrees in (0.0, 15.0, 30.0)},
    "squeeze": {f"squeeze {squeeze}": {"squeeze": squeeze, "cut": LIGHTS} for squeeze in (1.0, 0.75, 0.5)},
    "cats_eye": {f"cat's eye {amount}": {"cats_eye": amount, "cut": CORNER} for amount in (0.0, 0.4, 0.8)},
    "roundness": {
        f"roundness {amount}": {"aperture": "octagon", "roundness": amount, "cut": LIGHTS} for amount in (0.0, 0.5, 1.0)
    },
    "lateral": {f"lateral colour {amount}": {**EDGES, "lateral": amount} for amount in (0.0, 0.004, 0.012)},
    "preset": {
        f"preset {name.upper()}": {"preset": name, "cut": (720, 60, 120, 100), "zoom": 2}
        for name in ("mobile", "low", "medium", "high")
    },
}

# Targets of `layered` with CoC, by what their channels hold (coc_of). Each row is one way from the map to a tile.
OF_COC = (
    {"coc": "signed", "tiles": "rg", "tiles along rows": "rg", "dilated tiles": "rg"},
    {"gather coc": "rg", "tile gather coc": "rg", "row gather coc": "rg", "gather tiles": "ba"},
    {"layer coc sums": "sums", "tile coc sums": "sums", "row coc sums": "sums", "layer coc": "rg"},
)
# targets with colour
TARGETS = (
    ("near", "near quarter", "near strip 2", "near strip 3"),
    ("far", "far quarter", "far strip 2", "far strip 3"),
    ("near blurred", "far blurred", "mid with holes", "mid fill"),
    ("far with holes", "far fill", "result"),
)
# file -> rows of images: caption -> arguments of drawn()
PICTURES = {
    "gallery_shapes": [
        {name: {"aperture": name, "cut": DETAIL} for name in ("square", "hexagon", "octagon")},
        {
            "decagon": {"aperture": "decagon", "cut": DETAIL},
            "star (paper, 33 samples a line)": {"method": "paper", "aperture": "star", "samples": 33, "cut": DETAIL},
            "anamorphic: hexagon, squeeze 0.5": {"squeeze": 0.5, "cut": DETAIL},
        },
    ],
    "gallery_focus": [
        {
            "near: focus on the leaves, 1 m": {"camera": replace(CAMERA, focus_distance=1.0), "exposure": 1.1},
            "far: focus on the street, 8 m": {"camera": replace(CAMERA, focus_distance=8.0), "exposure": 2.2},
        },
    ],
    "character_color": [
        {"no lateral colour": LATERAL}
        | {f"axial colour, {lens}: far lights": AXIAL | axial for lens, axial in LENSES.items()},
        {"lateral colour, 0.01": {**LATERAL, "lateral": 0.01}}
        | {f"axial colour, {lens}: near lights": AXIAL | axial | {"camera": NEAR} for lens, axial in LENSES.items()},
    ],
    **{f"control_{name}": [views] for name, views in CONTROLS.items()},
    "layers": [{name: {"target": name, "width": 240} for name in names} for names in TARGETS],
    "layers_coc": [
        {name: {"target": name, "width": 240, "channels": kind} for name, kind in row.items()} for row in OF_COC
    ],
}

# CoC in pixels that is shown at full brightness
MAX_SHOWN_COC = 64.0


def coc_of(texture: np.ndarray, channels: str) -> np.ndarray:
    """Return the near CoC in red and the far CoC in green of a target (H, W, 4), as 8-bit rgb. 64 pixels are shown at
    full brightness, and a quarter of that at half.

    channels  "rg", "ba": they hold the near and the far CoC, pixels
              "signed": alpha holds the signed CoC of the map, fraction of the image height
              "sums": CoC / 8 times weight and weight, of the near and of the far layer
    """
    if channels == "signed":
        signed = texture[..., 3] * texture.shape[0]
        near, far = -signed, signed
    elif channels == "sums":
        weights = np.maximum(texture[..., 1::2], 1e-6)
        near, far = np.moveaxis(np.where(texture[..., 1::2] > 1e-4, 8.0 * texture[..., ::2] / weights, 0.0), -1, 0)
    else:
        near, far = (texture[..., "rgba".index(channel)] for channel in channels)
    shown = np.sqrt(np.clip(np.stack([near, far, 0.0 * near], axis=-1) / MAX_SHOWN_COC, 0.0, 1.0))
    return (255.0 * shown).astype(np.uint8)


def drawn(
    driver: Driver, method: str = "layered", aperture: str = "hexagon", exposure: float = 1.6,
    scene: ray_traced.SceneFile = ray_traced.MARKET, metres: float | None = None,
    cut: tuple[int, int, int, int] | None = None, zoom: int = 1, axial: tuple[float, float] = (0.0, 0.0),
    target: str = "result", width: int = 480, channels: str = "color", **changes,
) -> np.ndarray:  # fmt: skip
    """Draw a scene as 8-bit rgb (H, W, 3), cropped or scaled.

    metres    a constant depth instead of the scene's
    cut       left, top, width, height of a crop, pixels; None: the whole image, scaled to about `width` pixels
    zoom      factor by which a crop is enlarged
    axial     shift of the map's CoC for red and for blue: the frame is drawn three times, for one channel each
    target    texture to show
    channels  what they hold: "color", or one of `coc_of`
    changes   of the settings
    """
    case = ray_traced.scene_case(scene, method, aperture)
    depth = case.depth if metres is None else np.full_like(case.depth, metres)
    case = replace(case, depth=depth, settings=replace(case.settings, **changes))
    (first, *later_passes), textures = case.plan.passes, case.textures()
    coc = driver.run([first], textures, case.size, keep=("coc",))["coc"]
    results = {}
    for shift in {axial[0], 0.0, axial[1]}:
        shifted = coc + np.float16([0.0, 0.0, 0.0, shift])
        inputs = {**textures, "coc": shifted}
        kept = shifted if target == "coc" else driver.run(later_passes, inputs, case.size, keep=(target,))[target]
        results[shift] = kept
    if channels == "color":
        by_channel = [results[shift][..., k] for k, shift in enumerate((axial[0], 0.0, axial[1]))]
        pixels = pictures.filmic(np.stack(by_channel, axis=-1), exposure)
    else:
        pixels = coc_of(results[0.0].astype(np.float64), channels)
    while not cut and pixels.shape[1] <= width // 2:
        pixels = pixels.repeat(2, axis=0).repeat(2, axis=1)
    while not cut and pixels.shape[1] > width:
        pixels = captioned.halved(pixels)
    return captioned.enlarged(captioned.crop(pixels, *cut), zoom) if cut else pixels


def pull(driver: Driver) -> list[np.ndarray]:
    """Draw a focus pull from the leaves to the street and back, 8-bit rgb; even in 1 / distance, slower at the ends."""
    way = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, PULL_FRAMES))
    distances = 1.0 / (1.0 / NEAREST + way * (1.0 / FARTHEST - 1.0 / NEAREST))
    forward = [drawn(driver, camera=replace(CAMERA, focus_distance=float(metres))) for metres in distances]
    return [*forward, *forward[-2:0:-1]]


def sources(name: str) -> tuple[Path, ...]:
    """Return the pinhole images of the scenes that one of PICTURES shows."""
    scenes = {view.get("scene", ray_traced.MARKET) for row in PICTURES[name] for view in row.values()}
    return tuple(sorted(scene.source for scene in scenes))


def gallery(driver: Driver, name: str) -> dict[str, np.ndarray]:
    """Draw one of PICTURES."""
    panels = [
        [captioned.Captioned(drawn(driver, **view), caption) for caption, view in row.items()] for row in PICTURES[name]
    ]
    return {name: captioned.grid(panels)}


# A pane of glass: color, metres, and the part of the image that is shown, as left, top, width, height
GLASS, METRES, PANE = (0.10, 0.16, 0.20), 0.9, (500, 140, 320, 300)


def pane(size: tuple[int, int]) -> np.ndarray:
    """Return the opacity of the pane of glass in an image, (H, W): faint, with a dense rim."""
    width, height = size
    rows, columns = np.mgrid[0:height, 0:width] / height
    across, down = (np.abs(columns - 1.25) - 0.2).clip(0.0), (np.abs(rows - 0.55) - 0.2).clip(0.0)
    outside = np.hypot(across, down)
    return np.where(outside < 0.02, 0.3, np.where(outside < 0.035, 0.8, 0.0))


def opacity(driver: Driver) -> dict[str, np.ndarray]:
    """Draw glass in market_7 without depth, with depth, and with depth weighted by opacity."""
    case = ray_traced.scene_case(ray_traced.MARKET, "layered", "hexagon")
    (first, *later_passes), textures = case.plan.passes, case.textures()
    color, behind = textures["color"].astype(np.float64), textures["depth"].astype(np.float64)
    alpha = np.where(behind > METRES, pane(case.size), 0.0)
    color[..., :3] += alpha[..., None] * (np.array(GLASS) - color[..., :3])
    weighted = np.stack([behind + alpha * (METRES - behind), np.ones_like(behind), 0 * behind, 0 * behind], axis=-1)
    panels = []
    for caption, depth, kind in (
        ("the glass writes no depth", behind, 0),
        ("the glass writes depth", np.where(alpha > 0.0, METRES, behind), 0),
        ("depth weighted by opacity", weighted, listings.WEIGHTED),
    ):
        inputs = {**textures, "color": color.astype(np.float16), "depth": depth.astype(np.float32)}
        map_pass = replace(first, parameters={**first.parameters, "BokehDepthKind": float(kind)})
        result = driver.run([map_pass, *later_passes], inputs, case.size)["result"]
        panels.append(captioned.Captioned(captioned.crop(pictures.filmic(result[..., :3], 1.6), *PANE), caption))
    return {"opacity": captioned.grid([panels])}


# The part of market_7 with many lights, for stores that want a square icon
ICON = (776, 72, 176, 176)


def icon(driver: Driver) -> dict[str, np.ndarray]:
    """Draw the icon that Godot's asset library asks for: lights of market_7."""
    return {"icon": drawn(driver, cut=ICON)}


# Lights over a plane of CoC 40, one blurred less and one blurred more, by method and polygon
APART = (("exact", "hexagon"), ("exact", "octagon"), ("exact", "square"), ("layered", "hexagon"))
APART_LIGHTS = (lights_apart.Apart(27, 4), lights_apart.Apart(60, 4))


def apart(driver: Driver) -> dict[str, np.ndarray]:
    """Draw lights whose CoC differs from their background's, to show which methods keep them flat and in the right
    size.
    """
    panels = []
    for light in APART_LIGHTS:
        # brightness of a flat polygon of the light's own size
        plateau = lights_apart.LIGHT * light.pixels**2 / (0.65 * light.coc**2)
        row = []
        for method, aperture in APART:
            result = drawn_case(driver, light.case(lights_apart.settings(method, aperture)))
            blue = (result[..., 2] - lights_apart.AMBIENT) / plateau
            grey = pictures.display(np.repeat(0.3 * blue[28:100, 28:100, None].clip(0.0), 3, axis=-1))
            caption = f"{method}, {aperture}: CoC {light.coc:g} on 40"
            row.append(captioned.Captioned(captioned.enlarged(grey, 3), caption))
        panels.append(row)
    return {"lights_apart": captioned.grid(panels)}
