"""Measure how much a method flickers where the truth does not, and how near it is to the truth at moderate blur."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from bokeh_validation import drivers, metrics, pictures, terminal
from bokeh_validation.drivers.base import Driver
from bokeh_validation.frame.methods import plan, steadied
from bokeh_validation.probes.model import Case
from bokeh_validation.reference import sampling
from bokeh_validation.truth import labels
from lab import captioned, jobs
from lab.captioned import Captioned
from lab.rasterised import faults
from lab.rasterised.rasteriser import Pinhole, Rasteriser, places_in_pixel
from lab.rasterised.sequences import MODERATE, MOTIONS, moment, street

SIZE, POINTS, FRAMES = (480, 270), 384, 24
# Temporal anti-aliasing: number of frames to settle before the first measured one, weight of the newest frame, and the
# sample positions in a pixel, in order
LEAD, SHARE, PLACES = 16, 0.1, places_in_pixel(8)[[0, 4, 2, 6, 1, 5, 3, 7]].tolist()
# Sequences, and the name for moderate blur without motion
AT_REST = "moderate"
NAMES = (*MOTIONS, AT_REST)
KNOWN = labels.METHODS + labels.JITTERED
DEFAULT = (
    "pinhole", "paper", "exact", "layered low", "layered medium", "layered medium, jitter",
    "layered high", "layered ultra",
)  # fmt: skip
INPUTS = ("aliased", "antialiased", "temporal, before", "temporal, after", "before, steady")
ALIASED, ANTIALIASED, *_, STEADY = INPUTS
# The animation: left, top, width, height of a detail, and its zoom; milliseconds per frame; quality of the WebP
DETAIL, ZOOM, MILLISECONDS, QUALITY = (240, 20, 170, 130), 2, 80, 80
SHOWN = {"pinhole": "input", "paper": "paper", "layered medium": "layered, preset MEDIUM"}


class Recording(NamedTuple):
    """Hold a sequence.

    aliased      one colour sample per pixel, in the middle
    antialiased  many samples per pixel
    jittered     one sample per pixel at a position that differs by frame, starting LEAD frames earlier
    stable       `jittered` after temporal anti-aliasing, linear (H, W, 3)
    truth        linear (H, W, 3)
    """

    aliased: list[Pinhole]
    antialiased: list[Pinhole]
    jittered: list[Pinhole]
    stable: list[np.ndarray]
    truth: list[np.ndarray]


def recorded(name: str, rasteriser: Rasteriser, frames: int) -> Recording:
    """Draw one of sequences.MOTIONS."""
    recording = Recording([], [], [], [], [])
    for frame in range(-LEAD, frames):
        scene, previous = moment(name, frame), moment(name, frame - 1)
        recording.jittered.append(rasteriser.pinhole(scene, previous, place=PLACES[frame % len(PLACES)]))
        if frame >= 0:
            recording.aliased.append(rasteriser.pinhole(scene, previous))
            recording.antialiased.append(rasteriser.pinhole(scene, previous, antialiased=True))
            recording.truth.append(rasteriser.lens(scene).color)
    stable = resolved([pinhole.color for pinhole in recording.jittered], recording.jittered)
    return recording._replace(stable=list(stable)[LEAD:])


def resolved(frames: Iterable[np.ndarray], pinholes: Iterable[Pinhole]) -> Iterator[np.ndarray]:
    """Apply plain temporal anti-aliasing to linear frames (H, W, >= 3).

    The history, fetched from where each pixel was, is clamped to the range of the newest 3 x 3 pixels and blended with
    the newest frame, whose weight is SHARE; the first frames are averaged.
    """
    history = None
    for number, (image, pinhole) in enumerate(zip(frames, pinholes, strict=True), 1):
        color = np.maximum(image[..., :3].astype(np.float64), 0.0)
        # compress the range, so that lights do not outweigh everything else
        color /= 1.0 + color.max(axis=-1, keepdims=True)
        y, x = np.indices(color.shape[:2]) + 0.5
        history = color if history is None else history
        history = sampling.bilinear(history, x - pinhole.moved[..., 0], y - pinhole.moved[..., 1])
        history = np.clip(history, faults.around(color, 1, np.min), faults.around(color, 1, np.max))
        history += max(SHARE, 1.0 / number) * (color - history)
        yield history / (1.0 - history.max(axis=-1, keepdims=True))


def results(driver: Driver, name: str, label: str, recording: Recording) -> dict[str, list[np.ndarray]]:
    """Draw a sequence with a method; returns input -> linear frames. STEADY is included for methods with a signed CoC
    map.
    """

    def drawn(pinholes: Sequence[Pinhole], colors: Iterable[np.ndarray], first: int = 0) -> list[np.ndarray]:
        images = []
        for frame, (pinhole, color) in enumerate(zip(pinholes, colors, strict=True), first):
            settings = labels.settings(label, moment(name, frame).camera, frame=frame % 64)
            rgba = np.dstack([color[..., :3], np.ones_like(pinhole.depth)]).astype(np.float16)
            images.append(labels.picture(driver, label, Case(name, settings, rgba, pinhole.depth))[..., :3])
        return images

    aliased, antialiased, jittered = (
        drawn(sequence, [p.color for p in sequence], len(recording.truth) - len(sequence)) for sequence in recording[:3]
    )
    from_resolved = drawn(recording.jittered[LEAD:], recording.stable)
    resolved_results = list(resolved(jittered, recording.jittered))[LEAD:]
    frames_by_input = dict(zip(INPUTS, (aliased, antialiased, from_resolved, resolved_results), strict=False))
    signed = label.startswith(("exact", "layered"))
    return frames_by_input | {STEADY: list(_steady(driver, name, label, recording))} if signed else frames_by_input


def _steady(driver: Driver, name: str, label: str, recording: Recording) -> Iterator[np.ndarray]:
    """Yield a method's results from resolved colour and jittered depth, with BokehStableMap after its CoC map."""
    size = recording.stable[0].shape[1::-1]
    colors, history = [pinhole.color for pinhole in recording.jittered[:LEAD]] + recording.stable, None
    for frame, (pinhole, color) in enumerate(zip(recording.jittered, colors, strict=True), -LEAD):
        settings = labels.settings(label, moment(name, frame).camera, frame=frame % 64)
        passes = steadied(plan(settings, size), size, 1.0 if history is None else 0.0).passes
        rgba = np.dstack([color[..., :3], np.ones_like(pinhole.depth)]).astype(np.float16)
        velocity = np.dstack([pinhole.moved / size, np.zeros_like(pinhole.moved)]).astype(np.float16)
        textures = {"color": rgba, "depth": pinhole.depth, "velocity": velocity}
        textures["history"] = np.zeros_like(rgba) if history is None else history
        needed_passes, kept_targets = (passes, ("coc", "result")) if frame >= 0 else (passes[:2], ("coc",))
        outputs = driver.run(needed_passes, textures, size, keep=kept_targets)
        history = outputs["coc"]
        if frame >= 0:
            yield outputs["result"][..., :3]


