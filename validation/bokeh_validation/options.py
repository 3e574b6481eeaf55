"""Define the options that say what to render, in one table that `render`, `plan` and `compare` share."""

import inspect
import json
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import wraps
from pathlib import Path
from typing import Annotated

import typer

from bokeh_validation.errors import UserError
from bokeh_validation.frame import aperture_shapes, methods
from bokeh_validation.frame.methods import Camera, Focus, Settings
from bokeh_validation.shaders.parameters import PARAMETERS

# Most offsets of a kernel, which is a row of texels: every device of the last fifteen years supports a width of 8192.
MAX_KERNEL = 8192
MAX_SAMPLES = 1024
# Values of the options that are not given on the command line
F_STOP, BOKEH_SCALE = 2.8, 10.0
DEFAULT = Settings("layered", camera=Camera(Camera.focal_length / F_STOP * BOKEH_SCALE))
INF, TINY = math.inf, math.ulp(0.0)
KEYWORD = inspect.Parameter.KEYWORD_ONLY
Needs = tuple[Callable[[Settings], bool], str, str]


@dataclass(frozen=True)
class Option:
    """Describe an option of the command line and the setting that it changes.

    name     `--name`; a switch also has `--no-name`
    field    of methods.Settings: 'squeeze', or 'camera.max_coc' for a field of its camera
    kind     str, int, float, or bool for a switch
    help     for --help
    allowed  the words it takes; or the minimum and maximum of a number and the same in words
    methods  the methods that it has an effect on
    needs    a test of the settings, why the option has no effect if that fails, and what to do
    """

    name: str
    field: str
    kind: type
    help: str
    allowed: tuple = ()
    methods: tuple[str, ...] = aperture_shapes.METHODS
    needs: Needs | None = None

    @property
    def parameter(self) -> inspect.Parameter:
        """Return the parameter of a command's function; its value is None if the option was not given."""
        names = f"--{self.name}/--no-{self.name}" if self.kind is bool else f"--{self.name}"
        default = "" if self.value(DEFAULT) is None else f" [default: {self.told(DEFAULT).split()[-1]}]"
        annotation = Annotated[self.kind | None, typer.Option(names, help=self.help + default, show_default=False)]
        return inspect.Parameter(self.name.replace("-", "_"), KEYWORD, default=None, annotation=annotation)

    def value(self, settings: Settings) -> object:
        """Return the value that the settings have for this option."""
        owner, _, member = self.field.partition(".")
        owner_value = getattr(settings, owner)
        return getattr(owner_value, member) if member else owner_value

    def put(self, settings: Settings, value: object) -> Settings:
        """Return the settings with another value for this option."""
        owner, _, member = self.field.partition(".")
        if member:
            value = replace(getattr(settings, owner), **{member: value})
        return replace(settings, **{owner: value})

    def told(self, settings: Settings) -> str:
        """Return the option with its value as typed on a command line."""
        value = self.value(settings)
        if self.kind is bool:
            return f"--{self.name}" if value else f"--no-{self.name}"
        return f"--{self.name} {value:g}" if self.kind is float else f"--{self.name} {value}"


ANY, POSITIVE, NOT_NEGATIVE = (-INF, INF, "any finite number"), (TINY, INF, "more than 0"), (0, INF, "0 or more")
UNIT, HEIGHTS = (0, 1, "0 to 1"), (0, 1, "0 to 1, a fraction of the image height")
LENS: Needs = (lambda s: s.coc is None, "with --coc, which is the CoC everywhere", "Leave one of them out")
NOISE: Needs = (
    lambda s: s.method != "paper" or s.spacing or s.aperture in aperture_shapes.POLYGONS,
    "on paper's fixed number of samples", "Give --spacing as well, or leave it out",
)  # fmt: skip
PRESET: Needs = (lambda s: s.method != "layered", "on layered, whose samples come from a preset", "Give --preset")
EITHER: Needs = (
    lambda s: s.method == "layered" or s.has_preset, "with --samples or --spacing, which a preset sets",
    "Leave it or them out",
)  # fmt: skip
OCTAGON: Needs = (lambda s: s.aperture == "octagon", "on other polygons", "Give --aperture octagon, or leave it out")
POLYGON_METHODS = ("exact", "layered")
APERTURES = "square, hexagon, octagon, decagon; paper and naive also diamond, star, triangle, pentagon, heptagon."

