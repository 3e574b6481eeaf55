function love.conf(t)
  t.version = "11.4"
  t.identity = "polygonal_bokeh"
  t.window.title = "Polygonal bokeh"
  t.window.width, t.window.height = 384, 256
  t.modules.audio, t.modules.joystick, t.modules.physics, t.modules.video = false, false, false, false
end
