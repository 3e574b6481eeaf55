// SPDX-License-Identifier: MIT
//
// Depth for glass, particles, hair and splats in a scene of WebGLRenderer: that of all surfaces in a pixel, weighted by their
// opacity.

import { AddEquation, Color, CustomBlending, HalfFloatType, NearestFilter, OneFactor, OneMinusSrcAlphaFactor } from 'three';
import { RGFormat, Vector3, WebGLRenderTarget } from 'three';

const FORMAT = { type: HalfFloatType, format: RGFormat, minFilter: NearestFilter, magFilter: NearestFilter };
// Each surface over those behind it
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

// The material of a surface, but it writes metres times opacity, and opacity, in place of colour. Everything else is read
// through the prototype, so it follows what the scene does with the material.
// planes  uniform: near, far, 1 if the camera is orthographic
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

// For the option depthTexture: after a RenderPass the scene is drawn once more, for its depth weighted by opacity. A
// transparent surface then gets a blur between its own and that of what is behind it, by its opacity.
export function depthWithOpacity(renderPass) {
  const { render, dispose } = renderPass;
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
    renderer.setRenderTarget(target);
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

  renderPass.render = (renderer, writeBuffer, readBuffer, ...others) => {
    render.call(renderPass, renderer, writeBuffer, readBuffer, ...others);
    target.setSize(readBuffer.width, readBuffer.height);
    draw(renderer);
  };
  renderPass.dispose = () => {
    for (const own of [target, ...materials.values()]) own.dispose();
    dispose.call(renderPass);
  };
  return target.texture;
}
