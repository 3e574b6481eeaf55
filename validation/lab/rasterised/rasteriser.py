"""Rasterise a scene within moments: colour and depth through a pinhole, and the truth through a polygonal lens.

The camera moves to points of the aperture, with a frustum sheared so that the plane of focus stays fixed, and the
images are averaged (Haeberli and Akeley, The Accumulation Buffer, 1990).
"""

from collections.abc import Sequence
from typing import NamedTuple

import moderngl
import numpy as np

from bokeh_validation import drivers
from bokeh_validation.drivers.gl import GLDriver
from bokeh_validation.frame import aperture_shapes, geometry
from bokeh_validation.frame.methods import Camera

SHAPES = ("disc", "card", "floor", "sphere")
PATTERNS = ("plain", "checks", "windows", "dapples", "shaded")
# Images that are drawn before they are summed; samples per pixel of the antialiased input
VIEWS, ANTIALIASING = 16, 16
# Metres to the sky; cells of a sphere's mesh, around it and from pole to pole
SKY, SPHERE_CELLS = 200.0, (64, 32)
# Multiples of these fill a square evenly, for any count: powers of 1 / 1.3247..., the R2 sequence
R2 = (0.7548776662466927, 0.5698402909980532)
GOLDEN = 0.6180339887498949

VERTEX = """#version 330
in vec2 corner, size;
in vec3 place, color, other, look;
in vec4 bend;
uniform vec3 eye, eyeBefore;
uniform vec2 lens, shift, time, zoom; // time, zoom: now and before
uniform float focus, aspect;
out vec2 at;
out vec3 now, before;
flat out vec3 first, second, kind;

vec3 placed(float frame)
{
    if (look.x == 3.0) {
        vec2 angle = corner * vec2(3.14159265, 1.57079633);
        return place + size.x * vec3(cos(angle.y) * sin(angle.x), sin(angle.y), -cos(angle.y) * cos(angle.x));
    }
    if (look.x == 2.0)
        return place + vec3(corner.x * size.x, 0.0, corner.y * size.y);
    float angle = bend.x + bend.w * sin(0.11 * frame + 9.0 * place.x);
    vec2 upright = mat2(cos(angle), sin(angle), -sin(angle), cos(angle)) * (corner * size);
    return place + vec3(upright, dot(upright, bend.yz));
}

void main()
{
    at = corner, first = color, second = other, kind = look;
    now = placed(time.x) - eye;
    before = placed(time.y) - eyeBefore;
    // image heights, down; what is in focus is where the pinhole has it, from all points of the lens
    vec2 image = zoom.x * ((now.xy - lens) / now.z + lens / focus) + shift;
    const float near = 0.05, far = 300.0;
    float depth = (far + near) / (far - near) * now.z - 2.0 * far * near / (far - near);
    gl_Position = vec4(2.0 * image / vec2(aspect, 1.0) * now.z, depth, now.z);
}
"""
FRAGMENT = """#version 330
in vec2 at;
in vec3 now, before;
flat in vec3 first, second, kind;
uniform vec2 zoom;
layout(location = 0) out vec4 seen; // colour, depth in metres
layout(location = 1) out vec4 moved;

void main()
{
    if (kind.x == 0.0 && dot(at, at) > 1.0)
        discard;
    vec2 cell = floor(at * kind.z), inCell = abs(at * kind.z - cell - vec2(0.5, 0.525));
    bool odd = kind.y == 1.0 && mod(cell.x + cell.y, 2.0) > 0.5;
    bool wall = kind.y == 2.0 && any(greaterThan(inCell, vec2(0.2, 0.275)));
    bool dapple = kind.y == 3.0 && sin(9.0 * at.x) * sin(9.0 * at.y) >= 0.0;
    seen = vec4(odd || wall || dapple ? second : first, now.z);
    if (kind.y == 4.0)
        seen.rgb *= 0.35 + 0.65 * max(0.0, 1.0 - length(at + vec2(0.3, 0.35)));
    moved = vec4(zoom.x * now.xy / now.z - zoom.y * before.xy / before.z, 0.0, 0.0);
}
"""
FULL_SCREEN = (
    "#version 330\nvoid main() { gl_Position = vec4(ivec2(gl_VertexID & 1, gl_VertexID >> 1) * 4 - 1, 0.0, 1.0); }"
)
# A point is "hidden" if it lies behind all of the 3 x 3 pixels around its position in the pinhole's image, or outside
# that image.
ADD = f"""#version 330
uniform sampler2D views, pinhole;
uniform vec4 points[{VIEWS}]; // of the lens, metres; of the pixel, image heights
uniform float focus, zoom;
layout(location = 0) out vec4 sum; // colour, how many views see what is hidden
layout(location = 1) out vec4 hidden;

void main()
{{
    ivec2 size = textureSize(pinhole, 0), pixel = ivec2(gl_FragCoord.xy);
    sum = hidden = vec4(0.0);
    for (int k = 0; k < {VIEWS}; k++) {{
        vec4 seen = texelFetch(views, pixel + ivec2(0, k * size.y), 0), point = points[k];
        vec2 place = gl_FragCoord.xy + float(size.y) * (zoom * point.xy * (1.0 / seen.a - 1.0 / focus) - point.zw);
        float farthest = 0.0;
        if (all(greaterThanEqual(place, vec2(0.0))) && all(lessThan(place, vec2(size))))
            for (int n = 0; n < 9; n++) {{
                ivec2 beside = ivec2(place) + ivec2(n % 3, n / 3) - 1;
                farthest = max(farthest, texelFetch(pinhole, clamp(beside, ivec2(0), size - 1), 0).a);
            }}
        float behind = seen.a > farthest * 1.01 ? 1.0 : 0.0;
        sum += vec4(seen.rgb, behind);
        hidden += seen * behind;
    }}
}}
"""


