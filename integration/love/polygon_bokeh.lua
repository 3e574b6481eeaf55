-- SPDX-License-Identifier: MIT
--
-- Polygonal bokeh for LOVE 11: full-screen passes between canvases. bokeh.glsl and bokeh_layers.glsl are the rest.

local PolygonBokeh = {}
PolygonBokeh.__index = PolygonBokeh

-- A frame is a table of passes. A row has the canvases that it writes, 1 / their size, and the call, which names the
-- canvases that it reads: docs/passes.md. `color` and `depth` are the scene's. Where a row writes several canvases, the
-- function returns them as T2, T3, T4, T5.
local INPUTS = {
  { { "metres" }, 1, "vec4(BokehLinearDepth(BokehFetchNearest(depth, uv).r, 1, zNear, zFar))" },
  {
    { "coc" },
    1,
    "BokehSignedCoCMap(color, metres, uv, apertureDiameter, focalLength, focusDistance, sensorHeight, maxCoC)",
  },
}

-- Two passes blur with a polygon; between them are half as many canvases as it has sides, less one.
local function between(stem, sides)
  local names = {}
  for k = 2, sides / 2 do
    names[#names + 1] = stem .. k
  end
  return names
end

-- The function of the second takes four: it gets the last one for the rest, and does not read it.
local function four(names)
  local last = names[#names]
  return table.concat({ names[1], names[2] or last, names[3] or last, names[4] or last }, ", ")
end

local FRAMES = {}

function FRAMES.layered(sides)
  local one = sides == 4 and ".T2" or ""
  local near, far = between("nearTarget", sides), between("farTarget", sides)
  return {
    { { "tiles" }, 8, "BokehLayerTiles(coc, uv, layers)" },
    { { "reachAlongRows" }, 8, "BokehLayerReach(tiles, uv, vec2(1.0, 0.0), layers)" },
    { { "reach" }, 8, "BokehLayerReach(reachAlongRows, uv, vec2(0.0, 1.0), layers)" },
    { { "near", "far", "sums", "leftovers" }, 2, "BokehLayerSplit(coc, reach, uv, layers)" },
    { { "tileLeftovers", "tileSums" }, 8, "BokehLayerKernels(sums, leftovers, uv, layers)" },
    {
      { "rowLeftovers", "rowSums" },
      8,
      "BokehLayerSpread(tileLeftovers, tileSums, reach, uv, vec2(1.0, 0.0), layers)",
    },
    { { "reaches", "sizes" }, 8, "BokehLayerSizes(rowLeftovers, rowSums, reach, uv, layers)" },
    { { "middleWithHoles", "farWithHoles", "shares" }, 4, "BokehLayerHoles(coc, reach, uv, layers)" },
    { { "middle", "back" }, 4, "BokehLayerFill(middleWithHoles, farWithHoles, shares, reach, uv, layers)" },
    { near, 2, "BokehLayerFirst(near, sizes, uv, false, layers)" .. one },
    { { "nearBlurred" }, 2, "BokehLayerSecond(" .. four(near) .. ", sizes, uv, false, layers)" },
    { far, 2, "BokehLayerFirst(far, sizes, uv, true, layers)" .. one },
    { { "farBlurred" }, 2, "BokehLayerSecond(" .. four(far) .. ", sizes, uv, true, layers)" },
    { { "result" }, 1, "BokehLayered(coc, reaches, nearBlurred, farBlurred, middle, back, uv, layers)" },
  }
end

function FRAMES.exact(sides)
  local targets = between("target", sides)
  return {
    { targets, 1, "BokehExactFirst(coc, uv, polygon, settings)" .. (sides == 4 and ".T2" or "") },
    { { "result" }, 1, "BokehExactSecond(" .. four(targets) .. ", uv, polygon, settings)" },
  }
end

-- In place of the result
local VIEWS = {
  depth = "BokehDebugDepth(BokehFetchNearest(metres, uv).r, focusDistance)",
  coc = "BokehDebugCoC(BokehFetchNearest(coc, uv).a, maxCoC)",
  focus = "BokehDebugFocus(BokehFetchNearest(metres, uv).r, focusDistance, BokehFetchNearest(coc, uv).a, maxCoC)",
}

-- One triangle over the whole canvas; v = 0 is the first row in memory, which LOVE draws on top
local TRIANGLE = { { -1, -1, 0, 0 }, { 3, -1, 2, 0 }, { -1, 3, 0, 2 } }
local VERTEX = [[
#pragma language glsl3
vec4 position(mat4 transform, vec4 vertex)
{
    return vertex;
}
]]
-- `number` is a macro of LOVE's, and the name of a variable in bokeh.glsl.
local PIXEL = [[
#pragma language glsl3
#undef number
#define BOKEH_NUM_SAMPLES $samples
#define BOKEH_PRESET_$preset
$library
uniform sampler2D $reads;
uniform float $uniforms;
uniform vec2 imageSize;

void effect()
{
    vec2 uv = VaryingTexCoord.xy;
    BokehPolygon polygon = BokehMakePolygon($sides, rotation, squeeze);
    BokehLayers layers = BokehMakeLayers(imageSize, polygon, maxCoC);
    BokehFilter settings = BokehDefaultFilter(imageSize);
    settings.spacing = spacing;
    $write
}
]]

-- What stores the value of a call
local function store(call, count)
  if count == 1 then
    return "love_PixelColor = " .. call .. ";"
  end
  local lines = { "BokehTargets targets = " .. call .. ";" }
  for i = 0, count - 1 do
    lines[#lines + 1] = ("love_Canvases[%d] = targets.T%d;"):format(i, i + 2)
  end
  return table.concat(lines, " ")
end

-- Names of textures in a call, in its order
local function namesIn(call, textures)
  local found, seen = {}, {}
  for name in call:gmatch("%a%w*") do
    if textures[name] and not seen[name] then
      found[#found + 1], seen[name] = name, true
    end
  end
  return found
end

-- A canvas that says all that the passes rely on: love.graphics.setDefaultFilter and the screen change the defaults.
local function newCanvas(width, height, format)
  local canvas = love.graphics.newCanvas(width, height, { format = format, dpiscale = 1, msaa = 0 })
  canvas:setFilter("linear", "linear")
  canvas:setWrap("clamp", "clamp")
  return canvas
end

-- library  the texts of bokeh.glsl and bokeh_layers.glsl, in this order
-- options  what is left out is
--   method   "layered": near objects spread over what is behind them; "exact": each pixel by its own circle of
--            confusion, fewer passes
--   sides    6; or 4, 8, 10
--   preset   of layered: "MEDIUM"; or "LOW", "HIGH", "ULTRA"
--   samples  of exact: at most so many on an edge, 33
--   view     "depth", "coc" (circle of confusion) or "focus" (near and far field), to look at in place of the result
function PolygonBokeh.new(library, width, height, options)
  options = options or {}
  local sides, self = options.sides or 6, setmetatable({}, PolygonBokeh)
  -- To be set from outside. Metres, but for maxCoC (fraction of the image height), rotation (radians) and spacing
  -- (pixels between samples of exact).
  self.uniforms = {
    zNear = 0.1, zFar = 1000, apertureDiameter = 0.025, focalLength = 0.05, focusDistance = 5, sensorHeight = 0.024,
    maxCoC = 0.1, rotation = 0, squeeze = 1, spacing = 1,
  }
  self.imageSize = { width, height }
  self.triangle = love.graphics.newMesh(TRIANGLE, "triangles", "static")
  self.textures, self.passes = { color = true, depth = true }, {}
  local values = { samples = options.samples or 33, preset = options.preset or "MEDIUM", library = library, sides = sides }
  local uniforms = {}
  for name in pairs(self.uniforms) do
    uniforms[#uniforms + 1] = name
  end
  values.uniforms = table.concat(uniforms, ", ")
  local frame = { INPUTS[1], INPUTS[2] }
  local rest = options.view and { { { "result" }, 1, VIEWS[options.view] } } or FRAMES[options.method or "layered"](sides)
  for _, row in ipairs(rest) do
    frame[#frame + 1] = row
  end
  for _, row in ipairs(frame) do
    local writes, scale, call = unpack(row)
    local pass = { targets = {}, reads = namesIn(call, self.textures) }
    values.reads, values.write = table.concat(pass.reads, ", "), store(call, #writes)
    pass.shader = love.graphics.newShader(PIXEL:gsub("%$(%a+)", values), VERTEX)
    for i, name in ipairs(writes) do
      local format = name == "metres" and "r32f" or "rgba16f"
      pass.targets[i] = newCanvas(math.ceil(width / scale), math.ceil(height / scale), format)
      self.textures[name] = pass.targets[i]
    end
    self.passes[#self.passes + 1] = pass
  end
  return self
end

-- The lens of a camera's vertical field of view, radians, at an f-stop. Smaller stops than those of real lenses blur
-- more (docs/lens.md).
function PolygonBokeh:setLens(fieldOfView, fStop)
  local uniforms = self.uniforms
  uniforms.focalLength = uniforms.sensorHeight / (2 * math.tan(0.5 * fieldOfView))
  uniforms.apertureDiameter = uniforms.focalLength / fStop
end

-- Depth of a pixel of the last frame, metres. It waits for the GPU: do it on a click, not each frame.
function PolygonBokeh:depthAt(x, y)
  x = math.min(math.max(math.floor(x), 0), self.imageSize[1] - 1)
  y = math.min(math.max(math.floor(y), 0), self.imageSize[2] - 1)
  return (self.textures.metres:newImageData(1, 1, x, y, 1, 1):getPixel(0, 0))
end

-- Focus smoothly on the nearest of several depths: call it each frame. tau is the time constant, seconds.
function PolygonBokeh:pullFocus(dt, depths, tau)
  local nearest = 1 / math.min(unpack(depths))
  local pulled = 1 / self.uniforms.focusDistance
  pulled = pulled + (1 - math.exp(-dt / tau)) * (nearest - pulled)
  self.uniforms.focusDistance = 1 / pulled
end

-- The blurred picture, a canvas; alpha is the signed circle of confusion
function PolygonBokeh:draw(color, depth)
  self.textures.color, self.textures.depth = color, depth
  love.graphics.push("all")
  love.graphics.reset()
  -- alpha is data: no blending, and no multiplication by alpha either, which "replace" does by default
  love.graphics.setBlendMode("replace", "premultiplied")
  for _, pass in ipairs(self.passes) do
    love.graphics.setCanvas(pass.targets)
    love.graphics.setShader(pass.shader)
    for _, name in ipairs(pass.reads) do
      pass.shader:send(name, self.textures[name])
    end
    for name, value in pairs(self.uniforms) do
      self:send(pass.shader, name, value)
    end
    self:send(pass.shader, "imageSize", self.imageSize)
    love.graphics.draw(self.triangle)
  end
  love.graphics.pop()
  return self.textures.result
end

-- LOVE stops at names that a shader does not use.
function PolygonBokeh:send(shader, name, value)
  if shader:hasUniform(name) then
    shader:send(name, value)
  end
end

return PolygonBokeh
