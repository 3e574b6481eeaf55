// Writes everything that the shaders read and wrote into a folder, for validation/run engines. Your program does not
// need this file.
//
// It writes color.f16, depth.f32, a .f16 file with the result of each shot, and a .written file with all targets of
// each layered shot. All of these contain raw rows, beginning at v = 0. capture.json describes them, and has a record
// of the autofocus.

#pragma once

#include <cstdio>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "PolygonBokeh.h"

// Returns the bytes of a texture, in the order of its rows in memory
inline std::string bytesOf(const Ogre::TexturePtr& texture)
{
    const Ogre::PixelFormat format = texture->getFormat();
    std::string bytes(Ogre::PixelUtil::getMemorySize(texture->getWidth(), texture->getHeight(), 1, format), '\0');
    const Ogre::PixelBox box(texture->getWidth(), texture->getHeight(), 1, format, bytes.data());
    texture->getBuffer()->blitToMemory(box);
    return bytes;
}

inline void write(const std::string& path, const std::string& bytes)
{
    std::ofstream file(path, std::ios::binary);
    file << bytes;
    if (!file.flush())
    {
        throw std::runtime_error("cannot write " + path);
    }
}

inline std::string number(float value)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", double(value));
    return text;
}

// Returns a record of the autofocus as JSON: 12 frames of 20 ms each, in which the focus moves to the nearest of the
// ball, the crates and the sky
inline std::string pulled(PolygonBokeh& bokeh, const Ogre::Viewport* viewport)
{
    std::vector<float> depths;
    std::string points, distances;
    for (const auto& [u, v] : std::vector<std::pair<float, float>>{{0.32f, 0.2f}, {0.4f, 0.65f}, {0.9f, 0.1f}})
    {
        const auto x = unsigned(u * float(viewport->getActualWidth()));
        depths.push_back(bokeh.depthAt(x, unsigned(v * float(viewport->getActualHeight()))));
        points += points.empty() ? "[" : ", [";
        points += number(u) + ", " + number(v) + ", " + number(depths.back()) + "]";
    }
    for (int i = 0; i < 12; ++i)
    {
        bokeh.pullFocus(0.02f, depths, 0.2f);
        distances += (i ? ", " : "") + number(bokeh.uniforms["BokehFocusDistance"]);
    }
    return "\"frame\": 0.02, \"seconds\": 0.2, \"points\": [" + points + "], \"distances\": [" + distances + "]";
}

inline void capture(const std::string& folder, Ogre::Viewport* viewport,
    const std::function<std::unique_ptr<PolygonBokeh>(const PolygonBokeh::Frame&)>& make,
    Ogre::CompositorInstance* tone)
{
    std::string shots, camera, stored, pull;
    // method, polygon, number of sides, degrees clockwise, and whether the near and the far blur have scales and limits of their own
    using Shot = std::tuple<std::string, std::string, int, float, bool>;
    for (const auto& [method, aperture, sides, clockwise, focused] : std::vector<Shot>{
             {"layered", "hexagon", 6, 0, true}, {"layered", "hexagon", 6, 0, false},
             {"layered", "octagon", 8, 0, false}, {"exact", "hexagon", 6, 0, false},
             {"exact", "octagon", 8, 0, false}, {"exact", "square", 4, 0, false}, {"exact", "decagon", 10, 0, false},
             {"exact", "square", 4, 10, false}})
    {
        const std::string name = method + "-" + aperture + (clockwise ? "-rotated" : "") + (focused ? "-focused" : "");
        const bool layered = method == "layered";
        const auto bokeh = make(layered ? PolygonBokeh::layered(sides) : PolygonBokeh::exact(sides));
        auto& uniforms = bokeh->uniforms;
        uniforms["BokehAngle"] = Ogre::Degree(clockwise).valueRadians();
        if (focused)
        {
            uniforms["BokehNearScale"] = 0.5f;
            uniforms["BokehFarScale"] = 0.75f;
            uniforms["BokehNearMaxCoC"] = 0.02f;
            uniforms["BokehFarMaxCoC"] = 0.03f;
        }
        viewport->getTarget()->update();
        const std::string result = bytesOf(tone->getTextureInstance("picture", 0));
        write(folder + "/" + name + ".f16", result);
        shots += (shots.empty() ? "" : ", ") + ("{\"name\": \"" + name + "\", \"method\": \"" + method);
        shots += "\", \"aperture\": \"" + aperture + "\", \"result\": \"" + name + ".f16\"";
        if (layered)
        {
            std::string written;
            const auto& frame = bokeh->frame();
            for (size_t i = 0; i + 1 < frame.size(); ++i)
            {
                for (const std::string& target : PolygonBokeh::words(frame[i].writes))
                {
                    written += bytesOf(bokeh->texture(target));
                }
            }
            write(folder + "/" + name + ".written", written + result);
            shots += ", \"written\": \"" + name + ".written\"";
        }
        if (focused)
        {
            shots += ", \"focus\": {\"scale\": [" + number(uniforms["BokehNearScale"]) + ", " +
                number(uniforms["BokehFarScale"]) + "], \"limits\": [" + number(uniforms["BokehNearMaxCoC"]) + ", " +
                number(uniforms["BokehFarMaxCoC"]) + "]}";
        }
        shots += (clockwise ? ", \"clockwise\": " + number(clockwise) : "") + "}";
        write(folder + "/color.f16", bytesOf(bokeh->texture("color")));
        write(folder + "/depth.f32", bytesOf(bokeh->texture("depth")));
        camera = "\"aperture_diameter\": " + number(uniforms["BokehApertureDiameter"]) +
            ", \"focal_length\": " + number(uniforms["BokehFocalLength"]) +
            ", \"focus_distance\": " + number(uniforms["BokehFocusDistance"]) +
            ", \"sensor_height\": " + number(uniforms["BokehSensorHeight"]) +
            ", \"max_coc\": " + number(uniforms["BokehMaxCoC"]);
        stored = "\"kind\": 1, \"near\": " + number(uniforms["BokehNear"]) + ", \"far\": " + number(uniforms["BokehFar"]);
        pull = pulled(*bokeh, viewport);
        if (clockwise)
        {
            const std::string color = bytesOf(bokeh->texture("color"));
            bokeh->setLens(viewport->getCamera(), 2.8f, 0.0f);
            // the first frames may still show the blur
            for (int frames = 0; bytesOf(tone->getTextureInstance("picture", 0)) != color; ++frames)
            {
                if (frames == 20) throw std::runtime_error("a bokeh scale of 0 changes the image");
                viewport->getTarget()->update();
            }
        }
    }
    const auto& device = *Ogre::Root::getSingleton().getRenderSystem()->getCapabilities();
    write(folder + "/capture.json",
        "{\"engine\": \"Ogre " + std::to_string(OGRE_VERSION_MAJOR) + "." + std::to_string(OGRE_VERSION_MINOR) + "." +
            std::to_string(OGRE_VERSION_PATCH) + ", " + device.getRenderSystemName() + "\", \"device\": \"" +
            device.getDeviceName() + "\", \"width\": " + std::to_string(viewport->getActualWidth()) +
            ", \"height\": " + std::to_string(viewport->getActualHeight()) +
            ", \"color\": \"color.f16\", \"depth\": \"depth.f32\", \"stored\": {" + stored + "}, \"camera\": {" + camera +
            "}, \"shots\": [" + shots + "], \"pull\": {" + pull + "}}");
}
