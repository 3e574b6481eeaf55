"""The command line of validation/run: doctor, compile, render, patterns, parity, report, or all of them."""

import json
import os
import signal
import sys
import time
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from typer.exceptions import TyperException

from bokeh_validation import __version__
from bokeh_validation.errors import Unavailable, UserError

app = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Validate the polygonal bokeh shaders. Without a command: doctor, compile, patterns and report.",
)
console = Console(soft_wrap=True)

EXIT_FAILED, EXIT_BAD_INPUT = 1, 2

DRIVER_HELP = "osmesa, egl, wgpu, dxc, d3d9, d3d11, webgl2, webgpu or reference."
DriverOption = Annotated[list[str] | None, typer.Option("--driver", help=DRIVER_HELP)]
AdapterOption = Annotated[
    str | None, typer.Option("--adapter", help="Part of a device's name, or its number; see doctor.")
]
QuickOption = Annotated[bool, typer.Option("--quick", help="One driver, few variants: a first answer within a minute.")]


def main() -> None:
    """Run the command line; every refusal is one line on standard error and exit code 2."""
    signal.signal(signal.SIGTERM, _stop)
    try:
        code = app(standalone_mode=False)
    except UserError as error:
        code = _refuse(str(error))
    except Unavailable as error:
        code = _refuse(f"not on this machine: {error}")
    except TyperException as error:
        text = error.format_message() if hasattr(error, "format_message") else str(error)
        message = " ".join(text.split())
        code = _refuse(f"{message} See validation/run --help.")
    except (KeyboardInterrupt, typer.Abort):
        code = _refuse("stopped")
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 0
    _end_programs()
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:  # closed by the caller
            stream.flush()
    # Mesa's and wgpu's libraries tear down in an order of their own; nothing is left to save here.
    os._exit(code if isinstance(code, int) else 0)


