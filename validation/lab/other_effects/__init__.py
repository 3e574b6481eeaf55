"""Compare other depth-of-field effects with this package and the ray-traced truth: the command
`validation/run peers`.
"""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from PIL import Image

from bokeh_validation import drivers, metrics, pictures, terminal, truth
from bokeh_validation.errors import UserError
from bokeh_validation.frame import geometry
from bokeh_validation.frame.methods import Camera
from bokeh_validation.probes.highlight import AMBIENT, PEAK
from bokeh_validation.probes.model import Case, depth_of, overlap, pixel_center
from bokeh_validation.probes.shapes import outline
from bokeh_validation.truth import ray_traced
from lab import captioned, jobs, ray_traced_score
from lab.other_effects import timing
from lab.other_effects.effects import EFFECTS, FOUND, ONE_LIGHT, OPTIONS, Page, Parameters, documented, title
from lab.rasterised import faults, motion
from lab.rasterised.rasteriser import Rasteriser
from lab.rasterised.sequences import MOTIONS, moment

OURS = ("paper", "exact", "layered low", "layered medium")
DRIVER = "webgl2"  # the same device as the other effects
# One light of 3 x 3 pixels, so far away that its circle of confusion is the one at infinity, 34 pixels
LIGHT, FAR = 3, 10000.0
LIGHT_SIZE, LIGHT_COC = (270, 270), 34
LIGHT_CAMERA = Camera(LIGHT_COC / 270 * 0.024 * 2.37 / 0.05, 0.05, 2.42, 0.024, 0.15)
# A search compares images at a quarter of their size; factors by which it changes a parameter
SMALLER, STEPS = 4, (0.5, 0.8)
# Number of scenes per page; a browser keeps 16 contexts
CONTEXTS = 12
# Detail of a scene that is shown: left and top
PLACES, DETAIL = {"market_7": (30, 200), "street_11": (200, 110), "canopy_12": (100, 100)}, (300, 200)


def search(page: Page, effect: str, start: Parameters, lens: np.ndarray) -> Parameters:
    """Return the parameters with the lowest FLIP, changing each number and option as long as that improves it.

    page    an open page with the scene
    start   initial parameters, from the documentation
    lens    the truth, (H, W, 3), reduced()
    """
    options = [{name: value} for name in start if name in OPTIONS for value in OPTIONS[name]]
    best, lowest_flip = start, np.inf
    for step in STEPS:
        previous = None
        while previous != best:
            previous = best
            trials = [{name: best[name] * factor} for name in EFFECTS[effect][2] for factor in (step, 1 / step)]
            for trial in [{}, *trials, *options]:
                if (flip := metrics.flip(reduced(page.draw(effect, best | trial)), lens)) < lowest_flip:
                    best, lowest_flip = best | trial, flip
    return best


def reduced(image: np.ndarray) -> np.ndarray:
    """Scale an image (H, W, >= 3) down for search(), because FLIP takes longer than an effect."""
    return np.dstack([Image.fromarray(image[..., at].astype(np.float32)).reduce(SMALLER) for at in range(3)])


def of_scene(name: str, effects: list[str], anew: bool) -> tuple[list[dict], np.ndarray, dict[str, Parameters]]:
    """Measure a scene with effects and this package's methods.

    effects  names of the effects
    anew     whether to search for their parameters
    Returns rows, a detail of the scene by every effect as 8-bit rgb, and the effects' parameters.
    """
    (file,) = ray_traced.chosen([name])
    picture, lens = ray_traced.picture(file), ray_traced.truth(file, "hexagon")
    start, small = documented(file.camera, picture.depth.shape), reduced(lens)
    with Page(effects) as page:
        page.load(picture.color, picture.depth, file.camera)
        parameters = {key: search(page, key, start[key], small) if anew else FOUND[name][key] for key in effects}
        images = {title(key): page.draw(key, values) for key, values in parameters.items()}
    images |= {label: truth.picture(drivers.load(DRIVER), file, label) for label in OURS}
    rows = [{"scene": name, "label": label, **truth.measured(image, lens)} for label, image in images.items()]
    exposure, corner = truth.EXPOSURE.get(name, 1.0), PLACES.get(name.removesuffix("x3"), (0, 0))
    details = [
        captioned.Captioned(captioned.crop(pictures.filmic(image, exposure), *corner, *DETAIL), label)
        for label, image in (images | {"truth": lens}).items() if label not in OURS[:-1]
    ]  # fmt: skip
    width = 3 if len(details) > 4 else 2
    return rows, captioned.grid([details[at : at + width] for at in range(0, len(details), width)]), parameters


