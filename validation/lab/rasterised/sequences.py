"""Build a street at night that moves by fractions of a pixel per frame, and such streets through small apertures."""

from collections.abc import Callable
from dataclasses import replace
from random import Random

from bokeh_validation.frame.methods import Camera
from lab.rasterised.rasteriser import Scene, Thing

CAMERA = Camera(0.0714, 0.05, 2.5, 0.024, 0.3)
# Moderate blur, CoC of 1 to 10 pixels in 270 rows: seed of a street, aperture and focus in metres
MODERATE = ((7, 0.01, 2.5), (8, 0.015, 2.5), (9, 0.02, 2.5), (5, 0.03, 2.5), (11, 0.012, 1.2))


def street(seed: int = 5, aperture: float = 0.0714, focus: float = 2.5, light: float = 0.005) -> Scene:
    """Return a street with far windows and lights, cards around 2.5 metres, and near leaves, lights and thin bars.

    aperture, focus  metres
    light            radius over distance of the far lights; 0.0014 is a pixel in 270 rows
    """
    random = Random(seed)
    between, choice = random.uniform, random.choice
    things = [
        Thing((0, 0, 25), (30, 14), (0.7, 0.5, 0.28), (0.02, 0.025, 0.05), pattern="windows", cells=14),
        Thing((0, 0.9, 14), (14, 14), (0.10, 0.09, 0.08), (0.03, 0.03, 0.035), "floor", "checks", 24),
        Thing((-0.05, 0.05, 2.5), (0.26, 0.34), (0.75, 0.28, 0.15), (0.9, 0.8, 0.6), "card", "checks", 5, 0.1),
        Thing((0.62, 0.1, 3.2), (0.2, 0.45), (0.15, 0.4, 0.6), (0.05, 0.1, 0.2), "card", "checks", 6, -0.15),
        Thing((-0.75, 0.12, 3.8), (0.22, 0.5), (0.5, 0.5, 0.15), (0.1, 0.12, 0.03), "card", "checks", 7, 0.2),
    ]
    for _ in range(60):
        distance = between(5, 20)
        place = between(-0.55, 0.55) * distance, between(-0.30, 0.06) * distance, distance
        color = [between(0.4, 1) * between(20, 70) for _ in range(3)]
        things.append(Thing(place, (light * distance,) * 2, color, shape="disc"))
    for _ in range(26):
        distance, side = between(0.7, 1.3), choice((-1, 1))
        place = side * between(0.22, 0.62) * distance, between(-0.36, 0.36) * distance, distance
        turn, color = between(0, 3), (between(0.03, 0.12), between(0.12, 0.3), 0.03)
        things.append(Thing(place, (0.055 * distance, 0.02 * distance), color, shape="disc", turn=turn, sway=0.12))
    for _ in range(6):
        distance, side = between(0.8, 1.5), choice((-1, 1))
        place = side * between(0.2, 0.5) * distance, between(-0.3, 0.3) * distance, distance
        things.append(Thing(place, (0.006 * distance,) * 2, (50, 38, 20), shape="disc"))
    for n in range(3):
        pattern = (0.12, 0.1, 0.05), (0.3, 0.28, 0.2), "card", "checks", 30, 0.03 * n
        things.append(Thing((-0.22 + 0.3 * n, 0, 1.1), (0.008, 0.6), *pattern))
    camera = replace(CAMERA, aperture_diameter=aperture, focus_distance=focus)
    return Scene(tuple(things), camera, sky=(0.004, 0.006, 0.014))


def _sideways(scene: Scene, frame: int) -> Scene:
    """Move the camera sideways by half a pixel per frame at the focus, in 270 rows."""
    return scene._replace(eye=(0.00221 * frame, -0.0004 * frame, 0.0), time=frame)


def _pulled(scene: Scene, frame: int) -> Scene:
    return scene._replace(camera=replace(scene.camera, focus_distance=CAMERA.focus_distance * 1.01**frame))


# name -> the scene at frame 0, and a function that moves it to any frame
MOTIONS: dict[str, tuple[Callable[[], Scene], Callable[[Scene, int], Scene]]] = {
    "still": (street, lambda scene, frame: scene),
    "pan": (street, _sideways),
    "dolly": (street, lambda scene, frame: scene._replace(eye=(0.0, 0.0, 0.004 * frame), time=frame)),
    "focus": (street, _pulled),
    "leaves": (street, lambda scene, frame: scene._replace(time=2 * frame)),
    "lights": (lambda: street(light=0.0014), _sideways),
}


def moment(name: str, frame: int) -> Scene:
    """Return a frame of one of MOTIONS; frames before 0 precede the measured ones."""
    first, moved = MOTIONS[name]
    return moved(first(), frame)