TABLE = (
    Option("method", "method", str, "exact, layered (near objects spread as well), paper or naive.",
           aperture_shapes.METHODS),
    Option("aperture", "aperture", str, APERTURES, aperture_shapes.NAMES),
    Option("preset", "preset", str, "exact, layered: mobile, low, medium, high or ultra.", tuple(methods.PRESETS),
           ("exact", "layered"), needs=EITHER),
    Option("samples", "samples", int, "Samples on a line; with --spacing at most, 65. Default: 13; exact: its preset.",
           (2, MAX_SAMPLES, f"2 to {MAX_SAMPLES}"), needs=PRESET),
    Option("spacing", "spacing", float, "Pixels between samples, as many as the CoC needs. 0: a fixed number.",
           (0, INF, "0 (a fixed number of samples) or more"), methods=("exact", "paper")),
    Option("jitter", "jitter", float, "Noise, 0 to 1, on places of samples more than a pixel apart.", UNIT,
           methods=("exact", "layered", "paper"), needs=NOISE),
    Option("rotation", "rotation", float, "Degrees, from +x towards +y (down).", ANY),
    Option("squeeze", "squeeze", float, "Width of the bokeh over its height: 0.5 for an anamorphic lens.",
           (TINY, 16, "more than 0, at most 16")),
    Option("cats-eye", "cats_eye", float, "exact, layered: fraction of the bokeh's width cut off in corners.",
           (0, 0.9, "0 to 0.9, a fraction of the bokeh's width"), POLYGON_METHODS),
    Option("roundness", "roundness", float, "exact, layered, octagon: 0 makes a square, 1 a regular octagon.",
           (0, 1, "0 (a square) to 1 (an octagon)"), POLYGON_METHODS, needs=OCTAGON),
    Option("lateral", "lateral", float, "Lateral colour: red larger, blue smaller, a fraction of the image.",
           (-0.1, 0.1, "-0.1 to 0.1, a fraction of the image")),
    Option("mrt", "use_mrt", bool, "exact, layered: write several targets in a pass.", methods=POLYGON_METHODS),
    Option("aperture-diameter", "camera.aperture_diameter", float, "Metres.", NOT_NEGATIVE, needs=LENS),
    Option("focal-length", "camera.focal_length", float, "Metres.", POSITIVE, needs=LENS),
    Option("focus-distance", "camera.focus_distance", float, "Metres, more than the focal length.", POSITIVE,
           needs=LENS),
    Option("sensor-height", "camera.sensor_height", float, "Metres.", POSITIVE, needs=LENS),
    Option("max-coc", "camera.max_coc", float, "Largest CoC, fraction of the image height.", HEIGHTS),
    Option("coc", "coc", float, "The same CoC everywhere, instead of one from depth.", HEIGHTS),
)  # fmt: skip


PLAN = inspect.Parameter(
    "plan_file",
    KEYWORD,
    default=None,
    annotation=Annotated[
        Path | None,
        typer.Option("--plan", metavar="FILE.json", help="Settings of a frame that plan printed; others change them."),
    ],
)
Sets = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="A parameter as your engine sets it; may be given again."),
]


LENS_OPTIONS = [
    inspect.Parameter(
        name,
        KEYWORD,
        default=None,
        annotation=Annotated[float | None, typer.Option(help=f"{text} [default: {default:g}]", show_default=False)],
    )
    for name, text, default in (
        ("f_stop", "Of the lens: its aperture is focal length / f-stop * bokeh scale.", F_STOP),
        ("bokeh_scale", "How many times wider the blur is than that lens's: 1 is the real lens.", BOKEH_SCALE),
    )
]


def with_lens(
    settings: Settings, given_options: Iterable[Option], f_stop: float | None, bokeh_scale: float | None
) -> Settings:
    """Return the settings with the aperture that an f-stop and a bokeh scale make, computed as in every integration.

    given_options  the other options on the command line
    f_stop         None: F_STOP
    bokeh_scale    None: BOKEH_SCALE
    Raises UserError if one is out of range, or if another option already sets the aperture.
    """
    lens_values = {"--f-stop": (f_stop, TINY), "--bokeh-scale": (bokeh_scale, 0.0)}
    lens_values = {name: pair for name, pair in lens_values.items() if pair[0] is not None}
    conflicting = [option.name for option in given_options if option.name in ("aperture-diameter", "coc")]
    for name, (value, minimum) in lens_values.items():
        if not minimum <= value < INF:
            raise UserError(f"{name} {value:g}: not allowed. Give {'more than 0' if minimum else '0 or more'}.")
        if conflicting:
            raise UserError(f"{name} {value:g}: no effect with --{conflicting[0]}. Leave one of them out.")
    if conflicting:
        return settings
    scale = BOKEH_SCALE if bokeh_scale is None else bokeh_scale
    diameter = settings.camera.focal_length / (F_STOP if f_stop is None else f_stop) * scale
    return replace(settings, camera=replace(settings.camera, aperture_diameter=diameter))