def _stop(*_) -> None:
    """A request to end is as an interruption from the keyboard; a second one does not disturb the first."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    raise KeyboardInterrupt


def _end_programs() -> None:
    """os._exit() runs no exit handlers: end Wine and its display here, if they were used at all."""
    windows = sys.modules.get("bokeh_validation.windows.wine")
    if windows:
        windows.stop()


def _refuse(message: str) -> int:
    print(f"error: {message}", file=sys.stderr)
    return EXIT_BAD_INPUT


def _progress(description: str, total: int):
    """A progress bar on standard error, gone when done; returns (bar, callback)."""
    bar = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=Console(stderr=True),
        transient=True,
        disable=not sys.stderr.isatty(),
    )
    task = bar.add_task(description, total=total)

    def step(text: str) -> None:
        bar.update(task, advance=1, description=f"{description} {text}")

    return bar, step


@app.callback(invoke_without_command=True)
def default(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
    adapter: AdapterOption = None,
    quick: QuickOption = False,
) -> None:
    """Without a command: everything."""
    if version:
        console.print(__version__)
        raise typer.Exit(0)
    if context.invoked_subcommand is None:
        raise typer.Exit(_everything(adapter, quick))


def _everything(adapter: str | None, quick: bool) -> int:
    started = time.monotonic()
    doctor()
    matrix = _matrix(quick)
    _print_matrix(matrix)
    runtimes, missing = _drivers(None, adapter, quick)
    probes, scenes = _probes(runtimes, quick), _scenes(runtimes, quick)
    _print_probes(probes, missing)
    _print_scenes(scenes)
    captures, engines_ok = ([], True) if quick else _engines([n for n, e in _samples().items() if not e.slow])
    path = _write_report(None, matrix, probes, scenes, missing, captures)
    console.print(f"Report: {path}   ({time.monotonic() - started:.0f} s)")
    passed = _compiled(matrix) and engines_ok and all(p.ok for p in probes)
    return 0 if passed and all(c.ok for s in scenes for c in s.result.comparisons.values()) else EXIT_FAILED


def _drivers(names: list[str] | None, adapter: str | None, quick: bool = False):
    from bokeh_validation import drivers, suite

    for name in names or []:
        if name not in drivers.NAMES:
            raise UserError(f"--driver {name}: no such driver. Give one of {', '.join(drivers.NAMES)}.")
    runtimes, missing = suite.real_drivers(names, adapter)
    if not runtimes:
        reasons = "; ".join(f"{name}: {reason}" for name, reason in missing.items())
        raise UserError(f"none of the drivers is on this machine ({reasons}). See validation/run doctor.")
    return (runtimes[:1] if quick else runtimes), missing


@app.command()
def doctor(
    install: Annotated[
        bool, typer.Option("--install", help="Fetch what can be fetched into the cache folder.")
    ] = False,
) -> None:
    """Every compiler and driver: version or adapter, or the command that installs it."""
    from bokeh_validation import doctor as findings

    if install:
        from bokeh_validation.compilers import dxc, fxc

        dxc.fetch()
        fxc.fetch()
    table = Table("", "", "", box=None, show_header=False, pad_edge=False)
    for finding in findings.findings():
        state = "[green]found[/]" if finding.found else "[yellow]missing[/]"
        table.add_row(f"{finding.kind} {finding.name}", state, finding.detail)
    for driver, adapter in findings.adapters():
        table.add_row(f"adapter for {driver}", "", adapter)
    for name, value in findings.environment().items():
        table.add_row(name, "", value)
    console.print(table)


@app.command("compile")
def compile_(
    json_file: Annotated[Path | None, typer.Option("--json", help="Write the matrix here as well.")] = None,
    quick: QuickOption = False,
) -> None:
    """Every variant of variants.toml through every compiler."""
    from bokeh_validation import exr
    from bokeh_validation import matrix as matrices

    if json_file is not None:
        exr.check_writable(json_file)
    matrix = _matrix(quick)
    _print_matrix(matrix)
    if json_file is not None:
        text = json.dumps(matrices.as_json(matrix), indent=1)
        exr.whole(json_file, lambda partial: partial.write_text(text + "\n", encoding="utf-8"))
    raise typer.Exit(0 if _compiled(matrix) else EXIT_FAILED)


@app.command()
def sm3() -> None:
    """Instruction slots of the naive gather under shader model 3, by how its loops are written."""
    from bokeh_validation import sm3 as model

    for line in model.lines(model.attempts()):
        console.print(line, markup=False)


@app.command()
def render(
    source: Annotated[Path, typer.Argument(metavar="IN.exr", help="R G B and planar view depth in metres.")],
    target: Annotated[
        Path, typer.Option("-o", "--output", metavar="OUT.exr", help="R G B A, A = CoC after the passes.")
    ],
    method: Annotated[
        str,
        typer.Option(
            help="exact (polygons with an even number of sides), layered (the same, and near objects spread), paper "
            "or naive."
        ),
    ] = "exact",
    aperture: Annotated[
        str,
        typer.Option(
            help="square, hexagon, octagon, decagon; paper and naive also diamond, star, triangle, pentagon, heptagon."
        ),
    ] = "hexagon",
    samples: Annotated[
        int | None, typer.Option(help="Samples on a line, 2 or more. Default: 13; exact: as close to each other.")
    ] = None,
    spacing: Annotated[
        float, typer.Option(help="Pixels between samples: as many as the CoC needs. 0: a fixed number, --samples.")
    ] = 0.0,
    max_samples: Annotated[int, typer.Option(help="Samples on a line at most, with --spacing.")] = 65,
    jitter: Annotated[
        float, typer.Option(help="Noise on the samples' places, 0 to 1, where they are more than a pixel apart.")
    ] = 0.0,
    frame: Annotated[int, typer.Option(help="Number of the frame; the noise is another in each.")] = 0,
    squeeze: Annotated[
        float, typer.Option(help="Width of the bokeh over its height: 0.5 for an anamorphic lens.")
    ] = 1.0,
    targets: Annotated[
        bool, typer.Option("--mrt/--no-mrt", help="exact and layered: write several targets in a pass.")
    ] = True,
    quality: Annotated[str, typer.Option(help="layered: low, medium, high or ultra.")] = "medium",
    rotation: Annotated[float, typer.Option(help="Degrees, from +x towards +y (down).")] = 0.0,
    aperture_diameter: Annotated[float, typer.Option(help="Metres.")] = 0.05,
    focal_length: Annotated[float, typer.Option(help="Metres.")] = 0.05,
    focus_distance: Annotated[float, typer.Option(help="Metres, more than the focal length.")] = 5.0,
    sensor_height: Annotated[float, typer.Option(help="Metres.")] = 0.024,
    max_coc: Annotated[float, typer.Option(help="Largest CoC, fraction of the image height.")] = 0.1,
    coc: Annotated[float | None, typer.Option(help="The same CoC everywhere, instead of one from depth.")] = None,
    coc_blur: Annotated[bool, typer.Option("--coc-blur/--no-coc-blur", help="Average the CoC with the colour.")] = True,
    leak_fix: Annotated[bool, typer.Option("--leak-fix/--no-leak-fix", help="Listing 3's leakage test.")] = True,
    depth_channel: Annotated[
        str, typer.Option(help="Name of the depth channel; Z is found in the layer or part for depth too.")
    ] = "Z",
    layer: Annotated[
        str | None, typer.Option(help="Layer or part with R G B, where the file has several: ViewLayer.Combined.")
    ] = None,
    driver: Annotated[str | None, typer.Option(help=DRIVER_HELP)] = None,
    adapter: AdapterOption = None,
    png: Annotated[Path | None, typer.Option(help="Write a tone-mapped picture as well.")] = None,
) -> None:
    """Blur an EXR with the shaders on a real driver."""
    from bokeh_validation import methods
    from bokeh_validation import render as rendering

    camera = methods.Camera(aperture_diameter, focal_length, focus_distance, sensor_height, max_coc)
    settings = methods.Settings(
        method,
        aperture,
        samples,
        rotation,
        camera,
        coc,
        coc_blur,
        leak_fix,
        spacing=spacing,
        max_samples=max_samples,
        jitter=jitter,
        frame=frame,
        squeeze=squeeze,
        targets=targets,
        quality=quality,
    )
    if coc is not None and coc > max_coc:
        raise UserError(
            f"--coc {coc:g}: more than --max-coc {max_coc:g}, which would clamp it. Raise --max-coc as well."
        )
    request = rendering.Request(source, target, settings, depth_channel, layer, driver, adapter, png)
    result, used = rendering.render(request)
    console.print(f"{target}: {result.shape[1]} x {result.shape[0]}, {result.dtype}, by {used.name} ({used.adapter})")


@app.command()
def plan(
    method: Annotated[str, typer.Option(help="exact, layered, paper or naive.")] = "exact",
    aperture: Annotated[str, typer.Option(help="As render's.")] = "hexagon",
    size: Annotated[str, typer.Option(metavar="WxH", help="Of the picture, pixels.")] = "1920x1080",
    targets: Annotated[
        bool, typer.Option("--mrt/--no-mrt", help="exact and layered: write several targets in a pass.")
    ] = True,
    quality: Annotated[str, typer.Option(help="layered: low, medium, high or ultra.")] = "medium",
    json_file: Annotated[Path | None, typer.Option("--json", help="Write everything here as well.")] = None,
    docs: Annotated[
        bool, typer.Option("--docs", help="Rewrite the tables of docs/passes.md, and nothing else.")
    ] = False,
) -> None:
    """Every pass of a method in order: entry, inputs, targets, sizes, formats, filters, parameters."""
    from bokeh_validation import exr, frame, methods

    if docs:
        page = frame.page(frame.PAGE.read_text(encoding="utf-8"))
        exr.check_writable(frame.PAGE)
        exr.whole(frame.PAGE, lambda partial: partial.write_text(page, encoding="utf-8"))
        return
    settings = methods.Settings(method, aperture, targets=targets, quality=quality)
    found = frame.frame(settings, frame.parsed_size(size))
    if json_file is not None:
        exr.check_writable(json_file)
        text = json.dumps(found, indent=1)
        exr.whole(json_file, lambda partial: partial.write_text(text + "\n", encoding="utf-8"))
    for line in frame.lines(found):
        console.print(line, markup=False, highlight=False, soft_wrap=True)


@app.command()
def aperture(
    sides: Annotated[int | None, typer.Option(help="A regular polygon, first corner straight up.")] = None,
    vertices: Annotated[
        str | None, typer.Option(metavar='"x,y x,y ..."', help="Any convex polygon: x right, y down, unit: the CoC.")
    ] = None,
    rotation: Annotated[float, typer.Option(help="Degrees, from +x towards +y (down).")] = 0.0,
    squeeze: Annotated[float, typer.Option(help="Width of the bokeh over its height, as BokehSqueeze.")] = 1.0,
    exact: Annotated[
        bool, typer.Option("--exact", help="The two passes of the exact method: 4, 6, 8, 10 sides.")
    ] = False,
    output: Annotated[Path | None, typer.Option("-o", "--output", metavar="FILE.png", help="Draw it.")] = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write the passes here as well.")] = None,
) -> None:
    """The line passes that make a polygon with min, or the exact ones (docs/apertures.md)."""
    from bokeh_validation import exr, pictures, sheet, tiling

    if exact:
        module, page = tiling, tiling.tiling(sides, vertices, rotation, squeeze)
    else:
        module, page = sheet, sheet.sheet(sides, vertices, rotation, squeeze)
    for path in (output, json_file):
        if path is not None:
            exr.check_writable(path)
    if output is not None:
        pictures.write_png(output, module.picture(page))
    if json_file is not None:
        text = json.dumps(module.as_json(page), indent=1)
        exr.whole(json_file, lambda partial: partial.write_text(text + "\n", encoding="utf-8"))
    for line in (module.summary(page), *module.table(page)):
        console.print(line, markup=False, highlight=False, soft_wrap=True)


@app.command()
def shapes(driver: Annotated[str | None, typer.Option(help=DRIVER_HELP)] = None, adapter: AdapterOption = None) -> None:
    """The table of docs/apertures.md: every shape by every method, measured on a driver."""
    from bokeh_validation import quality
    from bokeh_validation import render as rendering

    used = rendering.pick_driver(driver, adapter)
    bar, step = _progress("shapes", len(quality.SHAPES))
    rows = []
    with bar:
        for method, aperture in quality.SHAPES:
            rows.append(quality.shape(used, method, aperture))
            step(f"{method} {aperture}")
    for line in quality.markdown(rows):
        console.print(line, markup=False, highlight=False, soft_wrap=True)
    console.print(f"CoC {quality.COC:g} pixels, {used.name} ({used.adapter})", markup=False, highlight=False)


@app.command()
def truth(
    method: Annotated[
        list[str] | None,
        typer.Option(help="pinhole, paper, exact, gather, scatter or layered; may be given again. Default: all."),
    ] = None,
    scene: Annotated[
        list[str] | None, typer.Option(help="Of validation/scenes; may be given again. Default: all.")
    ] = None,
    quality: Annotated[
        list[str] | None, typer.Option(help="layered: low, medium, high or ultra. Default: low and medium.")
    ] = None,
    driver: Annotated[str | None, typer.Option(help=DRIVER_HELP)] = None,
    adapter: AdapterOption = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write the numbers here as well.")] = None,
    folder: Annotated[
        Path | None, typer.Option("--pictures", metavar="FOLDER", help="Write the pictures of docs/likeness.md here.")
    ] = None,
) -> None:
    """How near every method comes to what a lens sees (docs/likeness.md): FLIP, PSNR, light over the truth's."""
    from bokeh_validation import exr, likeness
    from bokeh_validation import render as rendering

    labels, scenes = likeness.labels(method, quality), likeness.scenes(scene)
    if json_file is not None:
        exr.check_writable(json_file)
    if folder is not None and not folder.is_dir():
        raise UserError(f"--pictures {folder}: there is no such folder. Make it first.")
    used = rendering.pick_driver(driver, adapter)
    bar, step = _progress("truth", len(scenes) * len(labels))
    with bar:
        rows = likeness.measured(used, scenes, labels, folder, step)
    if json_file is not None:
        text = json.dumps(likeness.as_json(used, rows), indent=1)
        exr.whole(json_file, lambda partial: partial.write_text(text + "\n", encoding="utf-8"))
    for line in likeness.markdown(rows):
        console.print(line, markup=False, highlight=False, soft_wrap=True)
    console.print(f"FLIP, PSNR, light; {used.name} ({used.adapter})", markup=False, highlight=False)