class Thing(NamedTuple):
    """Describe an opaque object with uniform emission; leaves and lights are discs, bars are cards. Lengths are in
    metres, colours linear.

    place   position of its middle: right, down and away from the origin
    size    half its width and height; for a floor width and depth, for a sphere twice the radius
    other   second colour of a pattern
    cells   number of checks or windows per half of the width
    turn    rotation in radians, from right to down
    lean    metres away per metre to the right, and down
    sway    amplitude of a swinging rotation, radians
    """

    place: tuple[float, float, float]
    size: tuple[float, float]
    color: Sequence[float]
    other: Sequence[float] = (0.0, 0.0, 0.0)
    shape: str = "card"
    pattern: str = "plain"
    cells: float = 0.0
    turn: float = 0.0
    lean: tuple[float, float] = (0.0, 0.0)
    sway: float = 0.0


class Scene(NamedTuple):
    """Hold objects at a moment.

    eye    position of the camera, as Thing.place
    time   number of the frame, for objects that sway
    sides  number of sides of the aperture, two of which are vertical
    """

    things: tuple[Thing, ...]
    camera: Camera
    eye: tuple[float, float, float] = (0.0, 0.0, 0.0)
    time: float = 0.0
    sky: Sequence[float] = (0.01, 0.012, 0.02)
    sides: int = 6

    @property
    def zoom(self) -> float:
        """Return the distance of the image behind the lens, over the sensor's height."""
        focal, focus = self.camera.focal_length, self.camera.focus_distance
        return focal * focus / (focus - focal) / self.camera.sensor_height


class Pinhole(NamedTuple):
    """Hold the input of a filter.

    color  (H, W, 4) float16
    depth  of one sample, (H, W) float32, metres
    moved  pixels right and down that each pixel has moved since the previous moment, (H, W, 2)
    """

    color: np.ndarray
    depth: np.ndarray
    moved: np.ndarray


class Lens(NamedTuple):
    """Hold the truth.

    color         (H, W, 3) float32
    hidden        fraction of the lens that sees what the pinhole's image does not contain, (H, W)
    hidden_color  the light of that fraction, (H, W, 3)
    """

    color: np.ndarray
    hidden: np.ndarray
    hidden_color: np.ndarray


