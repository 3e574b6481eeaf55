"""Mutants judged, each in a process of its own: a broken shader may crash a driver, or not end."""

import contextlib
import multiprocessing
import os
import re
import signal
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from multiprocessing import connection
from multiprocessing.process import BaseProcess

from bokeh_validation import drivers, shaders
from bokeh_validation.drivers import gl  # noqa: F401  loaded once, not in the process of every mutant
from bokeh_validation.mutants import frames, killers, operators
from bokeh_validation.mutants.killers import Judge
from bokeh_validation.mutants.mutant import ALIVE, BROKEN, CAUGHT, EQUIVALENT, REFUSED, Mutant, Verdict, originals, row
from bokeh_validation.shaders import parity, rules
from bokeh_validation.windows import wine

WORKERS = 2
# A mutant that takes longer hangs
LIMIT_S = 300
# What a driver says of a program that does not compile
COMPILER = re.compile("GLSL Compiler failed|GLSL Linker failed")
FORK = multiprocessing.get_context("fork")


def run(mutants: Sequence[Mutant], step: Callable[[str], None] = lambda _: None) -> list[dict]:
    """What becomes of each, in their order. Raises UserError where the shaders as they are do not pass."""
    judges = _prepared(mutants)
    # what showed the mutant before it of the same place is asked first
    favourite: dict[str, str] = {}
    rows: dict[str, dict] = {}
    waiting = list(reversed(mutants))
    running: dict[connection.Connection, tuple[Mutant, BaseProcess, float]] = {}
    try:
        while waiting or running:
            while waiting and len(running) < WORKERS:
                mutant = waiting.pop()
                asked = _asked(mutant, judges.get(mutant.driver, ()))
                asked.sort(key=lambda judge: judge.frame != favourite.get(mutant.place))
                end, other = FORK.Pipe(duplex=False)
                process = FORK.Process(target=_child, args=(mutant, asked, other))
                process.start()
                other.close()
                running[end] = mutant, process, time.monotonic()
            for end in connection.wait(running):
                mutant, process, begun = running.pop(end)
                try:
                    verdict = end.recv()
                except EOFError:
                    verdict = Verdict(BROKEN, "", f"it crashed, or did not end within {LIMIT_S} s")
                _kill(process)
                favourite[mutant.place] = verdict.judge or favourite.get(mutant.place, "")
                rows[mutant.name] = row(mutant, verdict, time.monotonic() - begun)
                step(f"{mutant.name}: {verdict.outcome}")
    finally:
        for _, process, _ in running.values():
            _kill(process)
    return [rows[mutant.name] for mutant in mutants]


def _prepared(mutants: Sequence[Mutant]) -> dict[str, list[Judge]]:
    """Driver -> judges: of every frame on the one for the operators, of those that are named on the others."""
    everything = frames.all_frames()
    result = {}
    with ProcessPoolExecutor(WORKERS, FORK) as pool:
        for driver in {mutant.driver for mutant in mutants} - {""}:
            named = {label for mutant in mutants if mutant.driver == driver for label in mutant.frames or everything}
            parts = pool.map(_judges, [driver] * len(named), [label for label in everything if label in named])
            result[driver] = [judge for part in parts for judge in part]
    return result


@cache
def _loaded(driver: str) -> drivers.Driver:
    return drivers.load(driver)


def _judges(driver: str, label: str) -> list[Judge]:
    return killers.judges(_loaded(driver), label, frames.all_frames()[label])


def _asked(mutant: Mutant, judges: Sequence[Judge]) -> list[Judge]:
    """Those that are named, or draw what has the mistake in it."""
    if mutant.frames or not judges:
        return [judge for judge in judges if judge.frame in mutant.frames]
    function = operators.functions()[mutant.place]
    sources = originals()[function.key], mutant.texts[function.key]
    bodies = [text[function.start : len(text) - len(sources[0]) + function.end] for text in sources]
    matters: dict[tuple, bool] = {}
    result = []
    for judge in judges:
        key = judge.main or f"{judge.item.entry}_PS", frozenset(judge.item.constants.items())
        if key not in matters:
            differ = len({operators.live(body, key[1]) for body in bodies}) > 1
            matters[key] = differ and mutant.place in operators.reached(*key)
        if matters[key]:
            result.append(judge)
    return result


def _kill(process: BaseProcess) -> None:
    """With the programs that it has started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.kill()
    process.join()


def _child(mutant: Mutant, judges: Sequence[Judge], end: connection.Connection) -> None:
    """What a mutant's process does."""
    os.setpgrp()
    # the system ends it: Python would wait for the driver
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(LIMIT_S)
    texts = {**originals(), **mutant.texts}
    # from here on this process has no other shaders
    shaders.text = lambda language: "".join(text for key, text in texts.items() if key.startswith(language))
    try:
        verdict = _judged(mutant, judges)
    except Exception as error:
        said = " ".join(f"{type(error).__name__}: {error}".split())
        verdict = Verdict(REFUSED if COMPILER.search(said) else BROKEN, "", said[:300])
    wine.stop()
    end.send(verdict)


def _judged(mutant: Mutant, judges: Sequence[Judge]) -> Verdict:
    # more than a line that the edit has made too long
    if mutant.common and all(rules.TOO_LONG in difference.what for difference in parity.check(mutant.texts)):
        return Verdict(ALIVE, "", "the parity check does not see it")
    if not mutant.driver:
        return Verdict(CAUGHT, "parity", "")
    if mutant.argued:
        # the argument is trusted but for one judge of each entry
        judges = list({judge.item.entry: judge for judge in judges}.values())
    driver = drivers.load(mutant.driver)
    for judge in judges:
        if objection := judge.objection(driver):
            return Verdict(CAUGHT, judge.frame, objection)
    if mutant.argued:
        return Verdict(EQUIVALENT, "", mutant.argued)
    return Verdict(ALIVE, "", f"{len(judges)} passes are as they should be")
