// The sample as a frame graph, which draws colour and depth of the scene at once.

import { Constants } from '@babylonjs/core/Engines/constants.js';
import { FrameGraph } from '@babylonjs/core/FrameGraph/frameGraph.js';
import { FrameGraphImageProcessingTask } from '@babylonjs/core/FrameGraph/Tasks/PostProcesses/imageProcessingTask.js';
import { FrameGraphGeometryRendererTask } from '@babylonjs/core/FrameGraph/Tasks/Rendering/geometryRendererTask.js';
import { FrameGraphClearTextureTask } from '@babylonjs/core/FrameGraph/Tasks/Texture/clearTextureTask.js';
import { FrameGraphCopyToBackbufferColorTask } from '@babylonjs/core/FrameGraph/Tasks/Texture/copyToBackbufferColorTask.js';
import { ImageProcessingConfiguration } from '@babylonjs/core/Materials/imageProcessingConfiguration.js';
import '@babylonjs/core/Engines/Extensions/engine.multiRender.js';
import '@babylonjs/core/Engines/WebGPU/Extensions/engine.multiRender.js';
import { PolygonBokehTask } from 'polygonal-bokeh/babylon';

// Creates a texture with the size of the canvas.
function texture(graph, name, type, format) {
  const options = { createMipMaps: false, types: [type], formats: [format], samples: 1, useSRGBBuffers: [false], labels: [name] };
  const size = { width: 100, height: 100 };
  return graph.textureManager.createRenderTargetTexture(name, { size, sizeIsPercentage: true, options });
}

// Creates a frame graph with depth of field for a scene and its camera. `options` are passed to PolygonBokehTask.
// Returns { graph, bokeh }.
export async function addGraph(scene, camera, options) {
  const graph = new FrameGraph(scene);

  const clear = new FrameGraphClearTextureTask('clear', graph);
  clear.targetTexture = texture(graph, 'color', Constants.TEXTURETYPE_HALF_FLOAT, Constants.TEXTUREFORMAT_RGBA);
  clear.depthTexture = texture(graph, 'depth', Constants.TEXTURETYPE_FLOAT, Constants.TEXTUREFORMAT_DEPTH32_FLOAT);
  clear.clearDepth = true;
  clear.color = scene.clearColor;

  const objects = new FrameGraphGeometryRendererTask('objects', graph, scene);
  objects.targetTexture = clear.outputTexture;
  objects.depthTexture = clear.outputDepthTexture;
  objects.camera = camera;
  objects.objectList = { meshes: scene.meshes, particleSystems: scene.particleSystems };
  objects.disableImageProcessing = true; // colours stay linear and without an upper limit
  const { PREPASS_SCREENSPACE_DEPTH_TEXTURE_TYPE: type, TEXTURETYPE_FLOAT: textureType, TEXTUREFORMAT_R: textureFormat } = Constants;
  objects.textureDescriptions = [{ type, textureType, textureFormat }];

  const bokeh = new PolygonBokehTask('bokeh', graph, camera, options);
  bokeh.sourceTexture = objects.outputTexture;
  bokeh.depthTexture = objects.geometryScreenDepthTexture;
  bokeh.setLens(1.4, 20); // f/1.4, with a blur 20 times as wide as a real lens's

  const tone = new FrameGraphImageProcessingTask('tone', graph);
  tone.sourceTexture = bokeh.outputTexture;
  scene.imageProcessingConfiguration.toneMappingEnabled = true;
  scene.imageProcessingConfiguration.toneMappingType = ImageProcessingConfiguration.TONEMAPPING_ACES;

  const copy = new FrameGraphCopyToBackbufferColorTask('copy', graph);
  copy.sourceTexture = tone.outputTexture;

  for (const task of [clear, objects, bokeh, tone, copy]) graph.addTask(task);
  scene.cameraToUseForPointers = camera;
  scene.frameGraph = graph;
  await graph.buildAsync();
  return { graph, bokeh };
}
