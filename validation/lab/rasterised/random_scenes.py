"""Generate random scenes, so that nobody tunes on a handful of images.

A scene has a backdrop, a floor, subjects near the focus, posts and cards behind it, far lights (a third of them at a
subject's rim), near leaves, bars and lights, and an aperture from tiny to wide. Its input has one sample per pixel, or
is antialiased.
"""

from math import cos, exp, log, pi, sin
from random import Random

from bokeh_validation.frame.methods import Camera
from lab.rasterised.rasteriser import Scene, Thing

FOCAL_LENGTH, SENSOR_HEIGHT = 0.05, 0.024
# CoC at infinity, minimum and maximum, and CoC of the nearest object, as fractions of the image height
SMALLEST, LARGEST, NEAREST_COC = 0.008, 0.30, 0.42
# Minimum radius of a light, as a fraction of that CoC, so that single points of the lens do not show in it
LEAST_LIGHT = 0.045
# Seed from which scenes have a leaning subject with all lights at its rim, behind leaves
LEANING = 1000


def random_scene(seed: int) -> tuple[Scene, bool]:
    """Return the scene of a seed, which is the same everywhere, and whether its input is antialiased."""
    chance = _Chance(seed)
    chance.backdrop()
    chance.around_the_focus()
    chance.far_lights()
    chance.near_things()
    sky, bright = (0.01, 0.012, 0.02), chance.random.random() < 0.5
    if bright:
        sky = tuple(exp(chance.between(log(0.003), log(0.8))) for _ in range(3))
    chance.color(0.0, 1.0, 2)  # unused, but keeps the scenes of each seed as they were when figures were recorded
    aperture = chance.coc * chance.focus * chance.view
    camera = Camera(aperture, FOCAL_LENGTH, chance.focus, SENSOR_HEIGHT, 0.5)
    scene = Scene(tuple(chance.things), camera, sky=sky, sides=chance.choice((6, 8)))
    return scene, chance.random.random() < 0.4


