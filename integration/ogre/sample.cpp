// Draws a scene with depth of field in Ogre. Run it in this folder: ./sample picture.png

#include <cstdio>
#include <limits>

#include "capture.h"
#include "scene.h"

#include <fstream>
#include <memory>
#include <stdexcept>

#include "PolygonBokeh.h"

static std::string readFile(const std::string& path)
{
    std::ifstream file(path);
    if (!file)
    {
        throw std::runtime_error("cannot read " + path);
    }
    return {std::istreambuf_iterator<char>(file), {}};
}

// Adds depth of field to a viewport that has a camera. Keep the returned pointer: its destructor removes the effect.
static std::unique_ptr<PolygonBokeh> addBokeh(Ogre::Viewport* viewport, const Ogre::Vector3& subject,
    const PolygonBokeh::Frame& frame = PolygonBokeh::layered(6))
{
    static const std::string library = readFile("../../glsl/bokeh.glsl") + readFile("../../glsl/bokeh_layers.glsl") +
        readFile("../../glsl/bokeh_lens.glsl") + readFile("../../glsl/bokeh_passes.glsl");
    auto bokeh = std::make_unique<PolygonBokeh>(viewport, library, frame);
    bokeh->setLens(viewport->getCamera(), 1.0f, 5.0f); // f/1 with a bokeh scale of 5
    bokeh->uniforms["BokehFocusDistance"] = PolygonBokeh::depthOf(viewport->getCamera(), subject);
    return bokeh;
}

// Adds the next compositor of the viewport, which tone-maps the image and encodes it for the screen
static Ogre::CompositorInstance* addTone(Ogre::Viewport* viewport)
{
    static const char* SOURCE = R"(#version 330
uniform sampler2D picture;
in vec2 BokehUV;
out vec4 color;
void main()
{
    vec3 hdr = textureLod(picture, BokehUV, 0.0).rgb;
    color = vec4(pow(hdr / (1.0 + hdr), vec3(1.0 / 2.2)), 1.0);
}
)";
    auto& compositors = Ogre::CompositorManager::getSingleton();
    if (!compositors.getByName("tone", "General"))
    {
        auto& programs = Ogre::HighLevelGpuProgramManager::getSingleton();
        programs.createProgram("tone", "General", "glsl", Ogre::GPT_FRAGMENT_PROGRAM)->setSource(SOURCE);
        Ogre::MaterialPtr material = Ogre::MaterialManager::getSingleton().create("tone", "General");
        Ogre::Pass* state = material->getTechnique(0)->getPass(0);
        state->setDepthCheckEnabled(false);
        state->setDepthWriteEnabled(false);
        state->setVertexProgram(PolygonBokeh::quadProgram());
        state->setFragmentProgram("tone");
        state->getFragmentProgramParameters()->setNamedConstant("picture", 0);
        state->createTextureUnitState()->setTextureFiltering(Ogre::TFO_NONE);
        Ogre::CompositionTechnique* technique = compositors.create("tone", "General")->createTechnique();
        technique->createTextureDefinition("picture")->formatList = {Ogre::PF_FLOAT16_RGBA};
        auto* input = technique->createTargetPass();
        input->setOutputName("picture");
        input->setInputMode(Ogre::CompositionTargetPass::IM_PREVIOUS);
        auto* output = technique->getOutputTargetPass();
        output->setInputMode(Ogre::CompositionTargetPass::IM_NONE);
        auto* pass = output->createPass(Ogre::CompositionPass::PT_RENDERQUAD);
        pass->setMaterial(material);
        pass->setInput(0, "picture");
    }
    auto* tone = compositors.addCompositor(viewport, "tone");
    tone->setEnabled(true);
    return tone;
}

