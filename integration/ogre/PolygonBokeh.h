// SPDX-License-Identifier: MIT
//
// Polygonal bokeh for Ogre 1.12 with its render system GL3+: a compositor made of the passes of bokeh_passes.glsl. It
// is the first of its viewport's compositors; the next one gets the blurred picture as its previous.

#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <Ogre.h>

class PolygonBokeh : public Ogre::CompositorInstance::Listener
{
public:
    using Uniforms = std::map<std::string, float>;

    // A pass: its entry, the textures for the slots ("-": not this one), its targets, 1 / their size (rounded up),
    // parameters of its own. The targets of one pass are one texture of Ogre's compositor, with several formats.
    struct Row
    {
        std::string entry, reads, writes;
        unsigned scale;
        Uniforms sets;
    };
    using Frame = std::vector<Row>;

    // Near objects spread over what is behind them; 4, 6, 8 or 10 sides
    static Frame layered(int sides)
    {
        const std::string near = between("near", sides), far = between("far", sides);
        const std::string first = shape(sides) + "_LAYER_FIRST", second = shape(sides) + "_LAYER_SECOND";
        const std::string unused = std::vector<std::string>{" - - - ", " - - ", " - ", " "}[sides / 2 - 2];
        const Uniforms polygon = {{"BokehSides", float(sides)}};
        return {
            {"LAYER_TILES", "coc", "tiles", 8, {}},
            {"LAYER_REACH", "tiles", "rows", 8, {{"BokehAxis", 0.0f}}},
            {"LAYER_REACH", "rows", "reach", 8, {{"BokehAxis", 1.0f}}},
            {"LAYER_SPLIT", "coc reach", "near far sums leftovers", 2, {}},
            {"LAYER_KERNELS", "sums leftovers", "tile_leftovers tile_sums", 8, {}},
            {"LAYER_SPREAD", "tile_leftovers tile_sums reach", "row_leftovers row_sums", 8, {}},
            {"LAYER_SIZES", "row_leftovers row_sums reach", "reaches sizes", 8, {}},
            {"LAYER_HOLES", "coc reach", "middle_holes far_holes shares", 4, {}},
            {"LAYER_FILL", "middle_holes far_holes shares reach", "middle back", 4, polygon},
            {first, "near sizes", near, 2, {{"BokehLayer", 0.0f}}},
            {second, near + unused + "sizes", "near_blurred", 2, {{"BokehLayer", 0.0f}}},
            {first, "far sizes", far, 2, {{"BokehLayer", 1.0f}}},
            {second, far + unused + "sizes", "far_blurred", 2, {{"BokehLayer", 1.0f}}},
            {"LAYERED", "coc reaches near_blurred far_blurred middle back", "result", 1, polygon},
        };
    }

    // Each pixel by its own circle of confusion: fewer passes
    static Frame exact(int sides)
    {
        const std::string targets = between("t", sides);
        return {
            {shape(sides) + "_FIRST", "coc", targets, 1, {}},
            {shape(sides) + "_SECOND", targets, "result", 1, {}},
        };
    }

    // BokehDebugMode says what to look at: 0 colour, 1 depth, 2 circle of confusion, 3 near and far field
    static Frame debug() { return {{"DEBUG", "coc", "result", 1, {}}}; }

    // Parameters of all passes. Those that are left out are 0.
    Uniforms uniforms = {
        {"BokehDepthKind", 1.0f}, {"BokehSensorHeight", 0.024f}, {"BokehMaxCoC", 0.1f}, {"BokehSpacing", 1.0f},
        {"BokehSqueeze", 1.0f}, {"BokehBleedingBias", 0.02f}, {"BokehBleedingMult", 30.0f},
        {"BokehFocusDistance", 5.0f},
    };

    // library: the texts of bokeh.glsl, bokeh_layers.glsl and bokeh_passes.glsl, in this order
    PolygonBokeh(Ogre::Viewport* viewport, const std::string& library, const Frame& frame)
        : mViewport(viewport),
          mFrame({{"LINEAR_DEPTH", "", "metres", 1, {}}, {"SIGNED_COC_MAP", "color", "coc", 1, {}}})
    {
        static int made = 0;
        mName = "PolygonBokeh" + std::to_string(made++);
        mFrame.insert(mFrame.end(), frame.begin(), frame.end());
        uniforms["BokehAspectRatio"] = float(viewport->getActualWidth()) / float(viewport->getActualHeight());
        uniforms["BokehImageWidth"] = float(viewport->getActualWidth());
        uniforms["BokehImageHeight"] = float(viewport->getActualHeight());
        auto& compositors = Ogre::CompositorManager::getSingleton();
        Ogre::CompositorPtr compositor = compositors.create(mName, GROUP);
        mTechnique = compositor->createTechnique();
        addScene();
        for (size_t i = 0; i < mFrame.size(); ++i)
        {
            addPass(i, library);
        }
        mInstance = compositors.addCompositor(viewport, mName, 0);
        mInstance->addListener(this);
        mInstance->setEnabled(true);
    }

