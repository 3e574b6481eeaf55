// The scene of the samples: lamps in front of and behind the focus, a checkered floor, and a knot in focus.

import { FreeCamera } from '@babylonjs/core/Cameras/freeCamera.js';
import { Constants } from '@babylonjs/core/Engines/constants.js';
import { DirectionalLight } from '@babylonjs/core/Lights/directionalLight.js';
import { HemisphericLight } from '@babylonjs/core/Lights/hemisphericLight.js';
import { PBRMaterial } from '@babylonjs/core/Materials/PBR/pbrMaterial.js';
import { RawTexture } from '@babylonjs/core/Materials/Textures/rawTexture.js';
import { Color3, Color4 } from '@babylonjs/core/Maths/math.color.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { CreateBox } from '@babylonjs/core/Meshes/Builders/boxBuilder.js';
import { CreateGround } from '@babylonjs/core/Meshes/Builders/groundBuilder.js';
import { CreatePlane } from '@babylonjs/core/Meshes/Builders/planeBuilder.js';
import { CreateSphere } from '@babylonjs/core/Meshes/Builders/sphereBuilder.js';
import { CreateTorusKnot } from '@babylonjs/core/Meshes/Builders/torusKnotBuilder.js';
import { Scene } from '@babylonjs/core/scene.js';
import '@babylonjs/core/Culling/ray.js'; // for scene.pick

const COLORS = ['#ff7a30', '#ffe0a0', '#60a0ff', '#ff3050', '#70ffb0'];

const linear = (color) => Color3.FromHexString(color).toLinearSpace();

function place(mesh, x, y, z, color) {
  mesh.position.set(x, y, z);
  const material = new PBRMaterial('', mesh.getScene());
  Object.assign(material, { albedoColor: linear(color), metallic: 0, roughness: 1, environmentBRDFTexture: null });
  mesh.material = material;
  return mesh;
}

// Adds a lamp: an unlit sphere, `light` times as bright as its colour.
function lamp(scene, color, light, diameter, x, y, z) {
  const { material } = place(CreateSphere('lamp', { diameter }, scene), x, y, z, color);
  material.unlit = true;
  material.albedoColor.scaleInPlace(light);
}

function checkered(scene) {
  const dark = [40, 44, 52, 255];
  const light = [150, 140, 130, 255];
  const texels = new Uint8Array([...dark, ...light, ...light, ...dark]);
  const nearest = Constants.TEXTURE_NEAREST_SAMPLINGMODE;
  const texture = RawTexture.CreateRGBATexture(texels, 2, 2, scene, false, false, nearest);
  texture.wrapU = texture.wrapV = Constants.TEXTURE_WRAP_ADDRESSMODE;
  texture.uScale = texture.vScale = 30;
  return texture;
}

// Creates the scene. Returns { scene, camera, subject, box }; the samples focus on the subject.
export function makeScene(engine) {
  const scene = new Scene(engine);
  scene.clearColor = new Color4(0.0015, 0.0021, 0.0037, 1);
  const sky = new HemisphericLight('sky', Vector3.Up(), scene);
  Object.assign(sky, { diffuse: linear('#8090c0'), groundColor: linear('#302018'), intensity: 2 });
  const sun = new DirectionalLight('sun', new Vector3(2, -4, 3), scene);
  Object.assign(sun, { diffuse: linear('#ffe8d0'), intensity: 3 });

  const floor = place(CreateGround('floor', { width: 60, height: 60 }, scene), 0, 0, 0, '#ffffff');
  floor.material.albedoTexture = checkered(scene);
  place(CreatePlane('wall', { width: 60, height: 20 }, scene), 0, 0, 16, '#101828');
  const options = { radius: 0.42, tube: 0.15, radialSegments: 128, tubularSegments: 24 };
  const subject = place(CreateTorusKnot('knot', options, scene), -0.45, 0.95, 5, '#d8b060');
  const box = place(CreateBox('box', { size: 0.9 }, scene), 1.3, 0.45, 6.5, '#50809a');
  box.rotation.y = -0.6;

  lamp(scene, '#ffa050', 12, 0.06, 0.75, 1.85, 2.4);
  lamp(scene, '#70a0ff', 12, 0.06, -0.8, 1.25, 2.4);
  for (let i = 0; i < 24; i++) {
    const angle = 2.39996 * i; // the golden angle spreads the lamps evenly, without random numbers
    const reach = Math.sqrt((i + 1) / 24);
    const x = 6.5 * reach * Math.cos(angle);
    const y = 3.8 + 2.4 * reach * Math.sin(angle);
    lamp(scene, COLORS[i % 5], 12 + 9 * (i % 3), 0.14, x, y, 15.8 - (i % 4));
  }

  const camera = new FreeCamera('camera', new Vector3(0, 1.4, 0), scene);
  camera.setTarget(new Vector3(0, 1.25, 5));
  Object.assign(camera, { fov: Math.PI / 4, minZ: 0.1, maxZ: 100 });
  return { scene, camera, subject, box };
}
