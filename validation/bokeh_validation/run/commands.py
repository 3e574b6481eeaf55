"""Define the commands that run a part of the suite: `validation/run probes` and `compile`."""

from bokeh_validation import drivers, terminal
from bokeh_validation.compile_matrix import Compilation
from bokeh_validation.probes import PROBES, REAL, outcomes
from bokeh_validation.run import session
from bokeh_validation.run.session import check_adapter
from bokeh_validation.shaders.variants import load


def probes(driver: terminal.SeveralDrivers = None, adapter: terminal.Adapter = None) -> None:
    """Draw the probes on the drivers, and check each against the reference and against what it must show."""
    names = tuple(driver or REAL)
    for name in names:
        drivers.check_name(name)
    check_adapter(names, adapter)
    tests = [session.probe(probe.name, name) for probe in PROBES for name in names]
    with terminal.progress("probe", len(tests)) as step:
        handed_over, errors = session.run(tests, step, adapter=adapter)
    results = outcomes.merged(handed_over.values())
    outcomes.print_grid(results)
    outcomes.print_details(results, True)
    terminal.end(session.told(handed_over, errors) and all(result.ok for result in results))


def compile_all(json_file: terminal.JsonFile = None) -> None:
    """Compile every shader program with every compiler."""
    terminal.check_writable(json_file)
    tests = [session.variant(name) for name in dict.fromkeys(program.variant for program in load())]
    with terminal.progress("compile", len(tests)) as step:
        handed_over, errors = session.run(tests, step)
    compilation = Compilation([row for compiled in handed_over.values() for row in compiled.rows])
    terminal.console.print(compilation.table())
    terminal.tell(compilation.summary, *compilation.failures())
    terminal.tell_missing(compilation.missing)
    terminal.write_json(json_file, compilation.as_json())
    terminal.end(session.told(handed_over, errors) and compilation.passed)
