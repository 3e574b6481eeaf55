// How a thin lens is told to each effect, as its documentation has its parameters.

// camera: { aperture, focal, focus, sensor }, metres. Circle of confusion at infinity, a diameter, over the image height
const farCoC = ({ aperture, focal, focus, sensor }) => (aperture * focal) / ((focus - focal) * sensor);

// Metres off the focus at which smoothstep is 1: there half of the far blur is reached where the lens has it, at twice the
// focus distance.
const range = ({ focus }) => 2 * focus;

// A thin lens, and Bevy's own limit of the diameter in pixels
const bevy = ({ aperture, focal, focus, sensor }) => {
  const scale = (focal * aperture) / sensor;
  return { focalDistance: focus, focalLength: focal, scale, maxDiameter: 64, maxDepth: 1e6 };
};

export const MAPPED = {
  // The radius is 0.4 min(aperture |z - focus|, maxblur) image widths: here the slope is the lens's at the focus, the limit
  // the lens's at infinity
  BokehPass: (camera, [width, height]) => {
    const maxblur = (farCoC(camera) * height) / (0.8 * width);
    return { focus: camera.focus, aperture: maxblur / camera.focus, maxblur };
  },
  // bokehScale: the radius in pixels
  DepthOfFieldNode: (camera, [, height]) => {
    return { focusDistance: camera.focus, focalLength: range(camera), bokehScale: 0.5 * farCoC(camera) * height };
  },
  DepthOfFieldEffect: (camera, [, height]) => {
    return { focusDistance: camera.focus, focusRange: range(camera), bokehScale: 0.5 * farCoC(camera) * height };
  },
  // A lens in millimetres
  Babylon: ({ aperture, focal, focus }) => {
    return { focusDistance: 1000 * focus, focalLength: 1000 * focal, lensSize: 1000 * focal, fStop: focal / aperture };
  },
  // blurRadius: pixels of a picture of 540 rows
  CameraFrame: (camera) => {
    return { focusDistance: camera.focus, focusRange: range(camera), blurRadius: 0.5 * farCoC(camera) * 540 };
  },
  BevyBokeh: bevy,
  BevyGaussian: bevy,
};
