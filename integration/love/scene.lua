-- The scene of the sample: pawns on a checkered ground, and lamps in front of and behind them. Lengths are in metres, y
-- points up, and the camera looks along -z.

local Scene = { near = 0.1, far = 60, fieldOfView = math.rad(27) } -- vertical: 50 mm on a sensor of 24 mm
Scene.__index = Scene

local EYE = { 0, 1.5, 0 }
local TILT = math.rad(-6) -- downwards
Scene.pawns = { { -0.62, 0, -3.4 }, { -0.2, 0, -5 }, { 0.45, 0, -6.8 }, { 1.2, 0, -9 }, { -1.5, 0, -8 } }
Scene.subject = { -0.2, 0.7, -5 } -- the collar of the second pawn

local VERTEX = [[
#pragma language glsl3
uniform mat4 view, projection;
uniform vec4 place; // and scale
in vec3 VertexNormal;
out vec3 world, normal;
vec4 position(mat4 transform, vec4 vertex)
{
    world = vertex.xyz * place.w + place.xyz;
    normal = VertexNormal;
    return projection * view * vec4(world, 1.0);
}
]]
-- LOVE limits the colours of vertices to 1, so the brightness is a uniform.
local PIXEL = [[
#pragma language glsl3
uniform vec3 radiance;
uniform float cell, glow;
in vec3 world, normal;
vec4 effect(vec4 color, Image image, vec2 uv, vec2 pixel)
{
    vec2 place = floor(world.xz / cell + 0.001);
    float checker = cell > 0.0 ? mod(place.x + place.y, 2.0) : 1.0;
    float light = 0.2 + 0.8 * max(dot(normalize(normal), normalize(vec3(-0.5, 0.7, 0.5))), 0.0);
    return vec4(radiance * mix(light * mix(0.15, 1.0, checker), 1.0, glow), 1.0);
}
]]

