// SPDX-License-Identifier: MIT
//
// Blurs an image with PolygonBokeh.h, without a window:
//
//   sample glsl|hlsl layered-hexagon|layered-octagon|exact-hexagon|exact-octagon FOLDER [ROTATION]
//
// ROTATION rotates the polygon clockwise, in degrees. If you leave it out, it is 0.
//
// FOLDER must contain these files:
//
//   camera.txt  eight numbers: width and height of the image in pixels; aperture diameter, focal length and focus
//               distance in metres; largest CoC as a fraction of the image height; distances of the near plane and of
//               the far plane in metres
//   color.f16   linear colour: RGBA as half floats, top row first
//   depth.f32   depth as floats, 0 at the near plane and 1 at the far plane, top row first
//
// The sample writes its result into FOLDER as NAME.f16, where NAME is the second argument, for example layered-hexagon.
// For the tests, it also writes all targets of all passes, as NAME.written.
#include <cstdlib>
#include <iostream>
#include <sstream>

#include "PolygonBokeh.h"

static const std::map<std::string, const std::vector<BokehPass> *> NAMED = {{"layered-hexagon", &LAYERED_HEXAGON},
                                                                            {"layered-octagon", &LAYERED_OCTAGON},
                                                                            {"exact-hexagon", &EXACT_HEXAGON},
                                                                            {"exact-octagon", &EXACT_OCTAGON}};
static const vk::ImageAspectFlags COLOR = vk::ImageAspectFlagBits::eColor, DEPTH = vk::ImageAspectFlagBits::eDepth;
static const BokehUse NOTHING = {}, COPY_FROM = {vk::PipelineStageFlagBits2::eCopy, vk::AccessFlagBits2::eTransferRead,
                                                 vk::ImageLayout::eTransferSrcOptimal};
static const BokehUse COPY_TO = {vk::PipelineStageFlagBits2::eCopy, vk::AccessFlagBits2::eTransferWrite,
                                 vk::ImageLayout::eTransferDstOptimal};

// Compiles an entry point to SPIR-V, with the compilers of the Vulkan SDK, and writes it into the folder. An engine
// does this at build time.
static void compile(bool hlsl, const std::string &folder, const std::string &entry, const std::string &define,
                    bool vertex = false)
{
    const std::string name = entry + (vertex ? "_VS" : "_PS"), to = "\"" + folder + "/" + entry + ".spv\"";
    std::string command = "glslangValidator -V --quiet -S " + std::string(vertex ? "vert" : "frag") + " -e " + name +
                          " --source-entrypoint main -DBOKEH_PASS=BOKEH_" + define + " -o " + to + " dof.glsl";
    if (hlsl)
        command = "dxc -spirv -E " + name + (vertex ? " -T vs_6_0 -fvk-invert-y" : " -T ps_6_0") +
                  " -fvk-bind-register b0 0 0 0 -fvk-bind-register s0 0 7 0 -fvk-bind-register t0 0 1 0"
                  " -fvk-bind-register t1 0 2 0 -fvk-bind-register t2 0 3 0 -fvk-bind-register t3 0 4 0"
                  " -fvk-bind-register t4 0 5 0 -fvk-bind-register t5 0 6 0 -fvk-bind-register t6 0 8 0"
                  " -fvk-bind-register t7 0 9 0 -Fo " + to + " dof.hlsl";
    if (std::system(command.c_str()))
        throw std::runtime_error("cannot compile " + name);
}

// Uploads the bytes of a file to a new image, and returns a view of it. In your engine, the renderer draws these images
// instead.
static vk::ImageView upload(BokehDevice &own, vk::CommandBuffer commands, const std::string &file, vk::Extent2D size,
                            vk::Format format, vk::ImageAspectFlags aspect)
{
    char *mapped;
    const std::string bytes = BokehDevice::read(file);
    const vk::Buffer buffer = own.make_buffer(bytes.size(), vk::BufferUsageFlagBits::eTransferSrc, mapped);
    const vk::Image image =
        own.make_image(format, size, vk::ImageUsageFlagBits::eTransferDst | vk::ImageUsageFlagBits::eSampled);
    memcpy(mapped, bytes.data(), bytes.size());
    own.share_memory({image});
    own.barrier(commands, image, NOTHING, COPY_TO, aspect);
    const vk::BufferImageCopy all(0, 0, 0, {aspect, 0, 0, 1}, {}, {size.width, size.height, 1});
    commands.copyBufferToImage(buffer, image, COPY_TO.layout, all);
    own.barrier(commands, image, COPY_TO, PolygonBokeh::READ, aspect);
    return own.make_view(image, format, aspect);
}