@app.command()
def figures(
    only: Annotated[str | None, typer.Option(metavar="1,4,9", help="These figures of the paper; else all.")] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="FOLDER", help="One folder for all files; else docs/reproduction and the cache."
        ),
    ] = None,
    driver: Annotated[str | None, typer.Option(help=DRIVER_HELP)] = None,
    adapter: AdapterOption = None,
) -> None:
    """Figures 1 to 13 of the paper with our shaders, as PNG, and the EXR and numbers behind them."""
    from bokeh_validation.figures import command

    wanted = command.chosen(only)
    used = command.pick_driver(driver, adapter)
    target = command.places(output)
    bar, step = _progress("figures", len(wanted))
    with bar:
        result = command.run(wanted, used, target, step)
    for number, made in result.made.items():
        console.print(f"Figure {number}: {command.FIGURES[number].title}", markup=False, highlight=False)
        for table in made.tables:
            for line in table.markdown():
                console.print(line, markup=False, highlight=False, soft_wrap=True)
    for number, reason in result.missing.items():
        console.print(f"Figure {number} not made: {reason}", markup=False, highlight=False, soft_wrap=True)
    console.print(
        f"{sum(len(made.pictures) for made in result.made.values())} pictures in {target.pictures}, images and numbers "
        f"in {target.images}, by {used.name} ({used.adapter})",
        markup=False,
        highlight=False,
    )
    raise typer.Exit(EXIT_FAILED if result.missing and command.under_ci() else 0)


