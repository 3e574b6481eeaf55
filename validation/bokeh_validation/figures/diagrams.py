"""Figures 4, 8 and 10, drawn from the tables and plans that the code runs with."""

from dataclasses import replace
from math import degrees
from typing import NamedTuple

import numpy as np
from PIL import Image, ImageDraw

from bokeh_validation.drivers.base import Driver
from bokeh_validation.figures import panels, points
from bokeh_validation.figures.figure import Made, Table, named
from bokeh_validation.frame import apertures, fetches, methods, polygons, sheet
from bokeh_validation.probes import impulse, shapes
from bokeh_validation.reference.lines import lines
from bokeh_validation.shaders.passes import Pass

KERNELS = {"hexagon": "a", "octagon": "b"}


def kernels(_: Driver | None = None) -> Made:
    """Figure 4: the tables of the naive gather, dot by dot, in their outline."""
    shapes = {name: _outline(name) for name in KERNELS}
    reach = max(float(np.abs(corners).max()) for corners in shapes.values())
    canvas = sheet.Canvas(len(KERNELS), 1.04 * reach)
    numbers = []
    for panel, (name, letter) in enumerate(KERNELS.items()):
        table = apertures.kernel(name, methods.PAPER_SAMPLES)
        canvas.path(panel, sheet.CIRCLE, sheet.FAINT, 1)
        canvas.path(panel, shapes[name], sheet.color(panel), 1.5)
        for place in table:
            canvas.dot(panel, place, sheet.INK, 3)
        sheet.caption(canvas, panel, f"({letter}) {name}:\n{len(table)} samples")
        inside = polygons.inside(1.0001 * shapes[name], table[:, 0], table[:, 1])
        numbers.append((name, (float(len(table)), float(inside.sum()))))
    columns = Table(("samples", "of them inside the outline"), numbers, (0, 0))
    return Made({"figure_04": canvas.finished()}, {}, (columns,))


def _outline(aperture: str) -> np.ndarray:
    return shapes.outline(methods.Settings("paper", aperture))


COMBINED = {"hexagon": "a", "octagon": "b", "star": "c"}


def booleans(_: Driver | None = None) -> Made:
    """Figure 8: both parallelograms of each aperture and what is kept of them."""
    rows, numbers = [], []
    for name, letter in COMBINED.items():
        parts = [part.corners() for part in apertures.PARALLELOGRAMS[name]]
        union = name in apertures.USES_MAX
        reach = max(float(np.abs(part).max()) for part in parts)
        canvas = sheet.Canvas(3, 1.04 * reach)
        common = polygons.clip_convex(*parts)
        for panel, (part, shape) in enumerate(zip(parts, apertures.PARALLELOGRAMS[name], strict=True)):
            canvas.polygon(panel, part, sheet.lighter(sheet.color(panel)))
            canvas.path(panel, part, sheet.color(panel), 2)
            for angle, width in ((shape.first, 5), (shape.second, 3)):
                half = 0.5 * apertures.direction(np.radians(angle))
                canvas.path(panel, np.array([-half, half]), sheet.INK, width)
            sheet.caption(canvas, panel, f"line at {shape.first:g}°,\nthen line at {shape.second:g}°")
        for part in parts if union else [common]:
            canvas.polygon(2, part, sheet.SHAPE)
        for index, part in enumerate(parts):
            canvas.path(2, part, sheet.color(index), 2)
        how = "max: in either" if union else "min: in both"
        sheet.caption(canvas, 2, f"({letter}) {name},\n{how}")
        rows.append(canvas.finished())
        # of the union of two that cross: those of both, and where their sides cross
        corners = sum(map(len, parts)) + len(common) if union else len(common)
        numbers.append((name, (impulse.light_kept(name), float(corners))))
    table = Table(("area over that of one parallelogram", "corners"), numbers, (3, 0))
    return Made({"figure_08": np.vstack(rows)}, {}, (table,))


class Node(NamedTuple):
    """A box of a workflow.

    name     of the texture that is shown
    label    lines over it
    layer    0 for the CoC map, else one more than the farthest box that it is made of
    sources  names of the boxes that it is made of
    """

    name: str
    label: tuple[str, ...]
    layer: int
    sources: tuple[str, ...]


def separated(plan: methods.Plan) -> tuple[Pass, ...]:
    """The passes of a plan, with the parallelogram that a final pass combines also drawn for itself, as 'alone'."""
    *passes, final = plan.passes
    if final.entry.endswith("Final"):
        inputs = {slot: name for slot, name in final.inputs.items() if slot != "ColorSampB"}
        passes.append(replace(final, entry=final.entry.removesuffix("Final"), inputs=inputs, output="alone"))
    return (*passes, final)


