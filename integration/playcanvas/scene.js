// The scene of the sample: lamps in front of and behind the focus, a checkered floor, and a ring in focus.

import { Color, Entity, FILTER_NEAREST, StandardMaterial, Texture } from 'playcanvas';

const COLORS = ['#ff7a30', '#ffe0a0', '#60a0ff', '#ff3050', '#70ffb0'];

const color = (text, brightness = 1) => new Color().fromString(text).mulScalar(brightness);

// Adds a primitive of PlayCanvas, which is one metre large until `scale` changes it.
function add(app, type, material, [x, y, z], scale) {
  const entity = new Entity(type);
  entity.addComponent('render', { type, material });
  entity.setLocalPosition(x, y, z);
  entity.setLocalScale(...scale);
  app.root.addChild(entity);
  return entity;
}

function painted(text) {
  const material = new StandardMaterial();
  material.diffuse = color(text);
  material.update();
  return material;
}

// Adds a lamp: an unlit sphere, `light` times as bright as its colour.
function lamp(app, text, light, radius, x, y, z) {
  const material = new StandardMaterial();
  material.useLighting = false;
  material.emissive = color(text);
  material.emissiveIntensity = light;
  material.update();
  add(app, 'sphere', material, [x, y, z], [2 * radius, 2 * radius, 2 * radius]);
}

function checkered(app) {
  const [dark, light] = [[40, 44, 52, 255], [150, 140, 130, 255]];
  const filters = { mipmaps: false, minFilter: FILTER_NEAREST, magFilter: FILTER_NEAREST };
  const texels = new Uint8Array([...dark, ...light, ...light, ...dark]);
  const texture = new Texture(app.graphicsDevice, { width: 2, height: 2, ...filters, levels: [texels] });
  const material = painted('#ffffff');
  material.diffuseMap = texture;
  material.diffuseMapTiling.set(30, 30);
  material.update();
  return material;
}

// Creates the scene. Returns { camera, subject, box }; the sample focuses on the subject.
export function makeScene(app) {
  app.scene.ambientLight = color('#607090');
  const sun = new Entity('sun');
  sun.addComponent('light', { type: 'directional', color: color('#ffe8d0'), intensity: 0.8 });
  sun.setLocalEulerAngles(50, -25, 0);
  app.root.addChild(sun);

  add(app, 'plane', checkered(app), [0, 0, 0], [60, 1, 60]);
  add(app, 'box', painted('#101828'), [0, 10, -16.5], [60, 20, 1]);
  const box = add(app, 'box', painted('#50809a'), [1.3, 0.45, -6.5], [0.9, 0.9, 0.9]);
  box.setLocalEulerAngles(0, 34, 0);
  const subject = add(app, 'torus', painted('#d8b060'), [-0.45, 0.8, -5], [1.3, 1.3, 1.3]);
  subject.setLocalEulerAngles(70, 0, 20);

  lamp(app, '#ffa050', 12, 0.03, 0.75, 1.85, -2.4);
  lamp(app, '#70a0ff', 12, 0.03, -0.8, 1.25, -2.4);
  for (let i = 0; i < 24; i++) {
    const angle = 2.39996 * i; // the golden angle spreads the lamps evenly, without random numbers
    const reach = Math.sqrt((i + 1) / 24);
    const x = 6.5 * reach * Math.cos(angle);
    const y = 3.8 + 2.4 * reach * Math.sin(angle);
    lamp(app, COLORS[i % 5], 12 + 9 * (i % 3), 0.07, x, y, (i % 4) - 15.8);
  }

  const eye = new Entity('camera');
  eye.addComponent('camera', { clearColor: color('#05070c'), fov: 45, nearClip: 0.1, farClip: 100 });
  eye.setLocalPosition(0, 1.4, 0);
  eye.lookAt(0, 1.25, -5);
  app.root.addChild(eye);
  return { camera: eye.camera, subject, box };
}
