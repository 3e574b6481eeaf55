-- For validation/run engines, not for your game: what the shaders read and wrote, into the folder given.
--
-- color.f16, depth.f32, a .f16 for each shot and the canvases of the layered ones (.written) are raw rows, v = 0 first;
-- capture.json says what they are, and what the focus did.

local ffi = require("ffi")
local Scene = require("scene")

-- a size that 2, 4 and 8 do not divide
local WIDTH, HEIGHT = 285, 189
local SHOTS = { { "layered", "hexagon", 6 }, { "layered", "octagon", 8 }, { "exact", "hexagon", 6 },
  { "exact", "octagon", 8 }, { "exact", "square", 4, "LOW" }, { "exact", "decagon", 10, "ULTRA" },
  { "exact", "square", 4, "MEDIUM", 10 } } -- the last one rotated, degrees clockwise

-- Text of a value as JSON; numbers are rounded to what a shader gets
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

-- The focus of 12 frames of 20 ms, on its way to the nearest of the pawn before the white one, that, and the sky
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
    local method, aperture, sides, preset, clockwise = unpack(shot)
    local name = method .. "-" .. aperture .. (clockwise and "-rotated" or "")
    bokeh = addBokeh(scene, { method = method, sides = sides, preset = preset })
    bokeh.uniforms.rotation = math.rad(clockwise or 0)
    shots[i] = { name = name, method = method, aperture = aperture, result = name .. ".f16",
      preset = (preset or "MEDIUM"):lower(), clockwise = clockwise }
    write(folder .. "/" .. name .. ".f16", bokeh:draw(scene.color, scene.depth))
    if method == "layered" then
      shots[i].written = name .. ".written"
      write(folder .. "/" .. name .. ".written", canvases(bokeh))
    end
  end
  local off = addBokeh(scene, {})
  off:setLens(scene.fieldOfView, 2.8, 0)
  assert(off:draw(scene.color, scene.depth) == scene.color, "a bokeh scale of 0 draws passes")
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
