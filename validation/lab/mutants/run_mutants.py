"""Judge mutants, each in its own process, since a broken shader may crash a driver or hang."""

import contextlib
import multiprocessing
import os
import re
import signal
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from multiprocessing import connection
from multiprocessing.process import BaseProcess

from bokeh_validation import drivers, shaders
from bokeh_validation.drivers import gl  # noqa: F401  loaded once, not in the process of every mutant
from bokeh_validation.errors import UserError
from bokeh_validation.probes import coverage_frames, judges
from bokeh_validation.probes.judges import Judge
from bokeh_validation.shaders import calls, parity, rules
from bokeh_validation.windows import wine
from lab.mutants.mutant import ALIVE, BROKEN, CAUGHT, EQUIVALENT, REFUSED, Mutant, together

WORKERS = 2
# A mutant that takes longer is considered hung
LIMIT_S = 300
# A driver's messages for a program that does not compile
COMPILER = re.compile("GLSL Compiler failed|GLSL Linker failed")
FORK = multiprocessing.get_context("fork")
_loaded = cache(drivers.load)


def run(mutants: Sequence[Mutant], step: Callable[[str], None]) -> list[tuple[str, str]]:
    """Return outcome and detail of each mutant, in order. Raises UserError if the unchanged shaders fail."""
    prepared = _prepared(mutants)
    results: dict[str, tuple[str, str]] = {}
    waiting = list(reversed(mutants))
    running: dict[connection.Connection, tuple[Mutant, BaseProcess]] = {}
    try:
        while waiting or running:
            while waiting and len(running) < WORKERS:
                mutant = waiting.pop()
                end, other = FORK.Pipe(duplex=False)
                process = FORK.Process(target=_child, args=(mutant, prepared[mutant.driver], other))
                process.start()
                other.close()
                running[end] = mutant, process
            for end in connection.wait(running):
                mutant, process = running.pop(end)
                try:
                    results[mutant.name] = end.recv()
                except EOFError:
                    results[mutant.name] = BROKEN, f"it crashed, or did not end within {LIMIT_S} s"
                _kill(process)
                step(f"{mutant.name}: {results[mutant.name][0]}")
    finally:
        for _, process in running.values():
            _kill(process)
    return [results[mutant.name] for mutant in mutants]


def _prepared(mutants: Sequence[Mutant]) -> dict[str, list[Judge]]:
    """Return driver -> the judges of every frame that one of its mutants may need."""
    everything, result = list(coverage_frames.all_frames()), {}
    with ProcessPoolExecutor(WORKERS, FORK) as pool:
        for driver in dict.fromkeys(mutant.driver for mutant in mutants):
            asked = {label for mutant in mutants if mutant.driver == driver for label in mutant.frames or everything}
            labels = [label for label in everything if label in asked]
            result[driver] = sum(pool.map(_judges, [driver] * len(labels), labels), [])
    return result


def _judges(name: str, label: str) -> list[Judge]:
    driver = _loaded(name)
    found = judges.judges(label, coverage_frames.all_frames()[label], driver.precision, driver.rounding)
    for judge in found:
        if objection := judge.objection(driver):
            raise UserError(f"mutants: the shaders as they are fail: {objection}. See validation/test.")
    return found


def _kill(process: BaseProcess) -> None:
    """Kill a mutant's process with the programs that it started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.kill()
    process.join()


def _child(mutant: Mutant, asked: Sequence[Judge], end: connection.Connection) -> None:
    """Judge a mutant in its process and send the result."""
    os.setpgrp()
    # the default handler ends the process at once; a Python handler would wait for the driver
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(LIMIT_S)
    # from here on this process uses the mutant's shaders
    shaders.text = lambda language: together(mutant.texts, language)
    try:
        result = _judged(mutant, asked)
    except Exception as error:
        said = " ".join(f"{type(error).__name__}: {error}".split())
        result = REFUSED if COMPILER.search(said) else BROKEN, said[:300]
    wine.stop()
    end.send(result)


def _judged(mutant: Mutant, prepared: Sequence[Judge]) -> tuple[str, str]:
    # parity must find more than a line that has become too long
    if mutant.common and all(rules.TOO_LONG in difference.what for difference in parity.check(mutant.texts)):
        return ALIVE, "the parity check does not see it"
    asked = [judge for judge in prepared if _draws(judge, mutant)]
    if mutant.argued:
        # an equivalent mutant is only checked with one judge per entry
        asked = list({judge.item.entry: judge for judge in asked}.values())
    driver = drivers.load(mutant.driver)
    for judge in asked:
        if objection := judge.objection(driver):
            return CAUGHT, objection
    if mutant.argued:
        return EQUIVALENT, mutant.argued
    return ALIVE, f"{len(asked)} passes are right: a frame is missing, or equivalents.txt needs a reason"


def _draws(judge: Judge, mutant: Mutant) -> bool:
    """Return whether a judge's frame is named by the mutant, or its program contains the mistake."""
    if mutant.frames:
        return judge.label in mutant.frames
    entry, constants = judge.frame.main or f"{judge.item.entry}_PS", frozenset(judge.item.constants.items())
    before, after = (calls.program(together(texts, "glsl"), entry, constants) for texts in ({}, mutant.texts))
    return before != after