// Creates a viewport that draws into a texture, because the window is not shown
static Ogre::Viewport* addScreen(Ogre::Camera* camera, unsigned width, unsigned height)
{
    Ogre::TexturePtr screen = Ogre::TextureManager::getSingleton().createManual("screen", "General", Ogre::TEX_TYPE_2D,
        width, height, 0, Ogre::PF_BYTE_RGB, Ogre::TU_RENDERTARGET);
    Ogre::Viewport* viewport = screen->getBuffer()->getRenderTarget()->addViewport(camera);
    viewport->setBackgroundColour(Ogre::ColourValue(0.008f, 0.012f, 0.025f));
    camera->setAspectRatio(float(width) / float(height));
    return viewport;
}

// Draws a frame, and returns its image
static Ogre::Image drawn(Ogre::Viewport* viewport)
{
    viewport->getTarget()->update();
    Ogre::Image image;
    Ogre::TextureManager::getSingleton().getByName("screen", "General")->convertToImage(image);
    return image;
}

// Writes an image of four parts: the input, a hexagon, the near and far field, and an octagon with another focus
static void writePicture(const Scene& scene, const std::string& path)
{
    const unsigned width = 384, height = 256;
    Ogre::Viewport* viewport = addScreen(scene.camera, width, height);
    addTone(viewport);
    std::vector<Ogre::Image> pictures = {drawn(viewport)};
    auto bokeh = addBokeh(viewport, scene.subject);
    const float focus = bokeh->uniforms["BokehFocusDistance"];
    pictures.push_back(drawn(viewport));
    // the depths of three points on the crate behind; the autofocus below takes the nearest
    const std::vector<float> picked = {bokeh->depthAt(258, 165), bokeh->depthAt(264, 165), bokeh->depthAt(270, 165)};
    bokeh = addBokeh(viewport, scene.subject, PolygonBokeh::debug());
    bokeh->uniforms["BokehDebugMode"] = 3.0f;
    pictures.push_back(drawn(viewport));
    bokeh = addBokeh(viewport, scene.subject, PolygonBokeh::layered(8));
    bokeh->pullFocus(std::numeric_limits<float>::infinity(), picked, 0.2f); // dt is infinite: at once
    pictures.push_back(drawn(viewport));
    std::vector<Ogre::uchar> pixels(3 * 4 * width * height);
    Ogre::Image sheet;
    sheet.loadDynamicImage(pixels.data(), 2 * width, 2 * height, 1, Ogre::PF_BYTE_RGB);
    for (unsigned i = 0; i < 4; ++i)
    {
        const Ogre::Box place(i % 2 * width, i / 2 * height, (i % 2 + 1) * width, (i / 2 + 1) * height);
        Ogre::PixelUtil::bulkPixelConversion(pictures[i].getPixelBox(), sheet.getPixelBox().getSubVolume(place, false));
    }
    sheet.save(path);
    const float elsewhere = bokeh->uniforms["BokehFocusDistance"];
    std::printf("%s: focus at %.3f m on the crates, at %.3f m by autofocus\n", path.c_str(), focus, elsewhere);
}

int main(int count, char** arguments)
{
    try
    {
        Ogre::LogManager logs;
        logs.createLog("", true, true, true)->setLogDetail(Ogre::LL_LOW);
        Ogre::Root root("", "", "");
        root.loadPlugin(OGRE_PLUGINS "/RenderSystem_GL3Plus");
        root.loadPlugin(OGRE_PLUGINS "/Codec_STBI");
        root.setRenderSystem(root.getAvailableRenderers().front());
        root.initialise(false);
        const Ogre::NameValuePairList hidden = {{"hidden", "true"}};
        root.createRenderWindow("bokeh", 16, 16, false, &hidden);
        Scene scene(root);
        if (count == 3 && arguments[1] == std::string("--capture"))
        {
            // 2, 4 and 8 do not divide this size, so the sizes of targets are rounded up
            Ogre::Viewport* viewport = addScreen(scene.camera, 285, 189);
            auto* tone = addTone(viewport);
            const auto make = [&](const PolygonBokeh::Frame& frame) { return addBokeh(viewport, scene.subject, frame); };
            capture(arguments[2], viewport, make, tone);
        }
        else
        {
            writePicture(scene, count > 1 ? arguments[1] : "picture.png");
        }
    }
    catch (const std::exception& error)
    {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