class _Chance:
    """Build a scene; positions and sizes are in image heights, converted to metres at an object's distance."""

    def __init__(self, seed: int):
        self.random, self.leaning = Random(seed * 7919 + 13), seed >= LEANING
        self.between, self.choice = self.random.uniform, self.random.choice
        self.things: list[Thing] = []
        self.focus = self.choice((0.7, 1.2, 2.5, 2.5, 5.0, 9.0))
        self.coc = exp(self.between(log(SMALLEST), log(LARGEST)))
        # metres per image height at a distance of one metre
        self.view = SENSOR_HEIGHT * (self.focus - FOCAL_LENGTH) / (FOCAL_LENGTH * self.focus)
        self.far = self.focus * self.choice((4, 8, 15))
        # x, y and radius of subjects next to which lights may be placed
        self.subjects: list[tuple[float, float, float]] = []

    def color(self, low: float, high: float, count: int = 3) -> list[float]:
        """Return random channels between two values."""
        return [self.between(low, high) for _ in range(count)]

    def add(self, distance: float, x: float, y: float, width: float, height: float, *rest, **named) -> None:
        """Add an object at a distance in metres."""
        scale = self.view * distance
        self.things.append(Thing((x * scale, y * scale, distance), (width * scale, height * scale), *rest, **named))

    def backdrop(self) -> None:
        """Add a patterned or plain wall, or none, and a floor or none."""
        between, choice, wall = self.between, self.choice, (1.7 * self.far, 0, 0, 2.2 / 1.7, 1.2 / 1.7)
        if self.random.random() < 0.6:
            colors, pattern = (self.color(0.2, 1.2), self.color(0.01, 0.08)), choice(("checks", "windows"))
            self.add(*wall, *colors, pattern=pattern, cells=choice((6, 12, 20)))
        elif self.random.random() < 0.6:
            self.add(*wall, self.color(0.02, 0.9), shape="disc")
        if self.random.random() < 0.5:
            place = 0, 0.32 * self.view * self.focus * between(0.8, 1.3), 0.7 * self.far
            colors, size = (self.color(0.05, 0.4), self.color(0.02, 0.2)), (self.far, 0.68 * self.far)
            self.things.append(Thing(place, size, *colors, "floor", "checks", choice((5, 9))))

    def around_the_focus(self) -> None:
        """Add discs and cards near the focus, some leaning, and posts and cards behind it."""
        between, choice = self.between, self.choice
        if self.leaning:
            self.coc = between(0.08, 0.25)
            x, y, size = between(-0.3, 0.3), between(-0.05, 0.25), between(0.25, 0.4)
            distance, colors = self.focus * choice((1, 0.95, 0.9)), (self.color(0.2, 0.7), self.color(0.1, 0.6))
            pattern, down = choice(("shaded", "dapples")), choice((-2, -1, 1, 2))
            self.add(distance, x, y, size, size, *colors, "disc", pattern, lean=(between(-1.5, 1.5), down))
            self.subjects.append((x, y, size * 0.97))
        for _ in range(choice((1, 1, 2, 3))):
            distance = self.focus * choice((1, 1, 1.02, 0.97, 1.1, 0.9))
            x, y, size = between(-0.5, 0.5), between(-0.2, 0.2), between(0.1, 0.28)
            color, down = self.color(0.1, 0.9), choice((0, 0, 0.5, 1.5))
            self.subjects.append((x, y, size))
            if self.random.random() < 0.5:
                extent, other = (size, size * between(0.7, 1.4)), self.color(0.05, 0.8)
                pattern = ("plain", "shaded", "dapples", "dapples")[2 * choice((0, 1)) + choice((0, 1))]
                self.add(distance, x, y, *extent, color, other, "disc", pattern, lean=(down * between(-1, 1), down))
            else:
                extent, turn = (size * between(0.5, 1), size * between(0.7, 1.6)), between(-0.3, 0.3)
                pattern = self.color(0.02, 0.9), "card", "checks", choice((0.5, 3, 5, 9))
                self.add(distance, x, y, *extent, color, *pattern, turn, (down * between(-1, 1), 0.3 * down))
        for _ in range(choice((0, 2, 4))):
            distance, post = self.focus * between(1.1, 2.5), self.random.random() < 0.5
            place = between(-0.8, 0.8), between(-0.2, 0.2 if post else 0.3)
            size = (between(0.006, 0.02), between(0.2, 0.8)) if post else (between(0.05, 0.2), between(0.05, 0.3))
            turn, color = between(-0.2, 0.2) if post else between(-0.5, 0.5), self.color(0.05, 0.6 if post else 0.7)
            pattern = self.color(0.05, 0.4) if post else self.color(0.02, 0.5), "card", "checks"
            self.add(distance, *place, *size, color, *pattern, 0.5 if post else choice((0.5, 4, 7)), turn)

    def far_lights(self) -> None:
        """Add far lights, some of them at a subject's rim."""
        between, choice = self.between, self.choice
        if not self.leaning and self.random.random() >= 0.8:
            return
        for number in range(choice((4, 12, 40))):
            distance, x, y = self.far * between(0.5, 1.5), between(-0.85, 0.85), between(-0.48, 0.3)
            if self.leaning or number % 3 == 0:
                (middle_x, middle_y, size), angle = choice(self.subjects), between(0, 6.28)
                x, y = middle_x + size * cos(angle), middle_y + size * sin(angle)
            radius, light = max(choice((0.003, 0.006, 0.012, 0.02)), LEAST_LIGHT * self.coc), choice((4, 15, 60))
            self.add(distance, x, y, radius, radius, [light * part for part in self.color(0.25, 1)], shape="disc")

    def near_things(self) -> None:
        """Add leaves left and right of the middle, thin bars across the image, and lights."""
        between, choice, nearest = self.between, self.choice, max(0.25, 1 / (1 + NEAREST_COC / self.coc)) + 0.02
        leaves, largest = ((0, 0.12), (8, 0.12), (24, 0.12), (3, 0.3))[1 if self.leaning else choice((0, 1, 1, 2, 3))]
        for _ in range(leaves):
            distance = max(self.focus * between(nearest, 0.85), 0.12)
            side, size = choice((-1, 1)), between(0.03, largest)
            place = side * between(0.2, 0.85), between(-0.5, 0.5), size, size * between(0.2, 0.6)
            turn, color = between(0, 3.1), (between(0.02, 0.2), between(0.1, 0.45), 0.03)
            pattern, lean = choice(("plain", "shaded")), (0, choice((0, 0.4)))
            self.add(distance, *place, color, shape="disc", pattern=pattern, turn=turn, lean=lean)
        for _ in range(choice((0, 0, 1, 3))):
            distance, x = max(self.focus * between(nearest, 0.95), 0.12), between(-0.8, 0.8)
            width, turn = between(0.005, 0.03), choice((0, between(-0.6, 0.6), pi / 2))
            colors = self.color(0.02, 0.3), self.color(0.1, 0.5)
            self.add(distance, x, 0, width, 0.8, *colors, "card", "checks", choice((0.5, 0.5, 4)), turn)
        for _ in range(choice((0, 0, 2, 5))):
            distance = max(self.focus * between(nearest, 0.9), 0.12)
            radius = max(choice((0.004, 0.008, 0.016)), LEAST_LIGHT * self.coc * (self.focus / distance - 1))
            place = between(-0.8, 0.8), between(-0.45, 0.45), radius, radius
            self.add(distance, *place, [between(0.4, 1) * choice((5, 40)) for _ in range(3)], shape="disc")
