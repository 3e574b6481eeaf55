// What Python calls: window.bokeh.<api>.<function>(argument). Each returns plain data, or throws an Error with a text
// that says what was refused.

import * as webgl2 from "./webgl2.js";
import * as webgpu from "./webgpu.js";

window.bokeh = { webgl2, webgpu };
