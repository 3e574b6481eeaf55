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
                receiver, sender = FORK.Pipe(duplex=False)
                process = FORK.Process(target=_child, args=(mutant, prepared[mutant.driver], sender))
                process.start()
                sender.close()
                running[receiver] = mutant, process
            for receiver in connection.wait(running):
                mutant, process = running.pop(receiver)
                try:
                    results[mutant.name] = receiver.recv()
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
            needed_labels = {
                label for mutant in mutants if mutant.driver == driver for label in mutant.frames or everything
            }
            labels = [label for label in everything if label in needed_labels]
            result[driver] = sum(pool.map(_judges, [driver] * len(labels), labels), [])
    return result


def _judges(name: str, label: str) -> list[Judge]:
    driver = _loaded(name)
    prepared = judges.judges(label, coverage_frames.all_frames()[label], driver.precision, driver.rounding)
    for judge in prepared:
        if objection := judge.objection(driver):
            raise UserError(f"mutants: the shaders as they are fail: {objection}. See validation/test.")
    return prepared


def _kill(process: BaseProcess) -> None:
    """Kill a mutant's process with the programs that it started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.kill()
    process.join()


def _child(mutant: Mutant, prepared: Sequence[Judge], sender: connection.Connection) -> None:
    """Judge a mutant in its process and send the result."""
    os.setpgrp()
    # the default handler ends the process at once; a Python handler would wait for the driver
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(LIMIT_S)
    # from here on this process uses the mutant's shaders
    shaders.text = lambda language: together(mutant.texts, language)
    try:
        result = _judged(mutant, prepared)
    except Exception as error:
        message = " ".join(f"{type(error).__name__}: {error}".split())
        result = REFUSED if COMPILER.search(message) else BROKEN, message[:300]
    wine.stop()
    sender.send(result)


def _judged(mutant: Mutant, prepared: Sequence[Judge]) -> tuple[str, str]:
    # parity must find more than a line that has become too long
    if mutant.common and all(rules.TOO_LONG in difference.what for difference in parity.check(mutant.texts)):
        return ALIVE, "the parity check does not see it"
    relevant = [judge for judge in prepared if _draws(judge, mutant)]
    if mutant.argued:
        # an equivalent mutant is only checked with one judge per entry
        relevant = list({judge.item.entry: judge for judge in relevant}.values())
    driver = drivers.load(mutant.driver)
    for judge in relevant:
        if objection := judge.objection(driver):
            return CAUGHT, objection
    if mutant.argued:
        return EQUIVALENT, mutant.argued
    return ALIVE, f"{len(relevant)} passes are right: a frame is missing, or equivalents.txt needs a reason"


def _draws(judge: Judge, mutant: Mutant) -> bool:
    """Return whether a judge's frame is named by the mutant, or its program contains the mistake."""
    if mutant.frames:
        return judge.label in mutant.frames
    entry, constants = judge.frame.main or f"{judge.item.entry}_PS", frozenset(judge.item.constants.items())
    original, mutated = (together(texts, "glsl") for texts in ({}, mutant.texts))
    code = calls.program(original, entry, constants)
    return code != calls.program(mutated, entry, constants) or (
        calls.declared(original, code) != calls.declared(mutated, code)
    )