static void draw(vk::PhysicalDevice gpu, vk::Device device, bool hlsl, std::string name, std::string folder,
                 float rotation)
{
    const std::vector<BokehPass> &frame = *NAMED.at(name);
    BokehDevice own{gpu, device};
    vk::Extent2D size;
    std::istringstream camera(BokehDevice::read(folder + "/camera.txt"));
    camera >> size.width >> size.height;
    const vk::UniqueCommandPool pool = device.createCommandPoolUnique({});
    const vk::CommandBuffer commands = device.allocateCommandBuffers({*pool, vk::CommandBufferLevel::ePrimary, 1})[0];
    commands.begin(vk::CommandBufferBeginInfo());
    const auto color = upload(own, commands, folder + "/color.f16", size, PolygonBokeh::FORMAT, COLOR);
    const auto depth = upload(own, commands, folder + "/depth.f32", size, vk::Format::eD32Sfloat, DEPTH);
    compile(hlsl, folder, "BokehFullScreen", "FULL_SCREEN", true);
    for (const BokehPass &pass : frame)
        compile(hlsl, folder, pass.entry, pass.define);
    PolygonBokeh bokeh(gpu, device, frame, folder, size, color, depth);
    BokehParameters &set = bokeh.parameters;
    camera >> set.ApertureDiameter >> set.FocalLength >> set.FocusDistance >> set.MaxCoC >> set.Near >> set.Far;
    set.Angle = rotation * 3.14159265f / 180; // clockwise, because v grows downwards
    bokeh.record(commands, 0);
    // record the passes again, and copy the targets of each pass before another pass overwrites their memory
    char *mapped;
    size_t bytes = 0, result = 8 * size.width * size.height;
    const auto copies = own.make_buffer(4 * result * frame.size(), vk::BufferUsageFlagBits::eTransferDst, mapped);
    for (size_t i = 0; i < frame.size(); i++) {
        bokeh.record_pass(commands, 0, i);
        for (const std::string &written : frame[i].writes) {
            const auto &[image, view, area] = bokeh.targets[written];
            const vk::BufferImageCopy all(bytes, 0, 0, {COLOR, 0, 0, 1}, {}, {area.width, area.height, 1});
            own.barrier(commands, image, PolygonBokeh::READ, COPY_FROM);
            commands.copyImageToBuffer(image, COPY_FROM.layout, copies, all);
            own.barrier(commands, image, COPY_FROM, PolygonBokeh::READ);
            bytes += 8 * area.width * area.height;
        }
    }
    // waitIdle alone does not make the device's writes visible to the CPU
    const vk::MemoryBarrier2 shown(COPY_TO.stages, COPY_TO.access, vk::PipelineStageFlagBits2::eHost,
                                   vk::AccessFlagBits2::eHostRead);
    commands.pipelineBarrier2({{}, shown});
    commands.end();
    device.getQueue(0, 0).submit(vk::SubmitInfo({}, {}, commands));
    device.waitIdle();
    std::ofstream(folder + "/" + name + ".written", std::ios::binary).write(mapped, bytes);
    std::ofstream(folder + "/" + name + ".f16", std::ios::binary).write(mapped + bytes - result, result);
}

int main(int argc, char **argv)
try {
    if (argc < 4 || argc > 5 || !NAMED.count(argv[2]))
        throw std::runtime_error("usage: sample glsl|hlsl layered-hexagon|layered-octagon|exact-hexagon|exact-octagon FOLDER [ROTATION]");
    const vk::ApplicationInfo application(nullptr, 0, nullptr, 0, VK_API_VERSION_1_3);
    const vk::UniqueInstance instance = vk::createInstanceUnique({{}, &application});
    const vk::PhysicalDevice gpu = instance->enumeratePhysicalDevices().at(0);
    std::cout << gpu.getProperties().deviceName << std::endl;
    const float priority = 1;
    const vk::DeviceQueueCreateInfo queue({}, 0, 1, &priority); // the first queue family, which must support graphics
    const auto features = vk::PhysicalDeviceVulkan13Features().setSynchronization2(true).setDynamicRendering(true);
    const auto device = gpu.createDeviceUnique(vk::DeviceCreateInfo({}, queue).setPNext(&features));
    draw(gpu, *device, argv[1] == std::string("hlsl"), argv[2], argv[3], argc > 4 ? std::stof(argv[4]) : 0);
} catch (const std::exception &error) {
    std::cerr << error.what() << std::endl;
    return 1;
}
