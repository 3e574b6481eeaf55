// SPDX-License-Identifier: MIT
//
// Depth of field for a renderer on Vulkan 1.3 with the features dynamicRendering and synchronization2.
// Copy this file, frames.h, BokehParameters.h and the SPIR-V of the passes, which sample.cpp makes.
#pragma once
#include <vulkan/vulkan.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <stdexcept>

#include "../parameters/BokehParameters.h"
#include "frames.h"

struct BokehUse { // one side of a barrier
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 access;
    VkImageLayout layout;
};

// What is made on a device, for as long as this lives.
struct BokehDevice {
    const VkPhysicalDevice gpu;
    const VkDevice device;
    std::vector<std::function<void()>> undo = {};

    BokehDevice(VkPhysicalDevice gpu, VkDevice device) : gpu(gpu), device(device) {}
    BokehDevice(const BokehDevice &) = delete;
    ~BokehDevice()
    {
        for (; !undo.empty(); undo.pop_back())
            undo.back()();
    }

    static void check(VkResult result)
    {
        if (result != VK_SUCCESS)
            throw std::runtime_error("Vulkan returned " + std::to_string(result));
    }

    template <class Info, class Handle>
    Handle make(VkResult(VKAPI_PTR *create)(VkDevice, const Info *, const VkAllocationCallbacks *, Handle *),
                void(VKAPI_PTR *destroy)(VkDevice, Handle, const VkAllocationCallbacks *),
                const std::type_identity_t<Info> &info)
    {
        Handle made;
        check(create(device, &info, nullptr, &made));
        undo.push_back([=, this] { destroy(device, made, nullptr); });
        return made;
    }

    VkDeviceMemory allocate(const VkMemoryRequirements &needs, VkMemoryPropertyFlags wanted)
    {
        VkPhysicalDeviceMemoryProperties known;
        vkGetPhysicalDeviceMemoryProperties(gpu, &known);
        uint32_t i = 0;
        while (!(needs.memoryTypeBits >> i & 1) || (known.memoryTypes[i].propertyFlags & wanted) != wanted)
            if (++i == known.memoryTypeCount)
                throw std::runtime_error("no memory of the type that is needed");
        return make(vkAllocateMemory, vkFreeMemory, {VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needs.size, i});
    }

