// The passes of a frame. The harness (methods.plan) has written them into the page; here, they get the values of the
// controls.

// Returns the passes of a frame: [{ fragment, inputs, targets, size, values }].
//   settings  { method, blades, preset, rotation (degrees), squeeze, stop, scale, focal (metres), focus (metres) }
export function frame({ plans, passes, apertures, glsl, sensor, maxCoC }, settings, [width, height]) {
  const name = `${settings.method} ${apertures[settings.blades]}`;
  const lens = {
    BokehApertureDiameter: (settings.focal / settings.stop) * settings.scale,
    BokehFocalLength: settings.focal,
    BokehFocusDistance: settings.focus,
    BokehSensorHeight: sensor,
    BokehMaxCoC: maxCoC,
    BokehAspectRatio: width / height,
    BokehImageWidth: width,
    BokehImageHeight: height,
    BokehSqueeze: settings.squeeze,
  };
  // paper has no presets
  return (plans[`${name} ${settings.preset}`] ?? plans[name]).map((number) => passes[number]).map((pass) => ({
    ...pass,
    fragment: pass.head + glsl,
    size: [width, height].map((side) => Math.ceil(side / pass.scale)),
    values: { ...turned(pass.values, settings.rotation), ...lens },
  }));
}

// Returns the values of a pass, with the aperture rotated.
function turned(values, degrees) {
  const angle = (degrees * Math.PI) / 180;
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const { BokehLineCenterX: x, BokehLineCenterY: y } = values;
  const center = { BokehLineCenterX: c * x - s * y, BokehLineCenterY: s * x + c * y };
  return { ...values, BokehAngle: values.BokehAngle + angle, ...center };
}
