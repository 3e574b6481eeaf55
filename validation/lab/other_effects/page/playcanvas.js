// PlayCanvas's CameraFrame with nothing of it but depth of field.

import * as pc from "playcanvas";
import { FEED, VERTEX, canvasOf, degrees, upsideDown } from "./feed.js";

export async function CameraFrame(handed) {
  const { width, height, near, far } = handed;
  const canvas = canvasOf(handed);
  const options = new pc.AppOptions();
  options.graphicsDevice = await pc.createGraphicsDevice(canvas, { deviceTypes: ["webgl2"], antialias: false });
  options.componentSystems = [pc.CameraComponentSystem, pc.RenderComponentSystem];
  const device = options.graphicsDevice;
  const app = new pc.AppBase(canvas);
  app.init(options);
  app.autoRender = false;
  app.start();
  app.setCanvasResolution(pc.RESOLUTION_FIXED, width, height);

  const texture = (name, format, filter, data) =>
    new pc.Texture(device, {
      name, width, height, format, mipmaps: false, minFilter: filter, magFilter: filter,
      addressU: pc.ADDRESS_CLAMP_TO_EDGE, addressV: pc.ADDRESS_CLAMP_TO_EDGE, levels: data ? [data] : undefined,
    }); // prettier-ignore
  // its first pass leaves depth in metres, upright, as this is
  const depth = texture("metres", pc.PIXELFORMAT_R32F, pc.FILTER_NEAREST, upsideDown(handed.depth, handed));
  depth.destroy = () => {}; // which the frame does to what it takes for its own, whenever its passes change
  const material = new pc.ShaderMaterial({
    uniqueName: "feed",
    attributes: { position: pc.SEMANTIC_POSITION },
    vertexGLSL: `attribute vec3 position;${VERTEX}`,
    fragmentGLSL: `${FEED}void main() { gl_FragColor = peerLight(); gl_FragDepth = 0.5; }`,
  });
  material.setParameter("peerColor", texture("light", pc.PIXELFORMAT_RGBA16F, pc.FILTER_NEAREST, handed.color));
  material.cull = pc.CULLFACE_NONE;
  material.update();
  const geometry = new pc.PlaneGeometry({ halfExtents: new pc.Vec2(1, 1) });
  geometry.positions = [-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0];
  geometry.indices = [0, 1, 2, 0, 2, 3];
  const quad = new pc.Entity();
  const instance = new pc.MeshInstance(pc.Mesh.fromGeometry(device, geometry), material);
  instance.cull = false;
  quad.addComponent("render", { meshInstances: [instance] });
  app.root.addChild(quad);

  const colorBuffer = texture("result", pc.PIXELFORMAT_RGBA32F, pc.FILTER_NEAREST);
  const eye = new pc.Entity();
  const renderTarget = new pc.RenderTarget({ colorBuffer, depth: true });
  eye.addComponent("camera", { fov: degrees(handed), nearClip: near, farClip: far, renderTarget });
  app.root.addChild(eye);
  const frame = new pc.CameraFrame(app, eye.camera);
  frame.rendering.renderFormats = [pc.PIXELFORMAT_RGBA16F];
  frame.rendering.sceneDepthMap = true; // by a pass of its own, which the quad has nothing for
  frame.rendering.toneMapping = pc.TONEMAP_NONE;
  frame.dof.enabled = true;
  return {
    gl: device.gl,
    enable: (on) => (frame.dof.enabled = on), // set() rebuilds the passes
    set: (parameters) => {
      Object.assign(frame.dof, parameters);
      frame.update();
      frame.renderPassCamera.prePass.linearDepthTexture = depth;
    },
    draw: () => {
      app.renderNextFrame = true;
      app.tick(); // now, instead of in the browser's next frame
    },
    // it writes for a display: the power is undone
    read: async () => (await colorBuffer.read(0, 0, width, height, { renderTarget, immediate: true })).map((x) => x ** 2.2),
  };
}
