"""Draw docs/images/flip_by_method.svg: FLIP of every method and effect, mean and by scene, from docs/data."""

from html import escape

from bokeh_validation.generate import results

# Lengths in pixels of the drawing; MOST is the FLIP at the right border
LEFT, TOP, ROW, WIDTH, MOST = 200, 20, 24, 560, 0.56
OURS, OTHERS, DOT = "#2f7d6d", "#9aa5b1", "#222"


def _x(flip: float) -> float:
    """Return the horizontal position of a FLIP, in pixels from the left."""
    return round(LEFT + WIDTH * flip / MOST, 1)


def draw() -> str:
    """Return the chart as SVG: a bar for each mean, the lowest first; a dot for each of the five scenes."""
    rows, means = results.ray_traced(), results.flip_means()
    labels = sorted(means, key=means.__getitem__)
    bottom = TOP + ROW * len(labels)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {LEFT + WIDTH + 40} {bottom + 56}" '
        f'width="{LEFT + WIDTH + 40}">',
        "<style>text{font:12px sans-serif;fill:#222}.grid{stroke:#ddd}</style>",
        '<rect width="100%" height="100%" fill="#fff"/>',
    ]
    for tenth in range(6):
        x = _x(tenth / 10)
        lines.append(f'<path class="grid" d="M{x} {TOP}V{bottom}"/>')
        lines.append(f'<text x="{x}" y="{bottom + 18}" text-anchor="middle">0.{tenth}</text>')
    for number, label in enumerate(labels):
        y, color = TOP + ROW * number, OURS if label.startswith("layered") else OTHERS
        lines.append(f'<text x="{LEFT - 8}" y="{y + 16}" text-anchor="end">{escape(label)}</text>')
        lines.append(f'<rect x="{LEFT}" y="{y + 4}" width="{_x(means[label]) - LEFT:.1f}" height="16" fill="{color}"/>')
        for scene in results.SCENES:
            lines.append(f'<circle cx="{_x(rows[label][scene]["flip"])}" cy="{y + 12}" r="2.5" fill="{DOT}"/>')
    lines.append(
        f'<text x="{LEFT}" y="{bottom + 42}">FLIP (0 is best). Bar: mean of five scenes. Dots: each scene.</text>'
    )
    return "\n".join([*lines, "</svg>"]) + "\n"