def of_light(found_for: str, effects: list[str]) -> list[tuple[float, float]]:
    """Draw one light with effects and this package's methods.

    Returns for each its overlap with the aperture (probes.model.overlap, with both scaled to the same light), and the
    fraction of its light that is kept.
    """
    first_pixel = [(side - LIGHT) // 2 for side in LIGHT_SIZE]
    color = np.full((*LIGHT_SIZE[::-1], 4), AMBIENT, np.float16)
    color[first_pixel[1] : first_pixel[1] + LIGHT, first_pixel[0] : first_pixel[0] + LIGHT] = PEAK
    depth = depth_of(LIGHT_SIZE, FAR)
    light_before = (color[..., 1].astype(np.float64) - AMBIENT).sum()
    hexagon = LIGHT_COC * outline(truth.case(ray_traced.MARKET, "exact").settings)
    blurred = geometry.coverage(hexagon, LIGHT_SIZE, pixel_center(*(side // 2 for side in LIGHT_SIZE)))
    reach = range(-(LIGHT // 2), LIGHT // 2 + 1)
    expected = sum(np.roll(blurred, (y, x), (0, 1)) for y in reach for x in reach)
    with Page(effects) as page:
        page.load(color, depth, LIGHT_CAMERA)
        images = [page.draw(name, FOUND[found_for][name]) for name in effects]
    for label in OURS:
        case = Case("", replace(truth.case(ray_traced.MARKET, label).settings, camera=LIGHT_CAMERA), color, depth)
        images.append(drivers.load(DRIVER).run(case.plan.passes, case.textures(), LIGHT_SIZE)["result"])
    lights = [image[..., 1].astype(np.float64) - AMBIENT for image in images]
    return [(overlap(light / light.sum(), expected / expected.sum()), light.sum() / light_before) for light in lights]


def in_motion(effects: list[str], name: str) -> list[dict]:
    """Return rows for one of MOTIONS, from its antialiased input; parameters are searched on the first frame."""
    recording, rows = motion.recorded(name, Rasteriser(motion.SIZE, motion.POINTS), motion.FRAMES), []
    displayed_truth = list(map(faults.display, recording.truth))
    cameras = [moment(name, frame).camera for frame in range(motion.FRAMES)]
    start = documented(cameras[0], displayed_truth[0].shape[:2])
    frames = list(zip(recording.antialiased, cameras, strict=True))
    with terminal.progress("peers", len(effects)) as step:
        for key in effects:
            images, parameters = [], {}
            for at in range(0, len(frames), CONTEXTS):
                with Page([key]) as page:
                    for pinhole, camera in frames[at : at + CONTEXTS]:
                        page.load(pinhole.color, pinhole.depth, camera)
                        parameters = parameters or search(page, key, start[key], reduced(recording.truth[0]))
                        names = (*EFFECTS[key][2], *OPTIONS)
                        tuned = {option: parameters[option] for option in names if option in parameters}
                        result = page.draw(key, documented(camera, pinhole.depth.shape)[key] | tuned)
                        images.append(result[..., :3])
            rows.append({"scene": name, "label": title(key), "input": motion.ANTIALIASED})
            rows[-1] |= {"parameters": parameters} | motion.flicker(images, displayed_truth)
            step(title(key))
    return rows


def in_time(effect: list[str] | None, scene: list[str] | None, json_file: Path | None) -> None:
    """Time effects and this package's methods, print a table, and write it as JSON; arguments as for peers()."""
    names = timing.chosen(terminal.chosen("--effect", effect, EFFECTS, timing.OTHERS))
    (of,) = ray_traced.chosen(scene or [ray_traced.MARKET.name])
    terminal.check_writable(json_file)
    with terminal.progress("peers", 1 + timing.ROUNDS) as step:
        found = timing.measured(of, names, step)
    terminal.write_json(json_file, found)
    terminal.tell(*timing.table(found))


def peers(
    effect: Annotated[list[str] | None, typer.Option(help="May be given again. Default: all.")] = None,
    scene: Annotated[
        list[str] | None, typer.Option(help="A scene of validation/scenes; may be given again. Default: all.")
    ] = None,
    found: Annotated[
        Path | None, typer.Option("--search", metavar="FILE", help="Search the scenes' parameters; write them as JSON.")
    ] = None,
    sequence: Annotated[
        str | None, typer.Option("--motion", metavar="NAME", help=f"Flicker alone, as truth's: {', '.join(MOTIONS)}.")
    ] = None,
    time: Annotated[
        bool, typer.Option("--time", help="Times alone, with ours, on WebGL 2. Default scene: market_7.")
    ] = False,
    json_file: terminal.JsonFile = None,
) -> None:
    """Compare other depth-of-field effects with the truth (docs/results.md): FLIP, PSNR, light; one light."""
    if time:
        if found or sequence or len(scene or ()) > 1:
            raise UserError("--time: times one scene. Leave out --search, --motion and all other scenes.")
        return in_time(effect, scene, json_file)
    if json_file:
        raise UserError("--json: no effect without --time. Give both.")
    effects = terminal.chosen("--effect", effect, EFFECTS)
    scenes = [file.name for file in ray_traced.chosen(scene)]
    terminal.check_writable(found)
    for name in scenes:
        if found is None and name not in FOUND:
            raise UserError(
                f"--scene {name}: it has no parameters yet. Give --search FILE, and put them into found.json"
            )
    sequences = terminal.chosen("--motion", sequence and [sequence], MOTIONS)
    if sequence and (scene or found):
        raise UserError(f"--motion {sequence}: it draws none of the scenes. Leave out --scene and --search.")
    Page(effects).close()  # report missing programs before any work
    if sequence is not None:
        terminal.tell(*motion.table(in_motion(effects, sequences[0])), drivers.load(DRIVER).adapter)
        return
    work = [(of_scene, (name, effects, found is not None)) for name in scenes] + [(of_light, (ONE_LIGHT, effects))]
    with terminal.progress("peers", len(work)) as step:
        *drawings, lights = jobs.run(work, step)
    terminal.write_json(found, {name: chosen for name, (_, _, chosen) in zip(scenes, drawings, strict=True)})
    ends = [ONE_LIGHT, "---", *(f"{shape:.2f}, {light_kept:.2f}" for shape, light_kept in lights)]
    table = ray_traced_score.markdown([row for rows, _, _ in drawings for row in rows])
    terminal.tell(*(f"{line} {end} |" for line, end in zip(table, ends, strict=True)), drivers.load(DRIVER).adapter)
