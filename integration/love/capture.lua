-- For validation/run engines, not for your game: writes what the shaders read and wrote into a folder.
--
-- color.f16, depth.f32, a .f16 file for each shot, and the canvases of the shots with layered (.written) are raw rows,
-- beginning with v = 0. capture.json describes them, and contains the distances of the autofocus.

local ffi = require("ffi")
local PolygonBokeh = require("polygon_bokeh")
local Scene = require("scene")

-- A size that 2, 4 and 8 do not divide, because layered has canvases of 1 / 2, 1 / 4 and 1 / 8 of the size
local WIDTH, HEIGHT = 285, 189
local SHOTS = { { "layered", "hexagon", 6 }, { "layered", "octagon", 8 }, { "exact", "hexagon", 6 },
  { "exact", "octagon", 8 }, { "exact", "square", 4, "LOW" }, { "exact", "decagon", 10, "ULTRA" },
  { "exact", "square", 4, "MEDIUM", 10 }, -- rotated by 10 degrees, clockwise
  { "layered", "hexagon", 6, "MEDIUM", nil, true } } -- with FOCUS
-- scales and limits of the blur in front of the focus distance, and behind it
local FOCUS = { nearScale = 0.5, farScale = 0.75, nearMaxCoC = 0.02, farMaxCoC = 0.03 }

-- Returns a value as JSON. Numbers are rounded to float32, as the shaders get them.
local function json(value)
  if type(value) == "number" then
    return ("%.17g"):format(tonumber(ffi.new("float", value)))
  elseif type(value) == "string" then
    return ("%q"):format(value)
  end
  local parts = {}
  for _, part in ipairs(value) do
    parts[#parts + 1] = json(part)
  end
  if #parts > 0 then
    return "[" .. table.concat(parts, ", ") .. "]"
  end
  for name, part in pairs(value) do
    parts[#parts + 1] = json(name) .. ": " .. json(part)
  end
  return "{" .. table.concat(parts, ", ") .. "}"
end

local function write(path, ...)
  local file = assert(io.open(path, "wb"))
  for _, part in ipairs({ ... }) do
    file:write(type(part) == "string" and part or part:newImageData():getString())
  end
  file:close()
end

local function canvases(bokeh)
  local found = {}
  for _, pass in ipairs(bokeh.passes) do
    for _, canvas in ipairs(pass.targets) do
      found[#found + 1] = canvas
    end
  end
  return unpack(found)
end

-- Moves the focus for 12 frames of 20 ms to the nearest of three points: the pawn in front of the white one, the white
-- one, and the sky. Returns its inputs and the focus distances.
local function pulled(bokeh)
  local found = { frame = 0.02, seconds = 0.2, points = {}, distances = {} }
  local depths = {}
  for i, point in ipairs({ { 0.25, 0.67 }, { 0.445, 0.7 }, { 0.1, 0.1 } }) do
    depths[i] = bokeh:depthAt(point[1] * WIDTH, point[2] * HEIGHT)
    found.points[i] = { point[1], point[2], depths[i] }
  end
  for i = 1, 12 do
    bokeh:pullFocus(found.frame, depths, found.seconds)
    found.distances[i] = bokeh.uniforms.focusDistance
  end
  return found
end

return function(folder, addBokeh)
  local scene = Scene.new(WIDTH, HEIGHT)
  scene:draw()
  local shots, bokeh = {}, nil
  for i, shot in ipairs(SHOTS) do
    local method, aperture, sides, preset, clockwise, focused = unpack(shot, 1, 6)
    local name = method .. "-" .. aperture .. (clockwise and "-rotated" or "") .. (focused and "-focused" or "")
    bokeh = addBokeh(scene, { method = method, sides = sides, preset = preset })
    bokeh.uniforms.rotation = math.rad(clockwise or 0)
    shots[i] = { name = name, method = method, aperture = aperture, result = name .. ".f16",
      preset = (preset or "MEDIUM"):lower(), clockwise = clockwise }
    if focused then
      for key, value in pairs(FOCUS) do
        bokeh.uniforms[key] = value
      end
      shots[i].focus = { scale = { FOCUS.nearScale, FOCUS.farScale }, limits = { FOCUS.nearMaxCoC, FOCUS.farMaxCoC } }
    end
    write(folder .. "/" .. name .. ".f16", bokeh:draw(scene.color, scene.depth))
    if method == "layered" then
      shots[i].written = name .. ".written"
      write(folder .. "/" .. name .. ".written", canvases(bokeh))
    end
  end
  local off = addBokeh(scene, {})
  off:setLens(scene.fieldOfView, 2.8, 0)
  assert(off:draw(scene.color, scene.depth) == scene.color, "a bokeh scale of 0 draws passes")
  local depthAt = PolygonBokeh.depthAt
  PolygonBokeh.depthAt = error -- a drag must not read a depth
  love.mousepressed(100, 100)
  love.mousereleased(106, 100)
  PolygonBokeh.depthAt = depthAt
  write(folder .. "/color.f16", scene.color)
  local stored = bokeh:newPass({ { "metres" }, 1, "vec4(BokehFetchDepth(depth, uv).x)" })
  bokeh:drawPasses({ stored })
  write(folder .. "/depth.f32", stored.targets[1])
  local uniforms = bokeh.uniforms
  local capture = {
    engine = ("LOVE %d.%d"):format(love.getVersion()),
    device = select(4, love.graphics.getRendererInfo()),
    width = WIDTH,
    height = HEIGHT,
    color = "color.f16",
    depth = "depth.f32",
    stored = { kind = 1, near = scene.near, far = scene.far },
    camera = {
      aperture_diameter = uniforms.apertureDiameter,
      focal_length = uniforms.focalLength,
      focus_distance = uniforms.focusDistance,
      sensor_height = uniforms.sensorHeight,
      max_coc = uniforms.maxCoC,
    },
    shots = shots,
    pull = pulled(bokeh),
  }
  write(folder .. "/capture.json", json(capture))
end
