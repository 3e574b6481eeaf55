// Babylon.js's DepthOfFieldEffect: its levels differ in their passes, so each is an effect of its own.

import { Constants } from "@babylonjs/core/Engines/constants.js";
import { Engine } from "@babylonjs/core/Engines/engine.js";
import { FreeCamera } from "@babylonjs/core/Cameras/freeCamera.js";
import { RawTexture } from "@babylonjs/core/Materials/Textures/rawTexture.js";
import { ShaderMaterial } from "@babylonjs/core/Materials/shaderMaterial.js";
import { Vector3 } from "@babylonjs/core/Maths/math.vector.js";
import { CreatePlane } from "@babylonjs/core/Meshes/Builders/planeBuilder.js";
import { DepthOfFieldEffect } from "@babylonjs/core/PostProcesses/depthOfFieldEffect.js";
import { PassPostProcess } from "@babylonjs/core/PostProcesses/passPostProcess.js";
import { PostProcessRenderPipeline } from "@babylonjs/core/PostProcesses/RenderPipeline/postProcessRenderPipeline.js";
import "@babylonjs/core/PostProcesses/RenderPipeline/postProcessRenderPipelineManagerSceneComponent.js";
import "@babylonjs/core/Engines/Extensions/engine.rawTexture.js";
import "@babylonjs/core/Engines/Extensions/engine.readTexture.js";
import { Scene } from "@babylonjs/core/scene.js";
import { FEED, VERTEX, canvasOf, upsideDown } from "./feed.js";

const HALF = Constants.TEXTURETYPE_HALF_FLOAT;
const NEAREST = Constants.TEXTURE_NEAREST_SAMPLINGMODE;

export function Babylon(handed) {
  const { width, height, near, far, fovy } = handed;
  const engine = new Engine(canvasOf(handed), false);
  const scene = new Scene(engine);
  const camera = new FreeCamera("camera", Vector3.Zero(), scene);
  Object.assign(camera, { minZ: near, maxZ: far, fov: fovy });
  const raw = (data, format, type) => new RawTexture(data, width, height, format, scene, false, false, NEAREST, type);

  // the effect takes depth in metres as a texture, here upright like what is drawn
  const depth = raw(upsideDown(handed.depth, handed), Constants.TEXTUREFORMAT_R, Constants.TEXTURETYPE_FLOAT);
  depth.activeCamera = camera;

  const main = "void main() { gl_FragColor = peerLight(); gl_FragDepth = 0.5; }";
  const text = { vertexSource: `attribute vec3 position;${VERTEX}`, fragmentSource: FEED + main };
  const names = { attributes: ["position"], uniforms: ["peerNear", "peerFar"], samplers: ["peerColor", "peerDepth"] };
  const material = new ShaderMaterial("feed", scene, text, names);
  material.backFaceCulling = false;
  material.setTexture("peerColor", raw(handed.color, Constants.TEXTUREFORMAT_RGBA, HALF)).setTexture("peerDepth", depth);
  material.setFloat("peerNear", near).setFloat("peerFar", far);
  const quad = CreatePlane("quad", { size: 2 }, scene);
  quad.material = material;
  quad.alwaysSelectAsActiveMesh = true;

  const manager = scene.postProcessRenderPipelineManager;
  let last = null;
  let level = null;
  let effect = null;
  const build = (next) => {
    if (level !== null) {
      last.dispose(camera);
      manager.detachCamerasFromRenderPipeline("peer", camera);
      manager.removePipeline("peer");
      effect.disposeEffects(camera);
    }
    level = next;
    effect = new DepthOfFieldEffect(scene, depth, level, HALF, false, true);
    const pipeline = new PostProcessRenderPipeline(engine, "peer");
    pipeline.addEffect(effect);
    manager.addPipeline(pipeline);
    manager.attachCamerasToRenderPipeline("peer", camera);
    last = new PassPostProcess("last", 1, camera, NEAREST, engine, false, HALF);
  };
  return {
    gl: engine._gl,
    enable: (on) => manager[`${on ? "enable" : "disable"}EffectInPipeline`]("peer", effect._name, camera),
    async set({ blurLevel, ...lens }) {
      if (blurLevel !== level) build(blurLevel);
      Object.assign(effect, lens);
      await scene.whenReadyAsync();
      while (!effect._isReady() || !last.isReady()) await new Promise((done) => setTimeout(done, 5));
    },
    draw: () => {
      engine.beginFrame();
      scene.render();
      engine.endFrame();
    },
    read: async () => {
      const bytes = await engine._readTexturePixels(last.inputTexture.texture, width, height, -1, 0, null, true, true);
      return new Uint16Array(bytes.buffer, bytes.byteOffset, 4 * width * height);
    },
  };
}
