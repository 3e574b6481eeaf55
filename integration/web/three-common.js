// SPDX-License-Identifier: MIT
//
// The methods for options, lens and focus that PolygonBokehPass and PolygonBokehNode share. Each of them passes in the
// classes of the three.js build that it imports.

import { CHOICES, checked, diameter, pulled } from './common.js';

// FloatType of three.js. Only the target `metres` has it, as R32F; all others are RGBA16F.
const FLOAT = 1015;

// If the pointer moves by more pixels between press and release, it drags instead of clicking
const CLICK = 5;

// Returns whether an object and all its parents are visible: rays of three.js also hit hidden objects.
const isVisible = (object) => !object || (object.visible && isVisible(object.parent));
// Returns whether the object that a ray has hit is visible, and the material that it has there.
const isSeen = ({ object, face }) => isVisible(object) && [object.material].flat()[face?.materialIndex ?? 0]?.visible !== false;

// Draws the objects of a layer into the current render target, over what is there. Also puts the lights on the layer.
export function drawLayer(renderer, scene, camera, layer) {
  const { background } = scene;
  const { mask } = camera.layers;
  scene.traverse((object) => object.isLight && object.layers.enable(layer));
  scene.background = null;
  camera.layers.set(layer);
  renderer.render(scene, camera);
  camera.layers.mask = mask;
  Object.assign(scene, { background });
}

// The options of three.js. PolygonBokehPass and PolygonBokehNode each add one more.
//   alpha  true: alpha is blurred too, for a transparent canvas, and colour must be premultiplied; takes twice as long
export const THREE_CHOICES = { ...CHOICES, alpha: [false, true] };

// `name` and `choices` are those of the class, for checked().
export const withLens = (Base, { name, choices }, { Raycaster, Vector2, Vector3 }) =>
  class extends Base {
    checked = (options) => checked(name, options, choices);

    // Changes some of the constructor's options. The promise resolves when the new shaders are compiled: the next frame
    // is drawn with the new options. Until then, frames look as before. It rejects if an option is invalid.
    async change(options) {
      const made = this.made(this.checked({ ...this.options, ...options }));
      this.resize(made.passes);
      this.changing = made;
      if (this.renderer) await this.compile(made);
      // the new passes replace the old ones, unless another change has begun in the meantime: then drop the new ones
      this.discard(this.changing === made ? this : made);
      if (this.changing === made) Object.assign(this, made);
    }

    // common.d.ts describes this method, and pullFocus().
    setLens(fStop = 2.8, bokehScale = 10) {
      const { apertureDiameter, focalLength, sensorHeight } = this.uniforms;
      const { camera } = this;
      if (camera.isPerspectiveCamera) {
        focalLength.value = sensorHeight.value / (2 * Math.tan((Math.PI / 360) * camera.getEffectiveFOV()));
      }
      apertureDiameter.value = diameter(focalLength.value, fStop, bokehScale);
    }

    // Returns the depth along the view axis, as the renderer draws it, of a point of the scene or of an object, which
    // may have any parents.
    depthOf(place) {
      const point = place.isObject3D ? place.getWorldPosition(new Vector3()) : new Vector3().copy(place);
      this.camera.updateWorldMatrix(true, false);
      return -point.applyMatrix4(this.camera.matrixWorldInverse).z;
    }

    // Focuses on a point of the scene, or on an object.
    focusOn(place) {
      this.uniforms.focusDistance.value = this.depthOf(place);
    }

    pullFocus(dt, depths, tau = 0.2) {
      const { focusDistance } = this.uniforms;
      focusDistance.value = pulled(focusDistance.value, dt, depths, tau);
    }

    // Returns the depths of the visible objects under points of the view, and Infinity where there is none. The points
    // go from (-1, -1) at the lower left to (1, 1) at the upper right.
    depthsUnder(points, scene) {
      const caster = new Raycaster();
      return points.map(([x, y]) => {
        caster.setFromCamera(new Vector2(x, y), this.camera);
        const hit = caster.intersectObjects(scene.children).find(isSeen);
        return hit ? this.depthOf(hit.point) : Infinity;
      });
    }

    // Focuses on what the user clicks on, until stopped: on the nearest of the clicked point and four points around it.
    // The focus reaches it after five time constants (tau, in seconds). A drag, for example of camera controls, has no
    // effect. draw() is called after each step; leave it out if you have a render loop. Returns { pulling: whether the
    // focus is moving, dispose() }.
    focusByClicks(canvas, scene, draw = () => {}, tau = 0.2) {
      let [depths, last, end, pressed] = [[], 0, 0, null];
      const step = () => {
        const now = performance.now();
        state.pulling = now < end;
        this.pullFocus(state.pulling ? (now - last) / 1000 : Infinity, depths, tau);
        draw();
        last = now;
        if (state.pulling) requestAnimationFrame(step);
      };
      const press = ({ clientX, clientY }) => {
        pressed = [clientX, clientY];
      };
      const clicked = ({ offsetX, offsetY, clientX, clientY }) => {
        if (pressed && Math.hypot(clientX - pressed[0], clientY - pressed[1]) > CLICK) return;
        const [x, y, d] = [(2 * offsetX) / canvas.clientWidth - 1, 1 - (2 * offsetY) / canvas.clientHeight, 0.02];
        depths = this.depthsUnder([[x, y], [x - d, y], [x + d, y], [x, y - d], [x, y + d]], scene);
        end = performance.now() + 5000 * tau;
        if (state.pulling) return;
        last = performance.now();
        step();
      };
      const listeners = { pointerdown: press, click: clicked };
      const dispose = () => Object.entries(listeners).forEach((pair) => canvas.removeEventListener(...pair));
      const state = { pulling: false, dispose };
      Object.entries(listeners).forEach((pair) => canvas.addEventListener(...pair));
      return state;
    }

    // Size of the effect's own render targets in bytes
    get memory() {
      const targets = new Set([...this.passes.map(({ target }) => target), this.sharp].filter(Boolean));
      const bytes = ({ width, height, textures }) => textures.length * width * height * (textures[0].type === FLOAT ? 4 : 8);
      return [...targets].reduce((sum, target) => sum + bytes(target), 0);
    }

    // Changes the preset, or, below, the number of sides. Resolves as change() does.
    setPreset(preset) {
      return this.change({ preset });
    }

    setSides(sides) {
      return this.change({ sides });
    }

    setCamera(camera) {
      this.camera = camera;
    }
  };
