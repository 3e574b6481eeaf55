// SPDX-License-Identifier: MIT
//
// Depth weighted by opacity, for glass, particles, hair and splats with WebGLRenderer: the mean depth of all surfaces
// in a pixel, weighted by how much each of them contributes to the colour (docs/inputs.md).

import { AddEquation, Color, CustomBlending, HalfFloatType, NearestFilter, OneFactor, OneMinusSrcAlphaFactor } from 'three';
import { RGFormat, Vector3, WebGLRenderTarget } from 'three';

const FORMAT = { type: HalfFloatType, format: RGFormat, minFilter: NearestFilter, magFilter: NearestFilter };
// Blends each surface over the surfaces behind it
const OVER = {
  blending: CustomBlending,
  blendEquation: AddEquation,
  blendEquationAlpha: null,
  blendSrc: OneFactor,
  blendSrcAlpha: null,
  blendDst: OneMinusSrcAlphaFactor,
  blendDstAlpha: null,
};
const OUTPUT = /\bout\s+(?:\w+\s+)?vec4\s+(\w+)/;

// Returns a copy of a material that writes metres times opacity into red, and opacity into green, instead of colour.
// The material is the prototype of the copy, so the copy follows all later changes of the material.
//   planes  uniform with near plane, far plane, and 1 if the camera is orthographic, else 0
function weighted(material, planes) {
  const { transmission = 0, transparent } = material;
  const glass = transmission > 0 ? { transmission: 0, transparent: true, depthWrite: false } : {};
  const own = {
    ...OVER,
    ...glass,
    _listeners: {},
    customProgramCacheKey: () => `${material.customProgramCacheKey()} weighted ${transmission} ${transparent}`,
    onBeforeCompile(shader, renderer) {
      material.onBeforeCompile(shader, renderer);
      const { fragmentShader: text } = shader;
      const output = OUTPUT.exec(text)?.[1] ?? 'gl_FragColor';
      const opacity = transparent ? `${output}.a` : (1 - transmission).toFixed(4);
      shader.uniforms.bokehPlanes = planes;
      shader.fragmentShader = `uniform vec3 bokehPlanes;
${text.slice(0, text.lastIndexOf('}'))}
  float bokehMetres = 1.0 / gl_FragCoord.w;
  if (bokehPlanes.z > 0.5) bokehMetres = mix(bokehPlanes.x, bokehPlanes.y, gl_FragCoord.z);
  ${output} = vec4(bokehMetres, 1.0, 0.0, 1.0) * ${opacity};
}`;
    },
  };
  const made = Object.create(material, Object.getOwnPropertyDescriptors(own));
  material.addEventListener('dispose', () => made.dispose());
  return made;
}

// Returns a texture for the option depthTexture, with depth weighted by opacity. After the call, the RenderPass draws the
// scene a second time to fill it. Each pixel of a transparent surface is then blurred as if it lay between the surface
// and the background: the more opaque the surface is, the nearer to the surface.
export function depthWithOpacity(renderPass) {
  const target = new WebGLRenderTarget(1, 1, FORMAT);
  const planes = { value: new Vector3() };
  const materials = new Map();
  const of = (material) => {
    if (Array.isArray(material)) return material.map(of);
    if (!materials.has(material)) materials.set(material, weighted(material, planes));
    return materials.get(material);
  };

  function draw(renderer) {
    const { scene, camera } = renderPass;
    const objects = [];
    scene.traverse((object) => object.material && objects.push([object, object.material]));
    planes.value.set(camera.near, camera.far, camera.isOrthographicCamera ? 1 : 0);
    const { background } = scene;
    const { autoClear, shadowMap } = renderer;
    const { autoUpdate } = shadowMap;
    const [color, alpha] = [renderer.getClearColor(new Color()), renderer.getClearAlpha()];
    scene.background = null;
    shadowMap.autoUpdate = false;
    renderer.autoClear = true;
    renderer.setClearColor(0, 0);
    try {
      for (const [object, material] of objects) object.material = of(material);
      renderer.render(scene, camera);
    } finally {
      for (const [object, material] of objects) object.material = material;
      scene.background = background;
      shadowMap.autoUpdate = autoUpdate;
      renderer.autoClear = autoClear;
      renderer.setClearColor(color, alpha);
    }
  }

  return drawnAfter(renderPass, target, draw, () => materials.values());
}

// Draws into a target each time after a RenderPass, and returns the target's texture. owned() returns what is disposed
// of together with the pass.
export function drawnAfter(renderPass, target, draw, owned) {
  const { render, dispose } = renderPass;
  renderPass.render = (renderer, writeBuffer, readBuffer, ...others) => {
    render.call(renderPass, renderer, writeBuffer, readBuffer, ...others);
    target.setSize(readBuffer.width, readBuffer.height);
    renderer.setRenderTarget(target);
    draw(renderer, readBuffer);
  };
  renderPass.dispose = () => {
    for (const own of [target, ...owned()]) own.dispose();
    dispose.call(renderPass);
  };
  return target.texture;
}