def flicker(frames: Sequence[np.ndarray], truth: Sequence[np.ndarray]) -> dict[str, tuple[float, float]]:
    """Return mean and 99th percentile over the pixels of the error's variation, in 1/255 of display values.

    frames     linear, (H, W, 3) each
    truth      display values, (H, W, 3) each
    deviation  standard deviation over the frames, of a pixel's worst channel
    change     largest change from one frame to the next
    """
    error = 255.0 * np.stack(
        [faults.display(frame) - displayed for frame, displayed in zip(frames, truth, strict=True)]
    )
    values = {"deviation": error.std(axis=0).max(axis=-1), "change": np.abs(np.diff(error, axis=0)).max(axis=-1)}
    return {name: (float(value.mean()), float(np.percentile(value, 99))) for name, value in values.items()}


def measured(
    name: str, methods: Sequence[str], driver: str, adapter: str | None = None,
    size: tuple[int, int] = SIZE, points: int = POINTS, frames: int = FRAMES,
) -> tuple[list[dict], list[np.ndarray]]:  # fmt: skip
    """Measure a sequence; returns rows, and its animation as 8-bit rgb, which is empty unless methods include all of
    SHOWN.
    """
    active_driver = drivers.load(driver, adapter)
    recording = recorded(name, Rasteriser(size, points, active_driver), frames)
    truth, rows, antialiased_frames = list(map(faults.display, recording.truth)), [], {}
    for label in methods:
        frames_by_input = results(active_driver, name, label, recording)
        rows += [
            {"scene": name, "label": label, "input": kind} | flicker(images_of_kind, truth)
            for kind, images_of_kind in frames_by_input.items()
        ]
        antialiased_frames[label] = frames_by_input[ANTIALIASED]
    if not set(SHOWN) <= set(antialiased_frames):
        return rows, []
    panels = {caption: antialiased_frames[label] for label, caption in SHOWN.items()} | {"truth": recording.truth}
    return rows, [
        _side_by_side(dict(zip(panels, images, strict=True))) for images in zip(*panels.values(), strict=True)
    ]