@app.command()
def patterns(
    driver: DriverOption = None,
    adapter: AdapterOption = None,
) -> None:
    """The probes on the drivers, each against the reference and against what it must show."""
    runtimes, missing = _drivers(driver, adapter)
    results = _probes(runtimes)
    _print_probes(results, missing, details=True)
    raise typer.Exit(0 if all(r.ok for r in results) else EXIT_FAILED)


@app.command()
def parity(
    function: Annotated[str | None, typer.Argument(help="Print this function in three columns.")] = None,
) -> None:
    """Compare the three libraries function by function."""
    from bokeh_validation import parity as comparison

    if function is not None:
        comparison.render_columns(function, console)
        return
    differences = comparison.check()
    for difference in differences:
        console.print(str(difference), markup=False)
    console.print(f"{len(differences)} unmarked differences between HLSL, GLSL and WGSL")
    raise typer.Exit(EXIT_FAILED if differences else 0)


@app.command()
def precision() -> None:
    """What half precision does to every function and pass, emulated: the tables of docs/inputs.md."""
    from bokeh_validation.half import table

    bar, step = _progress("precision", table.steps())
    with bar:
        findings = table.measured(step)
    for line in table.markdown(findings):
        console.print(line, markup=False, highlight=False, soft_wrap=True)