def workflow(passes: tuple[Pass, ...]) -> list[Node]:
    """The boxes of separated passes, in order; depth is left out, which all passes read."""
    nodes: dict[str, Node] = {}
    for number, item in enumerate(passes):
        sources = tuple(name for slot, name in item.inputs.items() if slot != "DepthSamp" and name in nodes)
        if item.entry.endswith("Final"):
            sources = (item.inputs["ColorSampB"], "alone")
        layer = 1 + max((nodes[name].layer for name in sources), default=-1)
        for index, output in enumerate(item.outputs):
            nodes[output] = Node(output, _label(number, item, index), layer, sources)
    return list(nodes.values())


def _label(number: int, item: Pass, index: int) -> tuple[str, ...]:
    """Lines over a target of a pass: which pass it is, and the angles of what it averages along."""
    if number == 0:
        return ("CoC map",)
    if item.entry.endswith("Final"):
        return ("max" if item.parameters["BokehUseMax"] else "min", f"in pass {number - 1}")
    halves = [line.segment.half for line in lines(item) if line.shares[index] > 0.0]
    angles = [f"{degrees(np.arctan2(y, x)) % 180.0:.4g}°" for x, y in halves]
    several = f", target {index + 1}" if len(item.outputs) > 1 else ": sum of" if len(angles) > 1 else ""
    return (f"pass {number}{several}", ", ".join(angles))


THUMB, ACROSS, DOWN, HEAD = 88, 52, 46, 26
WORKFLOWS = (("paper", "hexagon"), ("paper", "octagon"), ("exact", "hexagon"), ("exact", "octagon"))


def workflows(driver: Driver) -> Made:
    """Figure 10: each workflow with what its passes make of a bright point."""
    graphs, numbers, images = [], [], {}
    for (method, aperture), letter in zip(WORKFLOWS, "abcd", strict=True):
        case = points.case(method, aperture, ((THUMB // 2, THUMB // 2),), (THUMB, THUMB))
        passes = separated(case.plan)
        nodes = workflow(passes)
        outputs = driver.run(passes, case.textures(), case.size, keep=[node.name for node in nodes])
        graphs.append(_graph(f"({letter}) {method}, {aperture}", nodes, outputs, case.exposure))
        count = methods.plan(methods.Settings(method, aperture), case.size).passes
        numbers.append((f"{aperture}, {method}", (float(len(count) - 1), fetches.of_filters(count))))
        images |= named(f"figure_10_{letter}", {node.name.replace(" ", "_"): outputs[node.name] for node in nodes[1:]})
    table = Table(("passes", "colour fetches a pixel"), numbers, (0, 0))
    return Made({"figure_10": _joined([_joined(graphs[:2], 0), _joined(graphs[2:], 0)], 1)}, images, (table,))


def _joined(images: list[np.ndarray], axis: int) -> np.ndarray:
    """Pictures below each other (axis 0) or beside each other (axis 1), on white."""
    most = max(image.shape[1 - axis] for image in images)
    around = [(((0, 0), (0, most - i.shape[1])) if axis == 0 else ((0, most - i.shape[0]), (0, 0))) for i in images]
    padded = [np.pad(i, (*p, (0, 0)), constant_values=255) for i, p in zip(images, around, strict=True)]
    return np.concatenate(padded, axis=axis)


def _graph(title: str, nodes: list[Node], outputs: dict[str, np.ndarray], exposure: float) -> np.ndarray:
    """Boxes from left to right by layer, arrows from what they are made of."""
    layers: dict[int, list[Node]] = {}
    for node in nodes:
        layers.setdefault(node.layer, []).append(node)
    tallest = max(map(len, layers.values()))
    places = {}
    for layer, members in layers.items():
        top = HEAD + (tallest - len(members)) * (THUMB + DOWN) / 2
        for row, node in enumerate(members):
            places[node.name] = (20 + layer * (THUMB + ACROSS), round(top + row * (THUMB + DOWN) + DOWN - 10))
    scale = sheet.SUPERSAMPLING
    width, height = 20 + len(layers) * (THUMB + ACROSS), HEAD + tallest * (THUMB + DOWN) + 6
    page = Image.new("RGB", (scale * width, scale * height), "white")
    draw = ImageDraw.Draw(page)
    for node in nodes:
        for source in node.sources:
            # from the right side of one box to the left side of another
            start = np.array(places[source]) + (THUMB + 2.0, THUMB / 2)
            end = np.array(places[node.name]) + (-2.0, THUMB / 2)
            panels.arrow(draw, scale * start, scale * end, (90, 90, 90), 1.6 * scale)
    for node in nodes:
        x, y = places[node.name]
        pixels = points.shown(outputs[node.name], exposure, scale)
        page.paste(Image.fromarray(pixels), (scale * x, scale * y))
        style = {"fill": sheet.INK, "font": panels.font(scale * panels.TEXT), "anchor": "mm", "stroke_fill": "white"}
        for row, text in enumerate(node.label[::-1]):
            place = (scale * (x + THUMB / 2), scale * (y - 10 - 16 * row))
            draw.text(place, text, stroke_width=2 * scale, **style)
    draw.text((scale * 10, scale * 14), title, fill=sheet.INK, font=panels.font(scale * 15), anchor="lm")
    return np.asarray(page.resize((width, height), Image.Resampling.BOX))