    ~PolygonBokeh()
    {
        mInstance->removeListener(this);
        auto& compositors = Ogre::CompositorManager::getSingleton();
        compositors.removeCompositor(mViewport, mName);
        compositors.remove(mName, GROUP);
        for (size_t i = 0; i < mFrame.size(); ++i)
        {
            Ogre::MaterialManager::getSingleton().remove(materialName(i), GROUP);
        }
    }

    // The lens of the camera's own field of view, at an f-stop; call it again where the camera zooms. Smaller stops
    // than those of real lenses blur more (docs/lens.md).
    void setLens(const Ogre::Camera* camera, float fStop)
    {
        const float focal = uniforms["BokehSensorHeight"] / (2.0f * std::tan(0.5f * camera->getFOVy().valueRadians()));
        uniforms["BokehFocalLength"] = focal;
        uniforms["BokehApertureDiameter"] = focal / fStop;
        uniforms["BokehNear"] = camera->getNearClipDistance();
        uniforms["BokehFar"] = camera->getFarClipDistance();
    }

    // Depth of a place in the world along the camera's view axis: what to focus on
    static float depthOf(const Ogre::Camera* camera, const Ogre::Vector3& place)
    {
        return -(camera->getViewMatrix() * place).z;
    }

    // Depth of a pixel of the last frame, metres. It waits for the GPU: do it on a click, not each frame.
    float depthAt(unsigned x, unsigned y)
    {
        float metres = 0.0f;
        const Ogre::PixelBox texel(1, 1, 1, Ogre::PF_FLOAT32_R, &metres);
        texture("metres")->getBuffer()->blitToMemory(Ogre::Box(x, y, x + 1, y + 1), texel);
        return metres;
    }

    // Focus smoothly on the nearest of several depths: call it each frame. tau is the time constant; seconds.
    void pullFocus(float dt, const std::vector<float>& depths, float tau)
    {
        float& focus = uniforms["BokehFocusDistance"];
        const float nearest = 1.0f / *std::min_element(depths.begin(), depths.end());
        focus = 1.0f / (1.0f / focus + (1.0f - std::exp(-dt / tau)) * (nearest - 1.0f / focus));
    }

    // A texture by its name in the tables; "color" and "depth" are the scene's. The result is in the next compositor's.
    const Ogre::TexturePtr& texture(const std::string& name) const
    {
        const Place& place = mPlaces.at(name);
        return mInstance->getTextureInstance(place.texture, place.index);
    }

    const Frame& frame() const { return mFrame; }

    // Ogre draws with copies of the materials: parameters are set here, not in the originals.
    void notifyMaterialRender(Ogre::uint32 pass, Ogre::MaterialPtr& material) override
    {
        const auto parameters = material->getTechnique(0)->getPass(0)->getFragmentProgramParameters();
        for (const Uniforms* values : {&uniforms, &mFrame.at(pass).sets})
        {
            for (const auto& [name, value] : *values)
            {
                parameters->setNamedConstant(name, value);
            }
        }
    }

    // Ogre's quad, from which it takes the coordinates: v = 0 is the first row in memory, on top. Its matrix turns y
    // around while a texture is drawn into.
    static std::string quadProgram()
    {
        const std::string name = "PolygonBokeh/quad";
        auto& programs = Ogre::HighLevelGpuProgramManager::getSingleton();
        if (!programs.getByName(name, GROUP))
        {
            auto program = programs.createProgram(name, GROUP, "glsl", Ogre::GPT_VERTEX_PROGRAM);
            program->setSource("#version 330\n"
                               "in vec4 vertex;\n"
                               "in vec2 uv0;\n"
                               "uniform mat4 worldViewProj;\n"
                               "out vec2 BokehUV;\n"
                               "void main() { gl_Position = worldViewProj * vertex; BokehUV = uv0; }\n");
            const auto matrix = Ogre::GpuProgramParameters::ACT_WORLDVIEWPROJ_MATRIX;
            program->getDefaultParameters()->setNamedAutoConstant("worldViewProj", matrix);
        }
        return name;
    }

    static std::vector<std::string> words(const std::string& text)
    {
        std::istringstream stream(text);
        std::vector<std::string> found;
        for (std::string word; stream >> word;)
        {
            found.push_back(word);
        }
        return found;
    }

private:
    struct Place
    {
        std::string texture;
        size_t index;
    };

    static constexpr const char* GROUP = "General";

    std::string materialName(size_t index) const { return mName + "/" + std::to_string(index); }

    static std::string shape(int sides)
    {
        return std::vector<std::string>{"SQUARE", "HEXAGON", "OCTAGON", "DECAGON"}.at(sides / 2 - 2);
    }

    // Two passes blur with a polygon; between them are half as many targets as it has sides, less one.
    static std::string between(const std::string& stem, int sides)
    {
        std::string names;
        for (int k = 2; k <= sides / 2; ++k)
        {
            names += (k > 2 ? " " : "") + stem + std::to_string(k);
        }
        return names;
    }

