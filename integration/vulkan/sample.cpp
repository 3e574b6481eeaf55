// SPDX-License-Identifier: MIT
//
// PolygonBokeh.h on a picture with depth, without a window:
//
//   sample glsl|hlsl layered-hexagon|layered-octagon|exact-hexagon|exact-octagon FOLDER
//
// FOLDER has camera.txt (width and height; aperture diameter, focal length and focus distance in metres, largest CoC as
// a share of the height, near and far plane), color.f16 (RGBA, linear) and depth.f32 (0 near .. 1 far), rows from the
// upper one on. The result goes there too, NAME.f16, and for the tests all that the passes wrote, NAME.written.
#include <cstdlib>
#include <iostream>
#include <sstream>

#include "PolygonBokeh.h"

static const std::map<std::string, const std::vector<BokehPass> *> NAMED = {{"layered-hexagon", &LAYERED_HEXAGON},
                                                                            {"layered-octagon", &LAYERED_OCTAGON},
                                                                            {"exact-hexagon", &EXACT_HEXAGON},
                                                                            {"exact-octagon", &EXACT_OCTAGON}};
static constexpr VkImageAspectFlags COLOR = VK_IMAGE_ASPECT_COLOR_BIT, DEPTH = VK_IMAGE_ASPECT_DEPTH_BIT;
static constexpr BokehUse NOTHING = {VK_PIPELINE_STAGE_2_NONE, VK_ACCESS_2_NONE, VK_IMAGE_LAYOUT_UNDEFINED};
static constexpr BokehUse COPY_FROM = {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                                       VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
static constexpr BokehUse COPY_TO = {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                     VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL};

// SPIR-V by the compilers of the Vulkan SDK, into the folder; an engine does that when it is built.
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

static std::string read(const std::string &path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

// What your renderer draws, here the bytes of a file.
static VkImageView upload(BokehDevice &own, VkCommandBuffer commands, const std::string &file, VkExtent2D size,
                          VkFormat format, VkImageAspectFlags aspect)
{
    char *mapped;
    const std::string bytes = read(file);
    const VkBuffer buffer = own.make_buffer(bytes.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, mapped);
    const VkImage image = own.make_image(format, size, VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT);
    const VkBufferImageCopy all = {0, 0, 0, {aspect, 0, 0, 1}, {}, {size.width, size.height, 1}};
    memcpy(mapped, bytes.data(), bytes.size());
    own.share_memory({image});
    own.barrier(commands, image, NOTHING, COPY_TO, aspect);
    vkCmdCopyBufferToImage(commands, buffer, image, COPY_TO.layout, 1, &all);
    own.barrier(commands, image, COPY_TO, PolygonBokeh::READ, aspect);
    return own.make_view(image, format, aspect);
}

// The frame on a device: its first queue family draws.
static void draw(VkPhysicalDevice gpu, VkDevice device, bool hlsl, const std::string &name, const std::string &folder)
{
    const std::vector<BokehPass> &frame = *NAMED.at(name);
    BokehDevice own(gpu, device);
    VkExtent2D size;
    VkQueue queue;
    VkCommandBuffer commands;
    std::istringstream camera(read(folder + "/camera.txt"));
    camera >> size.width >> size.height;
    const VkCommandPool pool =
        own.make(vkCreateCommandPool, vkDestroyCommandPool, {VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO});
    const VkCommandBufferAllocateInfo asked = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, pool,
                                               VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
    const VkCommandBufferBeginInfo begin = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    own.check(vkAllocateCommandBuffers(device, &asked, &commands));
    own.check(vkBeginCommandBuffer(commands, &begin));
    const VkImageView color = upload(own, commands, folder + "/color.f16", size, PolygonBokeh::FORMAT, COLOR);
    const VkImageView depth = upload(own, commands, folder + "/depth.f32", size, VK_FORMAT_D32_SFLOAT, DEPTH);
    compile(hlsl, folder, "BokehFullScreen", "FULL_SCREEN", true);
    for (const BokehPass &pass : frame)
        compile(hlsl, folder, pass.entry, pass.define);
    PolygonBokeh bokeh(gpu, device, frame, folder, size, color, depth);
    BokehParameters &set = bokeh.parameters;
    camera >> set.ApertureDiameter >> set.FocalLength >> set.FocusDistance >> set.MaxCoC >> set.Near >> set.Far;
    // record(), and a copy of what each pass wrote before another one takes its memory
    char *mapped;
    VkDeviceSize bytes = 0;
    const VkDeviceSize room = 32 * frame.size() * size.width * size.height;
    const VkBuffer copies = own.make_buffer(room, VK_BUFFER_USAGE_TRANSFER_DST_BIT, mapped);
    for (size_t i = 0; i < frame.size(); i++) {
        bokeh.record_pass(commands, 0, i);
        for (const std::string &written : frame[i].writes) {
            const auto &[image, view, area] = bokeh.targets[written];
            const VkBufferImageCopy all = {bytes, 0, 0, {COLOR, 0, 0, 1}, {}, {area.width, area.height, 1}};
            own.barrier(commands, image, PolygonBokeh::READ, COPY_FROM);
            vkCmdCopyImageToBuffer(commands, image, COPY_FROM.layout, copies, 1, &all);
            own.barrier(commands, image, COPY_FROM, PolygonBokeh::READ);
            bytes += 8 * area.width * area.height;
        }
    }
    own.check(vkEndCommandBuffer(commands));
    const VkSubmitInfo submit = {VK_STRUCTURE_TYPE_SUBMIT_INFO, nullptr, 0, nullptr, nullptr, 1, &commands};
    vkGetDeviceQueue(device, 0, 0, &queue);
    own.check(vkQueueSubmit(queue, 1, &submit, VK_NULL_HANDLE));
    own.check(vkDeviceWaitIdle(device));
    const size_t result = 8 * size.width * size.height;
    std::ofstream(folder + "/" + name + ".written", std::ios::binary).write(mapped, bytes);
    std::ofstream(folder + "/" + name + ".f16", std::ios::binary).write(mapped + bytes - result, result);
}

int main(int argc, char **argv)
try {
    if (argc != 4 || !NAMED.count(argv[2]))
        throw std::runtime_error("sample glsl|hlsl layered-hexagon|layered-octagon|exact-hexagon|exact-octagon FOLDER");
    const VkApplicationInfo application = {
        VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, nullptr, 0, nullptr, 0, VK_API_VERSION_1_3};
    const VkInstanceCreateInfo wanted = {VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, nullptr, 0, &application};
    VkInstance instance;
    BokehDevice::check(vkCreateInstance(&wanted, nullptr, &instance));
    uint32_t one = 1;
    VkPhysicalDevice gpu;
    if (vkEnumeratePhysicalDevices(instance, &one, &gpu) < 0 || !one)
        throw std::runtime_error("no Vulkan device");
    VkPhysicalDeviceProperties known;
    vkGetPhysicalDeviceProperties(gpu, &known);
    std::cout << known.deviceName << std::endl;
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue = {VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, nullptr, 0, 0, 1, &priority};
    const VkPhysicalDeviceVulkan13Features features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                                       .synchronization2 = VK_TRUE, .dynamicRendering = VK_TRUE};
    const VkDeviceCreateInfo asked = {VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &features, 0, 1, &queue};
    VkDevice device;
    BokehDevice::check(vkCreateDevice(gpu, &asked, nullptr, &device));
    draw(gpu, device, argv[1] == std::string("hlsl"), argv[2], argv[3]);
    vkDestroyDevice(device, nullptr);
    vkDestroyInstance(instance, nullptr);
} catch (const std::exception &error) {
    std::cerr << error.what() << std::endl;
    return 1;
}
