"""Blur one EXR file with the shaders: the command `validation/run render`."""

from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from bokeh_validation import drivers, exr, options, pictures, terminal
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.frame import methods

Source = Annotated[Path, Argument(metavar="IN.exr", help="R G B and planar view depth in metres.")]
DepthChannel = Annotated[str | None, Option(help="Depth in metres, as Z, the default, ViewLayer.Depth.Z, or PART.Z.")]
Layer = Annotated[str | None, Option(help="Layer or part that has R, G and B: ViewLayer.Combined.")]


def read(source: Path, settings: methods.Settings, depth_channel: str | None, layer: str | None) -> exr.Scene:
    """Read colour and depth of a file; no depth is read if the CoC is constant. Raises UserError."""
    if depth_channel == "":
        raise UserError("--depth-channel: is empty. Name a channel of the file, such as Z, or leave it out.")
    if settings.coc is None:
        return exr.read(source, depth_channel or "Z", layer)
    if depth_channel is not None:
        raise UserError(f"--depth-channel {depth_channel}: no effect with --coc. Leave one of them out.")
    return exr.read(source, None, layer)


@options.with_settings
def render(
    source: Source,
    target: Annotated[Path, Option("-o", "--output", metavar="OUT.exr", help="R G B A, A = CoC after the passes.")],
    settings: methods.Settings,
    depth_channel: DepthChannel = None,
    layer: Layer = None,
    driver: terminal.OneDriver = None,
    adapter: terminal.Adapter = None,
    png: Annotated[Path | None, Option(help="Write a tone-mapped picture as well.")] = None,
) -> None:
    """Blur an EXR with the shaders on a real driver."""
    terminal.check_writable(target, png)
    scene = read(source, settings, depth_channel, layer)
    active_driver, plan = drivers.pick(driver, adapter), methods.plan(settings, scene.size)
    textures = {"color": scene.color, "depth": scene.depth, **plan.tables}
    try:
        result = active_driver.run(plan.passes, textures, scene.size, scene.storage)["result"]
    except Unavailable as error:
        raise UserError(f"--driver {active_driver.name}: {error}.") from error
    exr.write(target, result)
    if png is not None:
        pictures.write_png(png, pictures.display(result, tone_map=True))
    size = f"{result.shape[1]} x {result.shape[0]}"
    terminal.console.print(f"{target}: {size}, {result.dtype}, by {active_driver.name} ({active_driver.adapter})")
