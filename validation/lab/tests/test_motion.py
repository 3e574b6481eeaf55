"""Test motion: flicker is measured, temporal anti-aliasing settles, and layered flickers less than the others."""

import numpy as np
import pytest
from support import load

from lab.rasterised import faults, motion, motion_maps, sequences
from lab.rasterised.rasteriser import Rasteriser

SIZE, POINTS = (240, 136), 96


def test_flicker():
    """Check that a constant error does not count as flicker, and that an alternating error gives its amplitude as
    deviation, and twice its amplitude as change per frame.
    """
    truth = [np.full((8, 8, 3), 0.5, np.float32)] * 4
    shown = [faults.display(frame) for frame in truth]
    assert motion.flicker([frame * 1.2 for frame in truth], shown)["deviation"] == (0.0, 0.0)
    back = [frame * (1.2 if number % 2 else 0.8) for number, frame in enumerate(truth)]
    got = motion.flicker(back, shown)
    assert got["change"][0] == pytest.approx(2 * got["deviation"][0], rel=1e-4) and got["deviation"][0] > 5.0


def test_temporal_anti_aliasing():
    """Check that temporal anti-aliasing of one sample per pixel approaches many samples; in motion it
    needs velocity.
    """
    rasteriser = Rasteriser(SIZE, POINTS, load("egl"))
    off = {}
    for step, known in ((0, 1), (1, 1), (1, 0)):
        scenes = [sequences.moment("pan", step * frame) for frame in range(-1, 20)]
        places = [motion.PLACES[number % len(motion.PLACES)] for number in range(20)]
        pairs = zip(scenes[1:], scenes, places, strict=False)
        given = [rasteriser.pinhole(now, before, place=place) for now, before, place in pairs]
        assert (np.abs(given[-1].moved).max() > 0.1) == bool(step)
        given = [pinhole._replace(moved=known * pinhole.moved) for pinhole in given]
        (*_, resolved) = motion.resolved([pinhole.color for pinhole in given], given)
        many, one = (rasteriser.pinhole(scenes[-1], antialiased=many).color[..., :3] for many in (True, False))
        errors = [np.abs(np.clip(image, 0, 1) - np.clip(many, 0, 1)).mean() for image in (resolved, one)]
        off[step, known] = float(errors[0] / errors[1])
    assert off[0, 1] < 0.5 and off[1, 1] < 1.0 and off[1, 1] < 0.7 * off[1, 0], off


def test_steady():
    """Check that at rest a steady map removes more than a third of the change due to jitter, and half of the worst."""
    rows, _ = motion.measured("still", ["exact", "layered medium"], "egl", None, SIZE, POINTS, 8)
    got = {(row["input"], row["label"]): row["change"] for row in rows}
    for label in ("exact", "layered medium"):
        before, steady = got["temporal, before", label], got[motion.STEADY, label]
        assert steady[0] < 0.65 * before[0] and steady[1] < 0.5 * before[1], got


def test_pan(monkeypatch):
    """Check six frames of a pan: errors of paper and layered change less than the pinhole's; the table and the
    animation.

    Over all frames layered's error changes less than the paper's; in six frames the two are about equal.
    """
    monkeypatch.setattr(motion, "DETAIL", (100, 20, 80, 60))

    def measured(count: int) -> tuple:
        rows, frames = motion.measured("pan", list(motion.SHOWN), "egl", None, SIZE, POINTS, count)
        return rows, frames, {(row["input"], row["label"]): row["deviation"][0] for row in rows}

    _, _, all_frames = measured(motion.FRAMES)
    layered, paper = (all_frames["antialiased", label] for label in ("layered medium", "paper"))
    assert layered < 0.95 * paper, (layered, paper)
    rows, frames, got = measured(6)
    for kind in motion.INPUTS[:4]:
        assert max(got[kind, "layered medium"], got[kind, "paper"]) < 0.8 * got[kind, "pinhole"], got
    assert len(frames) == 6 and frames[0].dtype == np.uint8 and (frames[0] != frames[5]).any()
    assert motion.table(rows)[0].startswith("| pan | aliased |")


def test_maps():
    """Check that the error of layered varies less if its last pass knows what near objects hide, most of all there."""
    maps = motion_maps.deviations(load("egl"), SIZE, POINTS, 6)
    hidden = maps["hidden"] > 0.1
    assert maps["informed"][hidden].mean() < maps["layered"][hidden].mean()
    assert maps["layered"][hidden].mean() > 2.0 * maps["layered"][~hidden].mean()