class Rasteriser:
    """Draw scenes of a size (width, height) through `points` of the aperture, a multiple of VIEWS.

    Raises Unavailable without OpenGL.
    """

    def __init__(self, size: tuple[int, int], points: int = 384, driver: drivers.Driver | None = None):
        self.size, self.points = size, points
        self.driver = driver if isinstance(driver, GLDriver) else drivers.load("egl")
        self.driver.make_current()
        context, (width, height) = self.driver.context, size
        self.program, self.adding = context.program(VERTEX, FRAGMENT), context.program(FULL_SCREEN, ADD)
        self.adding["views"], self.adding["pinhole"] = 0, 1
        self.full_screen = context.vertex_array(self.adding, [])
        self.meshes = [context.buffer(_mesh(*cells)) for cells in ((1, 1), SPHERE_CELLS)]
        extents = [size, size, (width, VIEWS * height), size, size]
        self.textures = [context.texture(extent, 4, dtype="f4") for extent in extents]
        pinhole, moved, views, *sums = self.textures
        self.pinhole_frame = context.framebuffer([pinhole, moved], context.depth_renderbuffer(size))
        self.view_frame = context.framebuffer([views], context.depth_renderbuffer(views.size))
        self.sum_frame = context.framebuffer(sums)

    def pinhole(
        self, scene: Scene, before: Scene | None = None, antialiased: bool = False, place: Sequence[float] = (0.0, 0.0)
    ) -> Pinhole:
        """Draw a scene through a pinhole, with one colour sample per pixel or ANTIALIASING of them.

        before  the scene at the previous moment, for `moved`
        place   position of the sample, pixels from the middle of its pixel
        """
        self._draw(self.pinhole_frame, scene, np.array([(0.0, 0.0, *place)]), before)
        color, moved = map(self._read, self.textures[:2])
        # a clear writes the sky's colour to every target
        depth, moved = color[..., 3].copy(), np.where(color[..., 3:] == SKY, 0.0, moved[..., :2] * self.size[1])
        if antialiased:
            color = self._average(scene, np.zeros((ANTIALIASING, 2)))[0]
        return Pinhole(np.dstack([color[..., :3], np.ones_like(depth)]).astype(np.float16), depth, moved)

    def lens(self, scene: Scene) -> Lens:
        """Draw the truth; each point of the lens has its own position in the pixel."""
        self._draw(self.pinhole_frame, scene, np.zeros((1, 4)))
        square, corners = (
            np.outer(np.arange(3 * self.points), R2) % 1.0 - 0.5,
            aperture_shapes.even_polygon(scene.sides),
        )
        points = square[geometry.inside(corners, *square.T)][: self.points] * scene.camera.aperture_diameter
        # in an order that is unrelated to the order of the positions in the pixel
        color, hidden = self._average(scene, np.random.default_rng(1).permutation(points))
        return Lens(color[..., :3], color[..., 3], hidden[..., :3])

    def _average(self, scene: Scene, lens: np.ndarray) -> list[np.ndarray]:
        """Return the means of ADD's outputs over points of the lens (n, 2)."""
        context, adding = self.driver.context, self.adding
        adding["focus"], adding["zoom"] = scene.camera.focus_distance, scene.zoom
        self.sum_frame.clear()
        views = np.hstack([lens, places_in_pixel(len(lens))])
        for first in range(0, len(lens), VIEWS):
            portion = views[first : first + VIEWS]
            self._draw(self.view_frame, scene, portion)
            adding["points"].write((portion / (1, 1, self.size[1], self.size[1])).astype("f4").tobytes())
            with context.scope(self.sum_frame, moderngl.BLEND):
                context.blend_func = moderngl.ONE, moderngl.ONE
                self.textures[2].use(0)
                self.textures[0].use(1)
                self.full_screen.render(moderngl.TRIANGLES, vertices=3)
        return [self._read(texture) / len(lens) for texture in self.textures[3:]]

    def _draw(self, frame: moderngl.Framebuffer, scene: Scene, views: np.ndarray, before: Scene | None = None) -> None:
        """Draw the scene once per view, one below the other; views (n, 4): point of the lens in metres, position in
        the pixel.
        """
        self.driver.make_current()
        (width, height), before, program = self.size, before or scene, self.program
        program["eye"], program["eyeBefore"] = scene.eye, before.eye
        program["time"], program["zoom"] = (scene.time, before.time), (scene.zoom, before.zoom)
        program["focus"], program["aspect"] = scene.camera.focus_distance, width / height
        # nearest objects first, so that what they hide is not shaded
        things = sorted(scene.things, key=lambda thing: thing.place[2])
        arrays = [self._array([t for t in things if (t.shape == "sphere") == spheres], spheres) for spheres in (0, 1)]
        frame.clear(*scene.sky, SKY)
        with self.driver.context.scope(frame, moderngl.DEPTH_TEST):
            for row, (*lens, x, y) in enumerate(views.tolist()):
                frame.viewport = 0, row * height, width, height
                program["lens"], program["shift"] = lens, (x / height, y / height)
                for array, count in filter(None, arrays):
                    array.render(moderngl.TRIANGLES, instances=count)

    def _array(self, things: Sequence[Thing], spheres: int) -> tuple[moderngl.VertexArray, int] | None:
        """Return the vertex array of objects that share a mesh, and their number; None if there are none."""
        if not things:
            return None
        rows = [
            (*thing.size, *thing.place, *thing.color, *thing.other, SHAPES.index(thing.shape),
             PATTERNS.index(thing.pattern), thing.cells, thing.turn, *thing.lean, thing.sway) for thing in things
        ]  # fmt: skip
        numbers = self.driver.context.buffer(np.array(rows, "f4").tobytes())
        names, corner = ("size", "place", "color", "other", "look", "bend"), (self.meshes[spheres], "2f", "corner")
        array = self.driver.context.vertex_array(self.program, [corner, (numbers, "2f 3f 3f 3f 3f 4f/i", *names)])
        return array, len(things)

    def _read(self, texture: moderngl.Texture) -> np.ndarray:
        return np.frombuffer(texture.read(), "f4").reshape(*texture.size[::-1], 4)


def _mesh(columns: int, rows: int) -> bytes:
    """Return triangles that cover -1 to 1, two per cell."""
    cells = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1).reshape(-1, 1, 2)
    corners = cells + np.array([(0, 0), (1, 0), (0, 1), (0, 1), (1, 0), (1, 1)])
    return (corners / (columns, rows) * 2.0 - 1.0).astype("f4").tobytes()


def places_in_pixel(count: int) -> np.ndarray:
    """Return evenly spread positions in a pixel, in pixels from its middle, which is their mean: (count, 2)."""
    numbers = np.arange(count)
    places = np.stack([(numbers + 0.5) / count, numbers * GOLDEN % 1.0], axis=-1)
    return places - places.mean(axis=0)
