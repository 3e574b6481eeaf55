// WebGLRenderer: three.js's BokehPass and the DepthOfFieldEffect of pmndrs' postprocessing.

import * as THREE from "three";
import { BokehPass as ThreeBokehPass } from "three/addons/postprocessing/BokehPass.js";
import { EffectComposer } from "three/addons/postprocessing/EffectComposer.js";
import { RenderPass } from "three/addons/postprocessing/RenderPass.js";
import * as pmndrs from "postprocessing";
import { FEED, VERTEX, canvasOf, degrees } from "./feed.js";

const HALF = THREE.HalfFloatType;

function setUp(scene) {
  const { width, height, near, far } = scene;
  const texture = (data, format, type) => {
    const made = new THREE.DataTexture(data, width, height, format, type);
    made.needsUpdate = true;
    return made;
  };
  const uniforms = {
    peerColor: { value: texture(scene.color, THREE.RGBAFormat, scene.color instanceof Uint16Array ? HALF : THREE.FloatType) },
    peerDepth: { value: texture(scene.depth, THREE.RedFormat, THREE.FloatType) },
    peerNear: { value: near },
    peerFar: { value: far },
  };
  const material = (main) =>
    new THREE.ShaderMaterial({ uniforms, vertexShader: VERTEX, fragmentShader: `#include <packing>\n${FEED}void main() { ${main} }` });
  const quad = new THREE.Mesh(
    new THREE.PlaneGeometry(2, 2),
    material("gl_FragColor = peerLight(); gl_FragDepth = peerWindow();"),
  );
  quad.frustumCulled = false;
  const renderer = new THREE.WebGLRenderer({ canvas: canvasOf(scene) });
  renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
  const camera = new THREE.PerspectiveCamera(degrees(scene), width / height, near, far);
  camera.updateMatrixWorld();
  return { renderer, scene: new THREE.Scene().add(quad), camera, depth: material("gl_FragColor = packDepthToRGBA(peerWindow());") };
}

async function read(renderer, target) {
  const data = new Uint16Array(4 * target.width * target.height);
  await renderer.readRenderTargetPixelsAsync(target, 0, 0, target.width, target.height, data);
  return data;
}

// End it and free what it has
function ended(renderer) {
  const gl = renderer.getContext();
  renderer.dispose();
  gl.getExtension("WEBGL_lose_context").loseContext();
}

// three.js's own composer: the scene, then the pass that passOf makes from the result of setUp()
export function composed(handed, passOf, depthTexture = null) {
  const fed = setUp(handed);
  const { renderer, scene, camera } = fed;
  const target = new THREE.WebGLRenderTarget(handed.width, handed.height, { type: HALF, depthTexture });
  const composer = new EffectComposer(renderer, target);
  composer.renderToScreen = false;
  composer.addPass(new RenderPass(scene, camera));
  const pass = passOf(fed);
  composer.addPass(pass);
  return {
    gl: renderer.getContext(),
    enable: (on) => (pass.enabled = on),
    set: (parameters) => {
      for (const [name, value] of Object.entries(parameters)) pass.uniforms[name].value = value;
    },
    draw: () => composer.render(0),
    read: () => read(renderer, composer.readBuffer),
    close: () => ended(renderer),
  };
}

// Its own material for depth would draw that of the quad, which is flat
export const BokehPass = (handed) =>
  composed(handed, ({ scene, camera, depth }) => Object.assign(new ThreeBokehPass(scene, camera, {}), { _materialDepth: depth }));

export function DepthOfFieldEffect(handed) {
  const { renderer, scene, camera } = setUp(handed);
  const composer = new pmndrs.EffectComposer(renderer, { frameBufferType: HALF });
  composer.autoRenderToScreen = false;
  composer.addPass(new pmndrs.RenderPass(scene, camera));
  const effect = new pmndrs.DepthOfFieldEffect(camera, {});
  const pass = new pmndrs.EffectPass(camera, effect);
  composer.addPass(pass);
  composer.setSize(handed.width, handed.height, false);
  return {
    gl: renderer.getContext(),
    enable: (on) => (pass.enabled = on),
    set: ({ focusDistance, focusRange, bokehScale, resolutionScale }) => {
      Object.assign(effect.cocMaterial, { focusDistance, focusRange });
      Object.assign(effect, { bokehScale });
      effect.resolution.scale = resolutionScale;
    },
    draw: () => composer.render(0),
    read: () => read(renderer, composer.outputBuffer),
    close: () => ended(renderer),
  };
}