    void addTexture(const std::string& texture, const std::string& names, unsigned scale, Ogre::PixelFormat format)
    {
        auto* definition = mTechnique->createTextureDefinition(texture);
        // not widthFactor: it rounds down
        definition->width = (mViewport->getActualWidth() + scale - 1) / scale;
        definition->height = (mViewport->getActualHeight() + scale - 1) / scale;
        definition->fsaa = false;
        for (const std::string& name : words(names))
        {
            mPlaces[name] = {texture, definition->formatList.size()};
            definition->formatList.push_back(format);
        }
    }

    // Colour: what the viewport shows, with the compositors before this one. Depth: the scene once more, into a texture
    // that shaders can read; that of the colour they cannot.
    void addScene()
    {
        addTexture("scene", "color", 1, Ogre::PF_FLOAT16_RGBA);
        auto* color = mTechnique->createTargetPass();
        color->setOutputName("scene");
        color->setInputMode(Ogre::CompositionTargetPass::IM_PREVIOUS);

        addTexture("scene_depth", "depth", 1, Ogre::PF_DEPTH32F);
        auto* depth = mTechnique->createTargetPass();
        depth->setOutputName("scene_depth");
        depth->setInputMode(Ogre::CompositionTargetPass::IM_NONE);
        depth->setMaterialScheme(mViewport->getMaterialScheme());
        depth->setVisibilityMask(mViewport->getVisibilityMask());
        depth->setShadowsEnabled(false);
        depth->createPass(Ogre::CompositionPass::PT_CLEAR)->setClearBuffers(Ogre::FBT_DEPTH);
        depth->createPass(Ogre::CompositionPass::PT_RENDERSCENE);
    }

    void addPass(size_t index, const std::string& library)
    {
        const Row& row = mFrame[index];
        Ogre::CompositionTargetPass* target = mTechnique->getOutputTargetPass();
        if (index + 1 < mFrame.size())
        {
            const std::string texture = "pass" + std::to_string(index);
            const auto format = row.writes == "metres" ? Ogre::PF_FLOAT32_R : Ogre::PF_FLOAT16_RGBA;
            addTexture(texture, row.writes, row.scale, format);
            mTechnique->getTextureDefinition(texture)->depthBufferId = 0; // none
            target = mTechnique->createTargetPass();
            target->setOutputName(texture);
        }
        target->setInputMode(Ogre::CompositionTargetPass::IM_NONE);
        auto* pass = target->createPass(Ogre::CompositionPass::PT_RENDERQUAD);
        pass->setIdentifier(Ogre::uint32(index));

        Ogre::MaterialPtr material = Ogre::MaterialManager::getSingleton().create(materialName(index), GROUP);
        Ogre::Pass* state = material->getTechnique(0)->getPass(0);
        state->setDepthCheckEnabled(false);
        state->setDepthWriteEnabled(false);
        state->setCullingMode(Ogre::CULL_NONE);
        state->setSceneBlending(Ogre::SBT_REPLACE); // alpha is the CoC
        state->setVertexProgram(quadProgram());
        state->setFragmentProgram(fragmentProgram(row.entry, library));
        const auto parameters = state->getFragmentProgramParameters();
        parameters->setIgnoreMissingParams(true);
        int unit = 0;
        const auto bind = [&](const std::string& slot, const std::string& name) {
            Ogre::TextureUnitState* sampler = state->createTextureUnitState();
            // Ogre's defaults: repeated, with mip levels
            sampler->setTextureAddressingMode(Ogre::TextureUnitState::TAM_CLAMP);
            sampler->setTextureFiltering(Ogre::FO_LINEAR, Ogre::FO_LINEAR, Ogre::FO_NONE);
            parameters->setNamedConstant(slot, unit);
            pass->setInput(unit++, mPlaces.at(name).texture, mPlaces.at(name).index);
        };
        bind("BokehDepthSamp", row.entry == "LINEAR_DEPTH" ? "depth" : "metres");
        const std::vector<std::string> reads = words(row.reads);
        for (size_t i = 0; i < reads.size(); ++i)
        {
            if (reads[i] != "-")
            {
                bind(std::string("BokehColorSamp") + (i > 0 ? std::string(1, char('A' + i)) : ""), reads[i]);
            }
        }
        material->load();
        pass->setMaterial(material);
    }

    static std::string fragmentProgram(const std::string& entry, const std::string& library)
    {
        const std::string name = "PolygonBokeh/" + entry;
        auto& programs = Ogre::HighLevelGpuProgramManager::getSingleton();
        if (!programs.getByName(name, GROUP))
        {
            auto program = programs.createProgram(name, GROUP, "glsl", Ogre::GPT_FRAGMENT_PROGRAM);
            const std::string defines = "#define BOKEH_PASS BOKEH_" + entry + "\n#define BOKEH_NUM_SAMPLES 33\n";
            program->setSource("#version 330\n" + defines + library);
        }
        return name;
    }

    std::string mName;
    Ogre::Viewport* mViewport;
    Frame mFrame;
    std::map<std::string, Place> mPlaces;
    Ogre::CompositionTechnique* mTechnique = nullptr;
    Ogre::CompositorInstance* mInstance = nullptr;
};
