// The sample's scene: a tower of crates in focus on a checkered floor, with lamps in front of it and behind it.
// Lengths are in metres. y points up, and the camera looks along -z.

#pragma once

#include <cmath>
#include <string>

#include <Ogre.h>

class Scene
{
public:
    const Ogre::Vector3 subject{-0.3f, 1.05f, -4.7f};
    Ogre::Camera* camera = nullptr;

    explicit Scene(Ogre::Root& root) : mManager(root.createSceneManager())
    {
        camera = mManager->createCamera("camera");
        camera->setNearClipDistance(0.1f);
        camera->setFarClipDistance(60.0f);
        camera->setFOVy(Ogre::Degree(27.0f)); // that of a 50 mm lens on a sensor 24 mm high
        camera->setAspectRatio(1.5f);
        auto* eye = mManager->getRootSceneNode()->createChildSceneNode(Ogre::Vector3(0.0f, 1.5f, 0.0f));
        eye->attachObject(camera);
        eye->lookAt({0.0f, 1.1f, -5.0f}, Ogre::Node::TS_WORLD);
        makeProgram("scene/vertex", Ogre::GPT_VERTEX_PROGRAM, VERTEX);
        makeProgram("scene/fragment", Ogre::GPT_FRAGMENT_PROGRAM, FRAGMENT);

        using Manager = Ogre::SceneManager;
        // Ogre's cube is 100 units wide, its sphere has a radius of 50, and its plane is 200 wide
        auto* floor = add(Manager::PT_PLANE, {0.0f, 0.0f, -15.0f}, 0.2f, {0.34f, 0.3f, 0.27f}, 0.5f, 0.0f);
        floor->pitch(Ogre::Degree(-90.0f));
        const Ogre::Vector3 crates[] = {{0.55f, 0.25f, 0.1f}, {0.2f, 0.35f, 0.4f}, {0.6f, 0.4f, 0.12f}};
        for (int level = 0; level < 3; ++level)
        {
            const Ogre::Vector3 place(-0.35f, 0.25f + 0.5f * level, -5.0f);
            auto* node = add(Manager::PT_CUBE, place, 0.005f, crates[level], 0.125f, 0.0f);
            node->yaw(Ogre::Degree(25.0f + 30.0f * level));
        }
        add(Manager::PT_CUBE, {1.1f, 0.3f, -8.0f}, 0.006f, {0.3f, 0.32f, 0.36f}, 0.15f, 0.0f)->yaw(Ogre::Degree(40.0f));
        add(Manager::PT_SPHERE, {-0.32f, 1.66f, -2.5f}, 0.002f, {0.7f, 0.6f, 0.5f}, 0.04f, 0.0f);
        addLamps();
    }

private:
    static constexpr const char* VERTEX = R"(#version 330
in vec4 vertex;
in vec3 normal;
uniform mat4 worldViewProj, world;
out vec3 place, direction, local;
void main()
{
    place = (world * vertex).xyz;
    local = vertex.xyz * length(world[0].xyz);
    direction = mat3(world) * normal;
    gl_Position = worldViewProj * vertex;
}
)";
    static constexpr const char* FRAGMENT = R"(#version 330
uniform vec3 radiance;
uniform float cell, glow;
in vec3 place, direction, local;
out vec4 color;
void main()
{
    vec3 box = floor(local / cell + 0.001);
    float checker = mod(box.x + box.y + box.z, 2.0);
    float light = 0.25 + 0.75 * max(dot(normalize(direction), normalize(vec3(-0.5, 0.7, 0.5))), 0.0);
    color = vec4(radiance * mix(light * mix(0.35, 1.0, checker), 1.0, glow), 1.0);
}
)";

    static void makeProgram(const std::string& name, Ogre::GpuProgramType type, const std::string& text)
    {
        auto program = Ogre::HighLevelGpuProgramManager::getSingleton().createProgram(name, "General", "glsl", type);
        program->setSource(text);
        if (type == Ogre::GPT_VERTEX_PROGRAM)
        {
            const auto parameters = program->getDefaultParameters();
            parameters->setNamedAutoConstant("worldViewProj", Ogre::GpuProgramParameters::ACT_WORLDVIEWPROJ_MATRIX);
            parameters->setNamedAutoConstant("world", Ogre::GpuProgramParameters::ACT_WORLD_MATRIX);
        }
    }

    // Adds an object with a material of its own
    Ogre::SceneNode* add(Ogre::SceneManager::PrefabType kind, const Ogre::Vector3& place, float scale,
        const Ogre::Vector3& radiance, float cell, float glow)
    {
        const std::string name = "thing" + std::to_string(mCount++);
        Ogre::MaterialPtr material = Ogre::MaterialManager::getSingleton().create(name, "General");
        Ogre::Pass* pass = material->getTechnique(0)->getPass(0);
        pass->setCullingMode(Ogre::CULL_NONE);
        pass->setVertexProgram("scene/vertex");
        pass->setFragmentProgram("scene/fragment");
        const auto parameters = pass->getFragmentProgramParameters();
        parameters->setNamedConstant("radiance", radiance);
        parameters->setNamedConstant("cell", cell);
        parameters->setNamedConstant("glow", glow);
        Ogre::Entity* entity = mManager->createEntity(kind);
        entity->setMaterial(material);
        auto* node = mManager->getRootSceneNode()->createChildSceneNode(place);
        node->setScale(Ogre::Vector3(scale));
        node->attachObject(entity);
        return node;
    }

    void addLamps()
    {
        const Ogre::Vector3 colors[] = {
            {1.0f, 0.5f, 0.2f}, {0.3f, 0.55f, 1.0f}, {1.0f, 0.15f, 0.1f}, {0.2f, 1.0f, 0.45f}};
        const auto ball = Ogre::SceneManager::PT_SPHERE;
        add(ball, {0.35f, 1.55f, -2.2f}, 0.00024f, 30.0f * colors[1], 1.0f, 1.0f);
        for (int i = 0; i < 18; ++i)
        {
            // the golden angle spreads the lamps evenly, and they are the same each time
            const float depth = 11.0f + float(i % 5), angle = 2.39996f * float(i), reach = std::sqrt((i + 1) / 18.0f);
            const float half = depth * std::tan(0.5f * camera->getFOVy().valueRadians());
            const float x = 1.3f * half * reach * std::cos(angle);
            const float y = 1.6f + 0.55f * half * (1.0f + reach * std::sin(angle)) - 0.09f * depth;
            add(ball, {x, y, -depth}, 0.001f, (20.0f + 10.0f * float(i % 3)) * colors[i % 4], 1.0f, 1.0f);
        }
    }

    Ogre::SceneManager* mManager;
    int mCount = 0;
};
