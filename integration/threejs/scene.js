// The scene of the samples: lamps in front of and behind the focus, a checkered floor, and a knot in focus.

import {
  BoxGeometry,
  Color,
  DataTexture,
  DirectionalLight,
  HemisphereLight,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  NearestFilter,
  PerspectiveCamera,
  PlaneGeometry,
  RepeatWrapping,
  Scene,
  SphereGeometry,
  TorusKnotGeometry,
} from 'three';

const COLORS = [0xff7a30, 0xffe0a0, 0x60a0ff, 0xff3050, 0x70ffb0];

// Adds a lamp: an unlit sphere, `light` times as bright as its colour.
function lamp(scene, color, light, radius, x, y, z) {
  const material = new MeshBasicMaterial({ color: new Color(color).multiplyScalar(light) });
  const mesh = new Mesh(new SphereGeometry(radius, 24, 16), material);
  mesh.position.set(x, y, z);
  scene.add(mesh);
}

function checkered() {
  const dark = [40, 44, 52, 255];
  const light = [150, 140, 130, 255];
  const texture = new DataTexture(new Uint8Array([...dark, ...light, ...light, ...dark]), 2, 2);
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.repeat.set(30, 30);
  texture.needsUpdate = true;
  return texture;
}

// Creates the scene. Returns { scene, camera, subject }; the samples focus on the subject.
export function makeScene(aspect) {
  const scene = new Scene();
  scene.background = new Color(0x05070c);
  scene.add(new HemisphereLight(0x8090c0, 0x302018, 1.2));
  const sun = new DirectionalLight(0xffe8d0, 2);
  sun.position.set(-2, 4, 3);
  scene.add(sun);

  const floor = new Mesh(new PlaneGeometry(60, 60), new MeshLambertMaterial({ map: checkered() }));
  floor.rotation.x = -Math.PI / 2;
  const wall = new Mesh(new PlaneGeometry(60, 20), new MeshLambertMaterial({ color: 0x101828 }));
  wall.position.z = -16;
  const subject = new Mesh(new TorusKnotGeometry(0.42, 0.15, 128, 24), new MeshLambertMaterial({ color: 0xd8b060 }));
  subject.position.set(-0.45, 0.95, -5);
  const box = new Mesh(new BoxGeometry(0.9, 0.9, 0.9), new MeshLambertMaterial({ color: 0x50809a }));
  box.position.set(1.3, 0.45, -6.5);
  box.rotation.y = 0.6;
  scene.add(floor, wall, subject, box);

  lamp(scene, 0xffa050, 12, 0.03, 0.75, 1.85, -2.4);
  lamp(scene, 0x70a0ff, 12, 0.03, -0.8, 1.25, -2.4);
  for (let i = 0; i < 24; i++) {
    const angle = 2.39996 * i; // the golden angle spreads the lamps evenly, without random numbers
    const reach = Math.sqrt((i + 1) / 24);
    const depth = 15.8 - (i % 4);
    const x = 6.5 * reach * Math.cos(angle);
    const y = 3.8 + 2.4 * reach * Math.sin(angle);
    lamp(scene, COLORS[i % 5], 12 + 9 * (i % 3), 0.07, x, y, -depth);
  }

  const camera = new PerspectiveCamera(45, aspect, 0.1, 100);
  camera.position.set(0, 1.4, 0);
  camera.lookAt(0, 1.25, -5);
  return { scene, camera, subject };
}