-- Returns the mesh of a surface of revolution. The points of its outline are { radius, height }, from top to bottom.
local function lathe(outline, steps)
  local vertices, indices = {}, {}
  for i, point in ipairs(outline) do
    local before, after = outline[math.max(i - 1, 1)], outline[math.min(i + 1, #outline)]
    local across, up = before[2] - after[2], after[1] - before[1]
    local length = math.sqrt(across * across + up * up)
    for step = 0, steps do
      local x, z = math.cos(2 * math.pi * step / steps), math.sin(2 * math.pi * step / steps)
      vertices[#vertices + 1] = {
        point[1] * x, point[2], point[1] * z,
        across / length * x, up / length, across / length * z,
      }
      if i > 1 and step > 0 then
        local a, b = #vertices, #vertices - steps - 1
        for _, index in ipairs({ b - 1, b, a, b - 1, a, a - 1 }) do
          indices[#indices + 1] = index
        end
      end
    end
  end
  local form = { { "VertexPosition", "float", 3 }, { "VertexNormal", "float", 3 } }
  local mesh = love.graphics.newMesh(form, vertices, "triangles", "static")
  mesh:setVertexMap(indices)
  return mesh
end

-- Adds an arc around { 0, height } to an outline, and returns the outline. The angles are in degrees, and 0 is the top.
local function arc(outline, radius, height, from, to)
  for angle = from, to, 9 do
    outline[#outline + 1] = { radius * math.sin(math.rad(angle)), height + radius * math.cos(math.rad(angle)) }
  end
  return outline
end

local function pawn()
  local outline = arc({}, 0.17, 0.85, 0, 144)
  for _, point in ipairs({
    { 0.12, 0.71 }, { 0.2, 0.68 }, { 0.2, 0.65 }, { 0.11, 0.62 }, { 0.1, 0.5 }, { 0.13, 0.32 }, { 0.2, 0.19 },
    { 0.22, 0.17 }, { 0.22, 0.13 }, { 0.28, 0.11 }, { 0.28, 0 },
  }) do
    outline[#outline + 1] = point
  end
  return outline
end

-- Creates the scene with its two canvases. `color` has linear HDR colour in RGBA16F. `depth` goes from 0 at the near
-- plane to 1 at the far plane, and shaders can read it.
function Scene.new(width, height)
  local self = setmetatable({}, Scene)
  self.color = love.graphics.newCanvas(width, height, { format = "rgba16f", dpiscale = 1 })
  self.depth = love.graphics.newCanvas(width, height, { format = "depth24", readable = true, dpiscale = 1 })
  self.shader = love.graphics.newShader(PIXEL, VERTEX)
  self.ball = lathe(arc({}, 1, 0, 0, 180), 32)
  self.ground = lathe({ { 0, 0 }, { 40, 0 } }, 32)
  self.pawn = lathe(pawn(), 48)
  self.aspect = width / height
  return self
end

function Scene:camera()
  local c, s, focal = math.cos(TILT), math.sin(TILT), 1 / math.tan(0.5 * self.fieldOfView)
  local x, y, z = unpack(EYE)
  local near, far = self.near, self.far
  local view = { { 1, 0, 0, -x }, { 0, c, s, -y * c - z * s }, { 0, -s, c, y * s - z * c }, { 0, 0, 0, 1 } }
  -- the second row is negative, because the first row in memory is at the top of LOVE's canvases, but at the bottom in
  -- OpenGL
  local projection = {
    { focal / self.aspect, 0, 0, 0 },
    { 0, -focal, 0, 0 },
    { 0, 0, (near + far) / (near - far), 2 * near * far / (near - far) },
    { 0, 0, -1, 0 },
  }
  return view, projection
end

-- Returns the depth of a point of the scene along the view axis, in metres.
function Scene:depthOf(place)
  return (EYE[2] - place[2]) * math.sin(-TILT) + (EYE[3] - place[3]) * math.cos(TILT)
end

function Scene:draw()
  local view, projection = self:camera()
  love.graphics.push("all")
  love.graphics.reset()
  love.graphics.setCanvas({ self.color, depthstencil = self.depth })
  love.graphics.clear(0.008, 0.012, 0.025, 1, true, 1)
  love.graphics.setDepthMode("less", true)
  love.graphics.setShader(self.shader)
  self.shader:send("view", view)
  self.shader:send("projection", projection)
  self:thing(self.ground, { 0, 0, -15 }, 1, { 0.5, 0.42, 0.34 }, 0.5, 0)
  for i, place in ipairs(self.pawns) do
    self:thing(self.pawn, place, 1, i % 2 == 0 and { 0.75, 0.66, 0.5 } or { 0.22, 0.08, 0.05 }, 0, 0)
  end
  for _, lamp in ipairs(self.lamps) do
    self:thing(self.ball, lamp.place, lamp.radius, lamp.radiance, 0, 1)
  end
  love.graphics.pop()
end

function Scene:thing(mesh, place, scale, radiance, cell, glow)
  self.shader:send("place", { place[1], place[2], place[3], scale })
  self.shader:send("radiance", radiance)
  self.shader:send("cell", cell)
  self.shader:send("glow", glow)
  love.graphics.draw(mesh)
end

local function times(strength, color)
  return { strength * color[1], strength * color[2], strength * color[3] }
end

local WARM, COLD, RED, GREEN = { 1, 0.5, 0.2 }, { 0.3, 0.55, 1 }, { 1, 0.15, 0.1 }, { 0.2, 1, 0.45 }
Scene.lamps = { { place = { 0.36, 1.55, -2.2 }, radius = 0.012, radiance = times(30, COLD) } }
for i = 0, 17 do
  -- 2.39996 is the golden angle, which spreads the lamps evenly, without random numbers
  local depth, angle, reach = 11 + i % 5, 2.39996 * i, math.sqrt((i + 1) / 18)
  local half = depth * math.tan(0.5 * Scene.fieldOfView)
  local x, y = 1.3 * half * reach * math.cos(angle), 1.6 + 0.55 * half * (1 + reach * math.sin(angle)) - 0.09 * depth
  local radiance = times(20 + 10 * (i % 3), ({ WARM, COLD, RED, GREEN })[i % 4 + 1])
  table.insert(Scene.lamps, { place = { x, y, -depth }, radius = 0.05, radiance = radiance })
end

return Scene