def _side_by_side(images: Mapping[str, np.ndarray]) -> np.ndarray:
    cropped = {caption: captioned.crop(image, *DETAIL) for caption, image in images.items()}
    panels = [
        Captioned(captioned.enlarged(pictures.filmic(v, faults.RANDOM_EXPOSURE), ZOOM), k) for k, v in cropped.items()
    ]
    return captioned.grid([panels[:2], panels[2:]])


def moderate(
    place: tuple[int, float, float], methods: Sequence[str], driver: str, adapter: str | None = None
) -> tuple[list[dict], list]:
    """Return rows for one of sequences.MODERATE: FLIP from both inputs."""
    active_driver = drivers.load(driver, adapter)
    rasteriser, scene, rows = Rasteriser(SIZE, POINTS, active_driver), street(*place), []
    truth = rasteriser.lens(scene).color
    for kind in (ALIASED, ANTIALIASED):
        pinhole = rasteriser.pinhole(scene, antialiased=kind == ANTIALIASED)
        for label in methods:
            case = Case(kind, labels.settings(label, scene.camera), pinhole.color, pinhole.depth)
            error = metrics.flip(labels.picture(active_driver, label, case), truth)
            rows.append({"scene": AT_REST, "place": place, "label": label, "input": kind, "flip": error})
    return rows, []


def table(rows: Sequence[Mapping]) -> list[str]:
    """Return a table per scene, with a row per method and a column per input: FLIP, or deviation and change, mean /
    99th.
    """
    lines: list[str] = []
    for name in dict.fromkeys(row["scene"] for row in rows):
        scene_rows = [row for row in rows if row["scene"] == name]
        inputs = list(dict.fromkeys(row["input"] for row in scene_rows))
        lines += ["", f"| {name} | {' | '.join(inputs)} |", "|---" * (len(inputs) + 1) + "|"]
        for label in dict.fromkeys(row["label"] for row in scene_rows):
            cells = [[row for row in scene_rows if (row["label"], row["input"]) == (label, kind)] for kind in inputs]
            lines.append(f"| {label} | {' | '.join(map(_cell, cells))} |")
    return lines[1:]


def _cell(rows: Sequence[Mapping]) -> str:
    if not rows:
        return "-"
    if "flip" in rows[0]:
        return f"{np.mean([row['flip'] for row in rows]):.4f}"
    return ", ".join("{:.1f}/{:.0f}".format(*rows[0][name]) for name in ("deviation", "change"))


def chosen(name: str | None) -> list[str]:
    """Return the sequences that --motion names. Raises UserError."""
    names = terminal.chosen("--motion", [name or "all"], [*NAMES, "all"])
    return list(NAMES) if names == ["all"] else names


def report(
    methods: Sequence[str], driver: str, adapter: str | None, names: Sequence[str]
) -> tuple[list[dict], list[str]]:
    """Measure sequences in several processes; returns rows and their table."""
    work = [(measured, (name, methods, driver, adapter)) for name in names if name in MOTIONS]
    work += [(moderate, (place, methods, driver, adapter)) for place in MODERATE] if AT_REST in names else []
    with terminal.progress("truth", len(work)) as step:
        results_by_job = jobs.run(work, step)
    rows = [row for job_rows, _ in results_by_job for row in job_rows]
    explained = "Error, 1/255: deviation over the frames, change between frames; mean / 99th percentile of the pixels."
    return rows, [*table(rows), f"{explained} {AT_REST}: FLIP"]
