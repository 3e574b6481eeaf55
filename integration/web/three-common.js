// SPDX-License-Identifier: MIT
//
// What PolygonBokehPass and PolygonBokehNode share: the lens and the focus. Each hands in the classes of its own three.

import { CHOICES, diameter, pulled } from './common.js';

// FloatType, of metres alone; all others are RGBA16F
const FLOAT = 1015;

// Pixels that the pointer may move between press and release, for it to be a click and no drag
const CLICK = 5;

// What a camera sees: three.js casts rays at hidden objects as well
const isSeen = (object) => !object || (object.visible && isSeen(object.parent));

// alpha         true: colour has a share of the page in alpha, premultiplied, and is blurred with it. Twice the cost.
// depthTexture  of the scene, where it is not that of the composer's target: for PolygonBokehPass alone
export const THREE_CHOICES = { ...CHOICES, alpha: [false, true] };

export const withLens = (Base, { Raycaster, Vector2, Vector3 }) =>
  class extends Base {
    // The lens of the camera's own field of view, at an f-stop; call it again where the camera zooms. bokehScale is how
    // many times wider the blur is than that lens's: 1 is the real lens, which hardly blurs at a game's field of view
    // (docs/lens.md), 0 is none. An orthographic camera has no field of view: focalLength stays.
    setLens(fStop = 2.8, bokehScale = 10) {
      const { apertureDiameter, focalLength, sensorHeight } = this.uniforms;
      const { camera } = this;
      if (camera.isPerspectiveCamera) {
        focalLength.value = sensorHeight.value / (2 * Math.tan((Math.PI / 360) * camera.getEffectiveFOV()));
      }
      apertureDiameter.value = diameter(focalLength.value, fStop, bokehScale);
    }

    // Depth along the view axis, as the renderer counts it, of a place in the world, or of an object, wherever it hangs.
    depthOf(place) {
      const point = place.isObject3D ? place.getWorldPosition(new Vector3()) : new Vector3().copy(place);
      this.camera.updateWorldMatrix(true, false);
      return -point.applyMatrix4(this.camera.matrixWorldInverse).z;
    }

    // Focus on a place in the world, or on an object.
    focusOn(place) {
      this.uniforms.focusDistance.value = this.depthOf(place);
    }

    // Autofocus, once a frame of dt seconds: towards the nearest of these depths, tau is its time constant in seconds.
    pullFocus(dt, depths, tau = 0.2) {
      const { focusDistance } = this.uniforms;
      focusDistance.value = pulled(focusDistance.value, dt, depths, tau);
    }

    // Depths under points of the view, (-1, -1) lower left; Infinity where nothing is
    depthsUnder(points, scene) {
      const caster = new Raycaster();
      return points.map(([x, y]) => {
        caster.setFromCamera(new Vector2(x, y), this.camera);
        const hit = caster.intersectObjects(scene.children).find(({ object }) => isSeen(object));
        return hit ? this.depthOf(hit.point) : Infinity;
      });
    }

    // A click focuses on what is there, on the nearest of some points around it, within five time constants; a drag, as
    // of a camera's controls, does not. draw() is called after each step, for whoever draws no frames otherwise.
    // { pulling: whether that is going on, dispose() }
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

    // Bytes of its targets
    get memory() {
      const targets = new Set([...this.passes.map(({ target }) => target), this.sharp].filter(Boolean));
      const bytes = ({ width, height, textures }) => textures.length * width * height * (textures[0].type === FLOAT ? 4 : 8);
      return [...targets].reduce((sum, target) => sum + bytes(target), 0);
    }

    // Another preset, number of sides or camera. It resolves when it is drawn: shaders are compiled beside the frames.
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
