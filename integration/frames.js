// SPDX-License-Identifier: MIT
//
// The frames of layered, exact and paper, for the classes of three.js, Babylon.js and PlayCanvas, which put the calls into
// shaders of their own. It goes beside them: a package has it there, and the samples' pages have an import map.
//
// A frame is a table of passes. A row has the textures that it writes, 1 / their size, and the call, which names the
// textures that it reads: docs/passes.md. `color` is the scene's, `metres` its depth. Where a row writes several
// textures, the function returns them as T2, T3, T4, T5. The calls are GLSL; for WGSL the classes put the samplers in.

// 'SignedCoCMap' for layered and exact, whose passes read no depth; 'CoCMap' for paper
export const cocMap = (name) => [
  ['coc'],
  1,
  `Bokeh${name}(color, metres, uv, apertureDiameter, focalLength, focusDistance, sensorHeight, maxCoC)`,
];

// Two passes blur with a polygon; between them are half as many textures as it has sides, less one. The function of the
// second takes four: it gets the last one for the rest, and does not read it.
const between = (stem, sides) => [2, 3, 4, 5].slice(0, sides / 2 - 1).map((k) => `${stem}${k}`);
const four = (names) => names.concat(Array(4 - names.length).fill(names.at(-1))).join(', ');

export function layered(sides) {
  const one = sides === 4 ? '.T2' : '';
  const near = between('nearTarget', sides);
  const far = between('farTarget', sides);
  const [rows, columns] = ['vec2(1.0, 0.0)', 'vec2(0.0, 1.0)'];
  return [
    [['tiles'], 8, 'BokehLayerTiles(coc, uv, layers)'],
    [['reachAlongRows'], 8, `BokehLayerReach(tiles, uv, ${rows}, layers)`],
    [['reach'], 8, `BokehLayerReach(reachAlongRows, uv, ${columns}, layers)`],
    [['near', 'far', 'sums', 'leftovers'], 2, 'BokehLayerSplit(coc, reach, uv, layers)'],
    [['tileLeftovers', 'tileSums'], 8, 'BokehLayerKernels(sums, leftovers, uv, layers)'],
    [['rowLeftovers', 'rowSums'], 8, `BokehLayerSpread(tileLeftovers, tileSums, reach, uv, ${rows}, layers)`],
    [['reaches', 'sizes'], 8, 'BokehLayerSizes(rowLeftovers, rowSums, reach, uv, layers)'],
    [['middleWithHoles', 'farWithHoles', 'shares'], 4, 'BokehLayerHoles(coc, reach, uv, layers)'],
    [['middle', 'back'], 4, 'BokehLayerFill(middleWithHoles, farWithHoles, shares, reach, uv, layers)'],
    [near, 2, `BokehLayerFirst(near, sizes, uv, false, layers)${one}`],
    [['nearBlurred'], 2, `BokehLayerSecond(${four(near)}, sizes, uv, false, layers)`],
    [far, 2, `BokehLayerFirst(far, sizes, uv, true, layers)${one}`],
    [['farBlurred'], 2, `BokehLayerSecond(${four(far)}, sizes, uv, true, layers)`],
    [['result'], 1, 'BokehLayered(coc, reaches, nearBlurred, farBlurred, middle, back, uv, layers)'],
  ];
}

export function exact(sides) {
  const one = sides === 4 ? '.T2' : '';
  const targets = between('target', sides);
  return [
    [targets, 1, `BokehExactFirst(coc, uv, polygon, settings)${one}`],
    [['result'], 1, `BokehExactSecond(${four(targets)}, uv, polygon, settings)`],
  ];
}

// Each pair of lines is a parallelogram, and min of the two is the polygon (docs/apertures.md).
export function paper(sides) {
  const line = (degrees, from) => {
    const segment = `BokehSegment(radians(${degrees}.0) + rotation, 1.0, vec2(0.0, 0.0), squeeze)`;
    return `BokehDepthOfFieldAdaptive(${from}, metres, uv, ${segment}, settings, true)`;
  };
  const combined = (a, b) => `BokehCombine(${a}, BokehFetch(${b}, uv), false)`;
  if (sides === 6) {
    return [
      [['line1'], 1, line(90, 'coc')],
      [['line2'], 1, line(30, 'line1')],
      [['result'], 1, combined(line(150, 'line1'), 'line2')],
    ];
  }
  return [
    [['line1'], 1, line(0, 'coc')],
    [['line2'], 1, line(90, 'line1')],
    [['line3'], 1, line(45, 'coc')],
    [['result'], 1, combined(line(135, 'line3'), 'line2')],
  ];
}
