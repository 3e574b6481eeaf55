// Our passes beside them, by the code of the browser driver: its job is { images, passes, vertex }.

import { draw, onto, start, texture } from "./browser/webgl2.js";

export function ours({ images, passes, vertex }) {
  const gl = start();
  const textures = images.map(texture);
  return {
    gl,
    set() {},
    draw: () => {
      for (const pass of passes) onto(pass.targets.map((image) => textures[image]), () => draw(pass, vertex, textures));
    },
    close: () => textures.forEach((one) => gl.deleteTexture(one)),
  };
}