@app.command()
def report(
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The page; in the cache folder by default.")
    ] = None,
    driver: DriverOption = None,
    adapter: AdapterOption = None,
) -> None:
    """One self-contained HTML page with pictures."""
    from bokeh_validation import exr

    if output is not None:
        exr.check_writable(output)
    runtimes, missing = _drivers(driver, adapter)
    captures, _ = _engines([name for name, engine in _samples().items() if not engine.slow])
    path = _write_report(output, _matrix(False), _probes(runtimes), _scenes(runtimes), missing, captures)
    console.print(f"Report: {path}")


@app.command()
def bench(
    driver: Annotated[
        list[str] | None,
        typer.Option("--driver", help="osmesa, egl, wgpu or dxc; default: osmesa and wgpu. The others are not timed."),
    ] = None,
    adapter: AdapterOption = None,
    size: Annotated[
        str | None, typer.Option(metavar="WxH", help="Pixels. Default: 800x800; smaller in software.")
    ] = None,
    rounds: Annotated[int | None, typer.Option(help="Rounds that count, 3 or more.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Small, few counts, few rounds: within 40 s.")] = False,
    clock: Annotated[
        str | None,
        typer.Option(help="wall, query or cpu. Default: cpu in software, else query where it agrees with wall."),
    ] = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write everything here, raw rounds too.")] = None,
    plot: Annotated[Path | None, typer.Option(metavar="FILE.png", help="Draw the curves and the floors.")] = None,
) -> None:
    """Table 1: time of the methods against naive, against each other and against a floor of the same fetches."""
    from bokeh_validation import exr
    from bokeh_validation.bench import output, request, session

    plan = request.plan(size, rounds, quick, clock)
    for path in (json_file, plot):
        if path is not None:
            exr.check_writable(path)
    runtimes, missing = request.load(driver, adapter)
    bar, step = _progress("bench", plan.steps * len(runtimes))
    results = []
    with bar:
        for runtime in runtimes:
            results.append(session.measure(runtime, plan, lambda text, name=runtime.name: step(f"{name}: {text}")))
    if json_file is not None:
        text = json.dumps(session.as_json(results, missing), indent=1)
        exr.whole(json_file, lambda partial: partial.write_text(text + "\n", encoding="utf-8"))
    if plot is not None:
        picture = output.plot(results)
        exr.whole(plot, lambda partial: partial.write_bytes(picture))
    # a table in a file or a pipe needs a width of its own
    wide = console if console.is_terminal else Console(width=120)
    for result in results:
        for part in output.tables(result):
            wide.print(part)
    for name, reason in missing.items():
        console.print(f"[yellow]not run[/] {name}: {reason}")


