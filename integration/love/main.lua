-- The sample. "love ." opens a window: a click focuses, keys 1 to 3 show a debug view, and 0 shows the result.
-- "love . picture.png" writes an image.

local PolygonBokeh = require("polygon_bokeh")
local Scene = require("scene")

local VIEWS = { ["1"] = "depth", ["2"] = "coc", ["3"] = "focus" }
-- If the mouse moves by more pixels between press and release, it drags instead of clicking
local CLICK = 5
local scene, bokeh, tone, focus, pressed

-- The last step: tone mapping, and the encoding for the screen
local TONE_MAPPING = [[
vec4 effect(vec4 color, Image image, vec2 uv, vec2 pixel)
{
    vec3 hdr = Texel(image, uv).rgb;
    return vec4(pow(hdr / (1.0 + hdr), vec3(1.0 / 2.2)), 1.0);
}
]]

-- Returns the text of a file in glsl/. In your game, put the file next to main.lua, and call
-- love.filesystem.read(name) instead.
local function read(name)
  local file = assert(io.open(love.filesystem.getSource() .. "/../../glsl/" .. name))
  local text = file:read("*a")
  file:close()
  return text
end

-- Creates depth of field for a scene. `options` are passed to PolygonBokeh.new.
local function addBokeh(scene, options)
  local library = read("bokeh.glsl") .. read("bokeh_layers.glsl") .. read("bokeh_lens.glsl")
  local made = PolygonBokeh.new(library, scene.color:getWidth(), scene.color:getHeight(), options)
  made:setLens(scene.fieldOfView, 1, 5) -- f/1, with a blur 5 times as wide as a real lens's
  made.uniforms.zNear, made.uniforms.zFar = scene.near, scene.far
  made.uniforms.focusDistance = scene:depthOf(scene.subject)
  return made
end

-- Writes four images into one file: the input, a hexagon, near and far field, and an octagon with another focus.
local function writePicture(path)
  local width, height = scene.color:getDimensions()
  local sheet = love.graphics.newCanvas(2 * width, 2 * height, { dpiscale = 1 })
  local function show(canvas, x, y)
    love.graphics.setCanvas(sheet)
    love.graphics.draw(canvas, x * width, y * height)
    love.graphics.setCanvas()
  end
  scene:draw()
  love.graphics.setShader(tone)
  show(scene.color, 0, 0)
  show(bokeh:draw(scene.color, scene.depth), 1, 0)
  local octagon = addBokeh(scene, { sides = 8 })
  love.mousepressed(262, 125)
  love.mousereleased(262, 125)
  octagon:pullFocus(math.huge, focus, 0.2) -- the focus jumps to its target
  show(octagon:draw(scene.color, scene.depth), 1, 1)
  love.keypressed("3")
  show(bokeh:draw(scene.color, scene.depth), 0, 1)
  local file = assert(io.open(path, "wb"))
  file:write(sheet:newImageData():encode("png"):getString())
  file:close()
  local message = "%s: focus at %.3f m on the pawn, at %.3f m by autofocus"
  print(message:format(path, scene:depthOf(scene.subject), math.min(unpack(focus))))
end

-- Does what the command line asks for, without showing anything, and quits.
local function run(what, folder)
  if what == "--capture" then
    require("capture")(folder, addBokeh)
  else
    writePicture(what)
  end
  love.event.quit()
end

function love.load(arguments)
  if arguments[1] then
    -- LOVE's own error screen would wait for a key
    love.errorhandler = function(message)
      print(debug.traceback(message))
      return function() return 1 end
    end
  end
  tone = love.graphics.newShader(TONE_MAPPING)
  scene = Scene.new(love.graphics.getDimensions())
  bokeh = addBokeh(scene)
  focus = { scene:depthOf(scene.subject) }
  if arguments[1] then
    run(unpack(arguments))
  end
end

function love.update(dt)
  bokeh:pullFocus(dt, focus, 0.2)
end

function love.draw()
  scene:draw()
  local result = bokeh:draw(scene.color, scene.depth)
  love.graphics.setShader(tone)
  love.graphics.draw(result)
  love.graphics.setShader()
end

function love.mousepressed(x, y)
  pressed = { x, y }
end

-- A click focuses on the nearest of three points.
function love.mousereleased(x, y)
  if pressed and math.max(math.abs(x - pressed[1]), math.abs(y - pressed[2])) <= CLICK then
    focus = { bokeh:depthAt(x - 4, y), bokeh:depthAt(x, y), bokeh:depthAt(x + 4, y) }
  end
end

function love.keypressed(key)
  if key:match("^[0-3]$") then
    bokeh = addBokeh(scene, { view = VIEWS[key] })
  end
end