    // A buffer that the processor writes or reads at `mapped`.
    VkBuffer make_buffer(VkDeviceSize size, VkBufferUsageFlags usage, char *&mapped)
    {
        const VkBuffer buffer =
            make(vkCreateBuffer, vkDestroyBuffer, {VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, nullptr, 0, size, usage});
        VkMemoryRequirements needs;
        vkGetBufferMemoryRequirements(device, buffer, &needs);
        const VkDeviceMemory memory = allocate(needs, VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
        check(vkBindBufferMemory(device, buffer, memory, 0));
        check(vkMapMemory(device, memory, 0, VK_WHOLE_SIZE, 0, (void **)&mapped));
        return buffer;
    }

    VkImage make_image(VkFormat format, VkExtent2D size, VkImageUsageFlags usage)
    {
        return make(vkCreateImage, vkDestroyImage, {VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, nullptr, 0, VK_IMAGE_TYPE_2D,
                    format, {size.width, size.height, 1}, 1, 1, VK_SAMPLE_COUNT_1_BIT, VK_IMAGE_TILING_OPTIMAL, usage});
    }

    VkImageView make_view(VkImage image, VkFormat format, VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT)
    {
        return make(vkCreateImageView, vkDestroyImageView, {VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO, nullptr, 0, image,
                    VK_IMAGE_VIEW_TYPE_2D, format, {}, {aspect, 0, 1, 0, 1}});
    }

    // Memory for images of which only one is in use at a time.
    void share_memory(const std::vector<VkImage> &images)
    {
        VkMemoryRequirements needs = {0, 0, ~0u}, own;
        for (VkImage image : images) {
            vkGetImageMemoryRequirements(device, image, &own);
            needs.size = std::max(needs.size, own.size);
            needs.memoryTypeBits &= own.memoryTypeBits;
        }
        const VkDeviceMemory memory = allocate(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
        for (VkImage image : images)
            check(vkBindImageMemory(device, image, memory, 0));
    }

    static void barrier(VkCommandBuffer commands, VkImage image, const BokehUse &from, const BokehUse &to,
                        VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT)
    {
        const VkImageMemoryBarrier2 one = {VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2, nullptr, from.stages, from.access,
                                           to.stages, to.access, from.layout, to.layout, VK_QUEUE_FAMILY_IGNORED,
                                           VK_QUEUE_FAMILY_IGNORED, image, {aspect, 0, 1, 0, 1}};
        const VkDependencyInfo all = {VK_STRUCTURE_TYPE_DEPENDENCY_INFO, nullptr, 0, 0, nullptr, 0, nullptr, 1, &one};
        vkCmdPipelineBarrier2(commands, &all);
    }
};

struct PolygonBokeh : BokehDevice {
    static constexpr uint32_t FRAMES = 2; // that the device may be at work on
    static constexpr VkFormat FORMAT = VK_FORMAT_R16G16B16A16_SFLOAT;
    static constexpr BokehUse READ = {VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                                      VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    static constexpr BokehUse WRITE = {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                                       VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
                                       VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};

    // docs/reference/parameters.md. Change them at any time: record() copies them.
    BokehParameters parameters = {
        .ApertureDiameter = 0.05f, .FocalLength = 0.05f, .FocusDistance = 5.0f, .SensorHeight = 0.024f,
        .MaxCoC = 0.1f, .BleedingBias = 0.02f, .BleedingMult = 30.0f, .Squeeze = 1.0f,
        .DepthKind = 1.0f, .Near = 0.1f, .Far = 1000.0f}; // 1: 0 at the near plane, 1 at the far plane

    struct Target {
        VkImage image;
        VkImageView view;
        VkExtent2D size;
    };
    std::map<std::string, Target> targets; // by the names in frames.h

    // frame         one of frames.h, which must stay; folder: of ENTRY.spv
    // color, depth  of `size`, one sample a pixel, one aspect: linear HDR, the depth buffer
    PolygonBokeh(VkPhysicalDevice gpu, VkDevice device, const std::vector<BokehPass> &frame, const std::string &folder,
                 VkExtent2D size, VkImageView color, VkImageView depth)
        : BokehDevice(gpu, device), frame(frame)
    {
        parameters.AspectRatio = (float)size.width / size.height;
        parameters.ImageWidth = (float)size.width;
        parameters.ImageHeight = (float)size.height;
        blocks = make_buffer(BLOCK * 2 * FRAMES, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, mapped);
        make_targets(size);
        make_sets(color, depth);
        const VkShaderModule vertex = load(folder, "BokehFullScreen");
        for (const BokehPass &pass : frame)
            make_pipeline(pass, vertex, load(folder, pass.entry));
    }

    // The effect, outside of a rendering; number: of the frame, 0, 1 .. Before it, what writes colour and depth has
    // been waited for, and they are as READ says; after it, "result" is.
    void record(VkCommandBuffer commands, uint32_t number)
    {
        for (size_t i = 0; i < frame.size(); i++)
            record_pass(commands, number, i);
    }

    void record_pass(VkCommandBuffer commands, uint32_t number, size_t index)
    {
        std::vector<VkRenderingAttachmentInfo> attachments;
        VkRect2D area = {};
        for (const std::string &name : frame[index].writes) {
            // What was in this memory, of another target too, has been read, and nothing of it is kept
            const BokehUse before = {WRITE.stages | READ.stages, WRITE.access, VK_IMAGE_LAYOUT_UNDEFINED};
            barrier(commands, targets[name].image, before, WRITE);
            attachments.push_back({.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO, .imageView = targets[name].view,
                                   .imageLayout = WRITE.layout, .loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                   .storeOp = VK_ATTACHMENT_STORE_OP_STORE});
            area.extent = targets[name].size;
        }
        // The device reads the parameters later, so that a pass cannot change them: a frame has two copies
        const uint32_t offset = uint32_t(BLOCK * (number % FRAMES * 2 + frame[index].copy));
        BokehParameters values = parameters;
        values.Axis = values.Layer = (float)frame[index].copy;
        values.Sides = (float)frame[index].sides;
        memcpy(mapped + offset, &values, sizeof values);
        const VkRenderingInfo rendering = {VK_STRUCTURE_TYPE_RENDERING_INFO, nullptr, 0, area, 1, 0,
                                           (uint32_t)attachments.size(), attachments.data(), nullptr, nullptr};
        vkCmdBeginRendering(commands, &rendering);
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines[index]);
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 0, 1, &sets[index], 1, &offset);
        vkCmdDraw(commands, 3, 1, 0, 0); // BokehFullScreen makes its vertices
        vkCmdEndRendering(commands);
        for (const std::string &name : frame[index].writes)
            barrier(commands, targets[name].image, WRITE, READ);
    }

private:
    static constexpr VkDeviceSize BLOCK = 256; // no device wants uniform blocks further apart
    // Bindings of set 0: parameters, BokehColorSamp and B to F, BokehDepthSamp, HLSL's sampler
    static constexpr uint32_t PARAMETERS = 0, COLORS[] = {1, 3, 4, 5, 8, 9}, DEPTH = 2, SAMPLER = 7;
    const std::vector<BokehPass> &frame;
    VkPipelineLayout layout;
    VkBuffer blocks;
    char *mapped;
    std::vector<VkDescriptorSet> sets; // of each pass
    std::vector<VkPipeline> pipelines;

    void make_targets(VkExtent2D size)
    {
        const VkImageUsageFlags usage =
            VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
        std::map<int, std::vector<VkImage>> shared;
        for (const BokehPass &pass : frame)
            for (size_t i = 0; i < pass.writes.size(); i++) {
                Target &target = targets[pass.writes[i]];
                target.size = {(size.width + pass.scale - 1) / pass.scale, (size.height + pass.scale - 1) / pass.scale};
                target.image = make_image(FORMAT, target.size, usage);
                shared[pass.memory[i]].push_back(target.image);
            }
        for (const auto &[number, images] : shared)
            share_memory(images);
        for (auto &[name, target] : targets)
            target.view = make_view(target.image, FORMAT);
    }

    VkSampler make_sampler(VkFilter filter)
    {
        const VkSamplerAddressMode clamp = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
        return make(vkCreateSampler, vkDestroySampler, {VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO, nullptr, 0, filter,
                    filter, VK_SAMPLER_MIPMAP_MODE_NEAREST, clamp, clamp, clamp});
    }

    // A set for each pass; what a pass does not read is left unwritten. GLSL's textures are combined with their
    // sampler, and HLSL's may be in the same descriptors.
    void make_sets(VkImageView color, VkImageView depth)
    {
        const VkDescriptorType block = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC;
        const VkDescriptorType texture = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, alone = VK_DESCRIPTOR_TYPE_SAMPLER;
        const VkShaderStageFlags stage = VK_SHADER_STAGE_FRAGMENT_BIT;
        const VkSampler linear = make_sampler(VK_FILTER_LINEAR), nearest = make_sampler(VK_FILTER_NEAREST);
        const uint32_t count = (uint32_t)frame.size();
        std::vector<VkDescriptorSetLayoutBinding> bindings = {
            {PARAMETERS, block, 1, stage}, {DEPTH, texture, 1, stage, &nearest}, {SAMPLER, alone, 1, stage, &linear}};
        for (uint32_t binding : COLORS)
            bindings.push_back({binding, texture, 1, stage, &linear});
        const VkDescriptorSetLayout set = make(vkCreateDescriptorSetLayout, vkDestroyDescriptorSetLayout,
            {VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, nullptr, 0, 9, bindings.data()});
        layout = make(vkCreatePipelineLayout, vkDestroyPipelineLayout,
                      {VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, nullptr, 0, 1, &set});
        const VkDescriptorPoolSize sizes[] = {{block, count}, {alone, count}, {texture, count * 7}};
        const VkDescriptorPool pool = make(vkCreateDescriptorPool, vkDestroyDescriptorPool,
            {VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, nullptr, 0, count, 3, sizes});
        const VkDescriptorSetAllocateInfo asked = {
            VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO, nullptr, pool, 1, &set};
        sets.resize(count);
        for (uint32_t i = 0; i < count; i++) {
            check(vkAllocateDescriptorSets(device, &asked, &sets[i]));
            const auto bind = [&](uint32_t binding, VkDescriptorType type, VkImageView view) {
                const VkDescriptorBufferInfo buffer = {blocks, 0, sizeof(BokehParameters)};
                const VkDescriptorImageInfo image = {VK_NULL_HANDLE, view, READ.layout};
                const VkWriteDescriptorSet write = {
                    VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, nullptr, sets[i], binding, 0, 1, type, &image, &buffer};
                vkUpdateDescriptorSets(device, 1, &write, 0, nullptr);
            };
            bind(PARAMETERS, block, VK_NULL_HANDLE);
            bind(DEPTH, texture, depth);
            const std::vector<std::string> &names = frame[i].reads;
            for (size_t k = 0; k < names.size(); k++)
                if (names[k] != "-")
                    bind(COLORS[k], texture, names[k] == "color" ? color : targets.at(names[k]).view);
        }
    }

    VkShaderModule load(const std::string &folder, const std::string &entry)
    {
        std::ifstream file(folder + "/" + entry + ".spv", std::ios::binary);
        const std::string code((std::istreambuf_iterator<char>(file)), {});
        if (code.empty())
            throw std::runtime_error(folder + " has no " + entry + ".spv");
        return make(vkCreateShaderModule, vkDestroyShaderModule,
            {VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, nullptr, 0, code.size(), (const uint32_t *)code.data()});
    }

    // No vertex buffer, depth test, culling or blending: alpha is data.
    void make_pipeline(const BokehPass &pass, VkShaderModule vertex, VkShaderModule fragment)
    {
        const uint32_t count = (uint32_t)pass.writes.size();
        const std::string entry = pass.entry + "_PS";
        const VkRect2D area = {{0, 0}, targets[pass.writes[0]].size};
        const VkViewport whole = {0, 0, (float)area.extent.width, (float)area.extent.height, 0, 1};
        const VkStructureType stage = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
        const VkPipelineShaderStageCreateInfo stages[] = {
            {stage, nullptr, 0, VK_SHADER_STAGE_VERTEX_BIT, vertex, "BokehFullScreen_VS"},
            {stage, nullptr, 0, VK_SHADER_STAGE_FRAGMENT_BIT, fragment, entry.c_str()}};
        const VkPipelineVertexInputStateCreateInfo input = {VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
        const VkPipelineInputAssemblyStateCreateInfo assembly = {
            .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
            .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
        const VkPipelineViewportStateCreateInfo viewport = {
            VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, nullptr, 0, 1, &whole, 1, &area};
        const VkPipelineRasterizationStateCreateInfo rasterization = {
            .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO, .lineWidth = 1};
        const VkPipelineMultisampleStateCreateInfo samples = {
            VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO, nullptr, 0, VK_SAMPLE_COUNT_1_BIT};
        const std::vector<VkPipelineColorBlendAttachmentState> off(count, {.colorWriteMask = 15});
        const VkPipelineColorBlendStateCreateInfo blend = {VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                           nullptr, 0, VK_FALSE, VK_LOGIC_OP_COPY, count, off.data()};
        const std::vector<VkFormat> formats(count, FORMAT);
        const VkPipelineRenderingCreateInfo rendering = {
            VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO, nullptr, 0, count, formats.data()};
        const VkGraphicsPipelineCreateInfo wanted = {
            VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, &rendering, 0, 2, stages, &input, &assembly, nullptr,
            &viewport, &rasterization, &samples, nullptr, &blend, nullptr, layout};
        VkPipeline made;
        check(vkCreateGraphicsPipelines(device, VK_NULL_HANDLE, 1, &wanted, nullptr, &made));
        undo.push_back([=, this] { vkDestroyPipeline(device, made, nullptr); });
        pipelines.push_back(made);
    }
};