@app.command()
def mutants(
    only: Annotated[list[str] | None, typer.Option(metavar="NAME", help="This mutant; may be given again.")] = None,
    kind: Annotated[list[str] | None, typer.Option(help="Those of a kind, such as sign; may be given again.")] = None,
    sample: Annotated[int | None, typer.Option(metavar="N", help="So many of them, at random.")] = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write the results here as well.")] = None,
) -> None:
    """Break the shaders, one mistake at a time: the tests must catch each. A complete run goes into the report."""
    from bokeh_validation import exr, paths
    from bokeh_validation.mutants import catalog, output, results, runner

    chosen = catalog.chosen(only, kind, sample)
    if json_file is not None:
        exr.check_writable(json_file)
    started = time.monotonic()
    bar, step = _progress("mutants", runner.steps(chosen))
    with bar:
        done = runner.run(chosen, step, runner.remaining())
    seconds = time.monotonic() - started
    targets = [json_file] if json_file else []
    if len(chosen) == len(catalog.MUTANTS):
        paths.ensured(results.default_path().parent)
        targets.append(results.default_path())
    for target in targets:
        results.write(target, done.results, seconds)
    for line in output.lines(done, seconds):
        console.print(line, markup=False, highlight=False, soft_wrap=True)
    raise typer.Exit(0 if done.ok else EXIT_FAILED)


@app.command()
def engines(
    names: Annotated[list[str] | None, typer.Argument(metavar="[NAME]...", help="By default all quick ones.")] = None,
    everything: Annotated[bool, typer.Option("--all", help="The slow ones as well (Bevy builds for minutes).")] = False,
) -> None:
    """Build and run the samples of integration/, each compared with the reference on its own colour and depth."""
    samples = _samples()
    for name in names or []:
        if name not in samples:
            raise UserError(f"engine {name}: no such sample. Give some of {', '.join(samples)}.")
    chosen = names or [name for name, engine in samples.items() if everything or not engine.slow]
    _, passed = _engines(chosen)
    raise typer.Exit(0 if passed else EXIT_FAILED)


def _samples():
    from bokeh_validation import engines

    return engines.ENGINES


def _engines(names: list[str]):
    """Captures of the samples that ran, and whether none failed; under CI none may be missing either."""
    bar, step = _progress("engine", len(names))
    captures, passed = [], True
    with bar:
        for name in names:
            capture, ok = _run_engine(name)
            captures += [capture] if capture else []
            passed &= ok
            step(name)
    return captures, passed