def parsed_sets(arguments: Iterable[str] | None) -> dict[str, float]:
    """Return parameter -> value from --set NAME=VALUE arguments. Raises UserError."""
    values = {}
    for text in arguments or ():
        name, _, number = text.partition("=")
        if name not in PARAMETERS:
            raise UserError(f"--set {text}: no parameter {name!r}. docs/reference/parameters.md has all of them.")
        try:
            values[name] = float(number)
        except ValueError:
            raise UserError(f"--set {text}: {number!r} is no number. Give one, such as {name}=1.") from None
    return values


def read_plan(path: Path) -> Settings:
    """Read the settings of a frame from a JSON file that `plan` printed. Raises UserError."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))["settings"]
        focus = data["focus"] and Focus(**{name: tuple(pair) for name, pair in data["focus"].items()})
        return Settings(**{**data, "camera": Camera(**data["camera"]), "focus": focus})
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it has no settings of a frame"
        raise UserError(
            f"--plan {path}: {reason}. Give a file that validation/run plan of this version wrote."
        ) from None


def with_settings(command: Callable) -> Callable:
    """Replace the parameter `settings` of a command by the options of TABLE.

    The command receives the settings made from them, already checked: an option given on the command line has an
    effect or is refused with a UserError.
    """
    signature = inspect.signature(command)

    @wraps(command)
    def called(*arguments, **values):
        file = values.pop(PLAN.name, None)
        lens = [values.pop(option.name, None) for option in LENS_OPTIONS]
        settings, given_options = DEFAULT if file is None else read_plan(file), []
        for option in TABLE:
            value = values.pop(option.parameter.name, None)
            if value is not None:
                settings = option.put(settings, value)
                given_options.append(option)
        if file is None or any(value is not None for value in lens):
            settings = with_lens(settings, given_options, *lens)
        check(settings, given_options)
        return command(*arguments, settings=settings, **values)

    parameters = [
        parameter.replace(kind=KEYWORD) for name, parameter in signature.parameters.items() if name != "settings"
    ]
    called.__signature__ = signature.replace(
        parameters=[*parameters, PLAN, *LENS_OPTIONS, *(option.parameter for option in TABLE)]
    )
    return called


def check(settings: Settings, given_options: Iterable[Option] = ()) -> None:
    """Refuse settings that make no sense, and options in `given_options` that have no effect. Raises UserError."""
    for option in TABLE:
        value = option.value(settings)
        if option.kind is str and value not in option.allowed:
            raise UserError(f"{option.told(settings)}: unknown. Give one of {', '.join(option.allowed)}.")
        if option.kind in (int, float) and value is not None:
            low, high, text = option.allowed
            if not math.isfinite(value) or not low <= value <= high:
                raise UserError(f"{option.told(settings)}: not allowed. Give {text}.")
    for option in given_options:
        typed, supporting = option.told(settings), " or ".join(option.methods)
        if settings.method not in option.methods:
            raise UserError(f"{typed}: no effect on {settings.method}. Give --method {supporting}, or leave it out.")
        if option.needs and not option.needs[0](settings):
            raise UserError(f"{typed}: no effect {option.needs[1]}. {option.needs[2]}.")
    method, aperture, count = settings.method, settings.aperture, settings.count
    camera, coc = settings.camera, settings.coc
    if method in POLYGON_METHODS and aperture not in methods.EXACT:
        names = ", ".join(methods.EXACT)
        raise UserError(f"--aperture {aperture}: {method} makes {names} only. Give --method paper.")
    focal, distance = camera.focal_length, camera.focus_distance
    if distance <= focal:
        raise UserError(f"--focus-distance {distance:g}: not allowed with focal length {focal:g}. Give more than that.")
    if coc is not None and coc > camera.max_coc:
        raise UserError(f"--coc {coc:g}: --max-coc {camera.max_coc:g} would clamp it. Raise --max-coc as well.")
    # 128 samples of the shape with the fewest offsets exceed the limit already
    if method == "naive" and len(aperture_shapes.kernel(aperture, min(count, 128))) > MAX_KERNEL:
        raise UserError(f"--samples {count}: a naive {aperture} has more than {MAX_KERNEL} offsets. Give fewer.")
