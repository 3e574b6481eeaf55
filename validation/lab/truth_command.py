"""Compare every method with a lens on ray-traced, random and moving scenes: the command `validation/run truth`."""

from typing import Annotated

import typer

from bokeh_validation import drivers, terminal
from bokeh_validation.errors import UserError
from bokeh_validation.truth import DEFAULT, METHODS, labels, ray_traced
from lab import ray_traced_score
from lab.rasterised import motion, random_score

# Limit set by the memory for the worst crops
MOST_RANDOM = 10_000


def truth(
    method: Annotated[
        list[str] | None,
        typer.Option(help=f"One of {', '.join(METHODS)}; may be given again. Default: those up to layered medium."),
    ] = None,
    scene: Annotated[
        list[str] | None, typer.Option(help="A scene of validation/scenes; may be given again. Default: all.")
    ] = None,
    count: Annotated[
        int | None,
        typer.Option("--random", metavar="N", help="N random scenes, by layered medium unless others are named."),
    ] = None,
    seed: Annotated[int | None, typer.Option(metavar="S", help="Seed of the first random scene. Default: 0.")] = None,
    sequence: Annotated[
        str | None, typer.Option("--motion", metavar="NAME", help=f"Flicker: {', '.join(motion.NAMES)}, or all.")
    ] = None,
    driver: terminal.OneDriver = None,
    adapter: terminal.Adapter = None,
    json_file: terminal.JsonFile = None,
) -> None:
    """Compare every method with what a lens sees (docs/results.md): FLIP, PSNR and relative light on ray-traced
    scenes.

    With --random or --motion: on rasterised scenes, with faults counted, or flicker measured.
    """
    kinds_of_scene = {"--scene": scene, "--random": count, "--motion": sequence}
    if len(several := [name for name, value in kinds_of_scene.items() if value is not None]) > 1:
        raise UserError(f"{' and '.join(several)}: those are different pictures. Give one of them.")
    if seed is not None and (count is None or seed < 0):
        raise UserError(f"--seed {seed}: not allowed. Give 0 or more, with --random N.")
    if count is not None and not 1 <= count <= MOST_RANDOM:
        raise UserError(f"--random {count}: not allowed. Give 1 to {MOST_RANDOM}.")
    allowed, default = (METHODS, DEFAULT) if sequence is None else (motion.KNOWN, motion.DEFAULT)
    method = [labels.complete(name) for name in method] if method else method
    chosen = terminal.chosen("--method", method, allowed, default if count is None else DEFAULT[-1:])
    names, scenes = motion.chosen(sequence), ray_traced.chosen(scene)
    terminal.check_writable(json_file)
    active_driver = drivers.pick(driver, adapter)
    if count is not None:
        rows, lines = random_score.report(chosen, active_driver.name, adapter, range(seed or 0, (seed or 0) + count))
    elif sequence is not None:
        rows, lines = motion.report(chosen, active_driver.name, adapter, names)
    else:
        rows, lines = ray_traced_score.report(chosen, active_driver, scenes)
    terminal.write_json(json_file, {"driver": active_driver.name, "adapter": active_driver.adapter, "rows": rows})
    terminal.tell(*lines, f"{active_driver.name} ({active_driver.adapter})")