def _run_engine(name: str):
    """(capture or None, whether that is well), printed."""
    from bokeh_validation import engines
    from bokeh_validation.errors import Unavailable

    try:
        capture = engines.run(name)
    except Unavailable as error:
        console.print(f"[yellow]not run[/] {name}: {error}", highlight=False)
        return None, not os.environ.get("CI")
    except (RuntimeError, engines.Broken) as error:
        console.print(f"[red]FAILED[/] {name}: {error}", highlight=False)
        return None, False
    console.print(f"{name}: {capture.engine} on {capture.device}", highlight=False)
    for shot in capture.shots:
        state = "[green]ok[/]" if shot.comparison.ok else "[red]FAILED[/]"
        where = "".join(f"; {name}: {count}" for name, count in shot.outside.items())
        console.print(f"  {shot.name}: {shot.comparison}{where} {state}", highlight=False)
    return capture, capture.ok


# ---------------------------------------------------------------------------------------------------------------- steps


def _compiled(matrix) -> bool:
    """Nothing failed; under CI nothing may be missing either."""
    return not matrix.counts["failed"] and not (os.environ.get("CI") and matrix.counts["missing"])


def _matrix(quick: bool):
    from bokeh_validation import matrix as matrices

    variants = matrices.load(quick=quick)
    bar, step = _progress("compile", matrices.count(variants))
    with bar:
        return matrices.run(variants, step)


def _probes(runtimes, quick: bool = False):
    from bokeh_validation import suite

    bar, step = _progress("probe", len(runtimes) * len(suite.probes(quick)))
    with bar:
        return suite.run_probes(runtimes, step, quick)


def _scenes(runtimes, quick: bool = False):
    from bokeh_validation import suite

    bar, step = _progress("scene", len(runtimes) * len(suite.scene_runs(quick)))
    with bar:
        return suite.run_scenes(runtimes, step, quick)


def _write_report(output: Path | None, matrix, probes, scenes, missing, captures) -> Path:
    from bokeh_validation import paths, report

    path = output or report.default_path()
    if output is None:
        paths.ensured(path.parent)
    report.write(path, matrix, probes, scenes, missing, captures)
    return path


def _print_matrix(matrix) -> None:
    from bokeh_validation import matrix as matrices

    for part in matrices.tables(matrix):
        console.print(part)


def _print_probes(results, missing: dict[str, str], details: bool = False) -> None:
    names = list(dict.fromkeys(r.driver for r in results))
    table = Table("probe", "figure", *names, box=None, pad_edge=False)
    for probe in dict.fromkeys(r.probe.name for r in results):
        group = {r.driver: r for r in results if r.probe.name == probe}
        figure = next(iter(group.values())).probe.figure
        cells = ["[green]ok[/]" if group[n].ok else "[red]FAILED[/]" for n in names]
        table.add_row(probe, figure, *cells)
    console.print(table)
    for result in results:
        for check in result.checks:
            if details or not check.ok:
                state = "[green]ok[/]" if check.ok else "[red]FAILED[/]"
                allowed = f"{check.low:.5g} .. {check.high:.5g}"
                console.print(
                    f"{result.driver} {result.probe.name}: {check.name} {check.value:.5g} ({allowed}) {state}"
                )
        for case in result.cases:
            for name, comparison in case.comparisons.items():
                if details or not comparison.ok:
                    state = "[green]ok[/]" if comparison.ok else "[red]FAILED[/]"
                    console.print(
                        f"{result.driver} {result.probe.name}, {case.case.label}, {name}: {comparison} {state}"
                    )
    for name, reason in missing.items():
        console.print(f"[yellow]not run[/] {name}: {reason}")


def _print_scenes(results) -> None:
    for result in results:
        comparison = result.result.comparisons["result"]
        state = "[green]ok[/]" if comparison.ok else "[red]FAILED[/]"
        console.print(
            f"{result.driver} {result.scene.name}, {result.method} {result.aperture}: {comparison} {state}; "
            f"against brute force {result.psnr_brute:.1f} dB, "
            f"against the lens {result.psnr:.1f} dB, FLIP {result.flip:.3f} "
            f"(untouched {result.psnr_untouched:.1f} dB, {result.flip_untouched:.3f})"
        )
