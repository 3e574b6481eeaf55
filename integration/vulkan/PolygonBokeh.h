// SPDX-License-Identifier: MIT
//
// Adds depth of field to a renderer that uses Vulkan 1.3 with the features dynamicRendering and synchronization2.
// Copy this file, frames.h, BokehParameters.h, and the SPIR-V of the passes, which sample.cpp compiles.
#pragma once
#include <vulkan/vulkan.hpp>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>

#include "../parameters/BokehParameters.h"
#include "frames.h"

struct BokehUse { // one side of a barrier
    vk::PipelineStageFlags2 stages;
    vk::AccessFlags2 access;
    vk::ImageLayout layout;
};

// Creates images and buffers on a device, and owns them: they live as long as this object.
struct BokehDevice {
    const vk::PhysicalDevice gpu;
    const vk::Device device;
    std::vector<vk::UniqueDeviceMemory> memories = {};
    std::vector<vk::UniqueBuffer> buffers = {};
    std::vector<vk::UniqueImage> images = {};
    std::vector<vk::UniqueImageView> views = {};

    vk::DeviceMemory allocate(const vk::MemoryRequirements &needs, vk::MemoryPropertyFlags wanted)
    {
        const auto known = gpu.getMemoryProperties();
        uint32_t i = 0;
        while (!(needs.memoryTypeBits >> i & 1) || (known.memoryTypes.at(i).propertyFlags & wanted) != wanted)
            i++;
        return *memories.emplace_back(device.allocateMemoryUnique({needs.size, i}));
    }

    // Creates a buffer that the CPU can write and read, and sets `mapped` to its address.
    vk::Buffer make_buffer(vk::DeviceSize size, vk::BufferUsageFlags usage, char *&mapped)
    {
        const vk::Buffer buffer = *buffers.emplace_back(device.createBufferUnique({{}, size, usage}));
        const vk::DeviceMemory memory = allocate(device.getBufferMemoryRequirements(buffer),
                                                 vk::MemoryPropertyFlagBits::eHostCoherent);
        device.bindBufferMemory(buffer, memory, 0);
        mapped = (char *)device.mapMemory(memory, 0, size);
        return buffer;
    }

    vk::Image make_image(vk::Format format, vk::Extent2D size, vk::ImageUsageFlags usage)
    {
        const vk::Extent3D whole(size, 1);
        return *images.emplace_back(device.createImageUnique(
            {{}, vk::ImageType::e2D, format, whole, 1, 1, vk::SampleCountFlagBits::e1, {}, usage}));
    }

    vk::ImageView make_view(vk::Image image, vk::Format format, vk::ImageAspectFlags aspect)
    {
        return *views.emplace_back(
            device.createImageViewUnique({{}, image, vk::ImageViewType::e2D, format, {}, {aspect, 0, 1, 0, 1}}));
    }

    // Allocates one block of memory for several images. Only one of them may be in use at a time.
    void share_memory(const std::vector<vk::Image> &sharing)
    {
        vk::MemoryRequirements needs(0, 0, ~0u);
        for (vk::Image image : sharing) {
            const vk::MemoryRequirements own = device.getImageMemoryRequirements(image);
            needs.size = std::max(needs.size, own.size);
            needs.memoryTypeBits &= own.memoryTypeBits;
        }
        const vk::DeviceMemory memory = allocate(needs, vk::MemoryPropertyFlagBits::eDeviceLocal);
        for (vk::Image image : sharing)
            device.bindImageMemory(image, memory, 0);
    }

    static std::string read(const std::string &path)
    {
        std::ifstream file(path, std::ios::binary);
        const std::string bytes((std::istreambuf_iterator<char>(file)), {});
        if (bytes.empty())
            throw std::runtime_error("cannot read " + path);
        return bytes;
    }

    static void barrier(vk::CommandBuffer commands, vk::Image image, const BokehUse &from, const BokehUse &to,
                        vk::ImageAspectFlags aspect = vk::ImageAspectFlagBits::eColor)
    {
        const uint32_t same = VK_QUEUE_FAMILY_IGNORED;
        const vk::ImageMemoryBarrier2 one(from.stages, from.access, to.stages, to.access, from.layout, to.layout, same,
                                          same, image, {aspect, 0, 1, 0, 1});
        commands.pipelineBarrier2({{}, {}, {}, one});
    }
};

struct PolygonBokeh : BokehDevice {
    static constexpr uint32_t FRAMES = 2; // maximum number of frames in flight
    static constexpr vk::Format FORMAT = vk::Format::eR16G16B16A16Sfloat;
    using Stage = vk::PipelineStageFlagBits2;
    using Access = vk::AccessFlagBits2;
    static constexpr BokehUse READ = {Stage::eFragmentShader, Access::eShaderSampledRead,
                                      vk::ImageLayout::eShaderReadOnlyOptimal};
    static constexpr BokehUse WRITE = {Stage::eColorAttachmentOutput, Access::eColorAttachmentWrite,
                                       vk::ImageLayout::eColorAttachmentOptimal};

    // docs/reference/parameters.md describes the parameters. You may change them at any time: record() copies them.
    BokehParameters parameters = {
        .ApertureDiameter = 0.179f, .FocalLength = 0.05f, .FocusDistance = 5.0f, .SensorHeight = 0.024f,
        .MaxCoC = 0.1f, .BleedingBias = 0.02f, .BleedingMult = 30.0f, .Squeeze = 1.0f,
        .DepthKind = 1.0f, .Near = 0.1f, .Far = 1000.0f}; // DepthKind 1: 0 at the near plane, 1 at the far plane

    struct Target {
        vk::Image image;
        vk::ImageView view;
        vk::Extent2D size;
    };
    std::map<std::string, Target> targets; // by their names in frames.h

    // Creates the targets, the descriptor sets and the pipelines. Throws std::runtime_error if it cannot read the
    // SPIR-V.
    //
    // frame   a table of frames.h, which must outlive this object
    // folder  contains the SPIR-V: ENTRY.spv for the entry of each pass, and BokehFullScreen.spv
    // size    of the image, pixels
    // color   view of linear HDR colour of this size, one sample per pixel
    // depth   view of the depth aspect of a depth buffer of this size, one sample per pixel
    PolygonBokeh(vk::PhysicalDevice gpu, vk::Device device, const std::vector<BokehPass> &frame,
                 const std::string &folder, vk::Extent2D size, vk::ImageView color, vk::ImageView depth)
        : BokehDevice{gpu, device}, frame(frame)
    {
        parameters.AspectRatio = (float)size.width / size.height;
        parameters.ImageWidth = (float)size.width;
        parameters.ImageHeight = (float)size.height;
        blocks = make_buffer(BLOCK * FRAMES, vk::BufferUsageFlagBits::eUniformBuffer, mapped);
        make_targets(size);
        make_sets(color, depth);
        const vk::UniqueShaderModule vertex = load(folder, "BokehFullScreen");
        for (const BokehPass &pass : frame)
            make_pipeline(pass, *vertex, *load(folder, pass.entry));
    }

    // Records all passes. Do not call it between vkCmdBeginRendering and vkCmdEndRendering.
    //
    // number  of the frame: a counter that goes up by one per frame
    //
    // Record a barrier of your own before the call: it must make colour and depth readable in the stage, access and
    // layout of READ. After the call, targets["result"] is readable in the same way.
    void record(vk::CommandBuffer commands, uint32_t number)
    {
        BokehParameters values = parameters;
        values.Sides = (float)frame.front().sides;
        memcpy(mapped + offset(number), &values, sizeof values);
        for (size_t i = 0; i < frame.size(); i++)
            record_pass(commands, number, i);
    }

    // Records one pass with the parameters that record() copied for this number of a frame
    void record_pass(vk::CommandBuffer commands, uint32_t number, size_t index)
    {
        std::vector<vk::RenderingAttachmentInfo> attachments;
        vk::Rect2D area;
        for (const std::string &name : frame[index].writes) {
            // Wait until earlier passes have finished with this memory, which may be shared with other targets, and
            // discard its contents
            const BokehUse before = {WRITE.stages | READ.stages, WRITE.access, vk::ImageLayout::eUndefined};
            barrier(commands, targets[name].image, before, WRITE);
            attachments.emplace_back(targets[name].view, WRITE.layout).setLoadOp(vk::AttachmentLoadOp::eDontCare);
            area.extent = targets[name].size;
        }
        commands.beginRendering({{}, area, 1, 0, attachments});
        commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *pipelines[index]);
        commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, *layout, 0, sets[index],
                                    offset(number));
        commands.draw(3, 1, 0, 0); // BokehFullScreen makes the vertices
        commands.endRendering();
        for (const std::string &name : frame[index].writes)
            barrier(commands, targets[name].image, WRITE, READ);
    }

private:
    static constexpr vk::DeviceSize BLOCK = 256; // bytes between two frames; no device may require a larger alignment
    // Bindings of descriptor set 0: the parameters, BokehColorSamp and BokehColorSampB to F, BokehDepthSamp, and the
    // sampler of HLSL
    static constexpr uint32_t PARAMETERS = 0, COLORS[] = {1, 3, 4, 5, 8, 9}, DEPTH = 2, SAMPLER = 7;
    const std::vector<BokehPass> &frame;
    vk::UniqueSampler linear, nearest;
    vk::UniqueDescriptorSetLayout set_layout;
    vk::UniquePipelineLayout layout;
    vk::Buffer blocks;
    char *mapped;
    vk::UniqueDescriptorPool pool;
    std::vector<vk::DescriptorSet> sets; // one for each pass
    std::vector<vk::UniquePipeline> pipelines;

    // The device reads the parameters only when it executes the commands, so each frame in flight has its own copy
    static uint32_t offset(uint32_t number) { return uint32_t(BLOCK * (number % FRAMES)); }

    void make_targets(vk::Extent2D size)
    {
        using Usage = vk::ImageUsageFlagBits;
        std::map<int, std::vector<vk::Image>> shared;
        for (const BokehPass &pass : frame)
            for (size_t i = 0; i < pass.writes.size(); i++) {
                Target &target = targets[pass.writes[i]];
                target.size = vk::Extent2D((size.width + pass.scale - 1) / pass.scale,
                                           (size.height + pass.scale - 1) / pass.scale);
                target.image = make_image(FORMAT, target.size,
                                          Usage::eColorAttachment | Usage::eSampled | Usage::eTransferSrc);
                shared[pass.memory[i]].push_back(target.image);
            }
        for (const auto &[number, sharing] : shared)
            share_memory(sharing);
        for (auto &[name, target] : targets)
            target.view = make_view(target.image, FORMAT, vk::ImageAspectFlagBits::eColor);
    }

    // Creates a descriptor set for each pass. A texture that the pass does not read gets no descriptor; only depth is
    // always bound. The descriptors of textures are combined image samplers, as GLSL needs them, and shaders from HLSL
    // can read textures from them too.
    void make_sets(vk::ImageView color, vk::ImageView depth)
    {
        const auto block = vk::DescriptorType::eUniformBufferDynamic, alone = vk::DescriptorType::eSampler;
        const auto texture = vk::DescriptorType::eCombinedImageSampler;
        const auto stage = vk::ShaderStageFlagBits::eFragment;
        const auto clamp = vk::SamplerAddressMode::eClampToEdge;
        const uint32_t count = (uint32_t)frame.size();
        nearest = device.createSamplerUnique({{}, vk::Filter::eNearest, vk::Filter::eNearest, {}, clamp, clamp, clamp});
        linear = device.createSamplerUnique({{}, vk::Filter::eLinear, vk::Filter::eLinear, {}, clamp, clamp, clamp});
        std::vector<vk::DescriptorSetLayoutBinding> bindings = {
            {PARAMETERS, block, 1, stage}, {DEPTH, texture, 1, stage, &*nearest}, {SAMPLER, alone, 1, stage, &*linear}};
        for (uint32_t binding : COLORS)
            bindings.emplace_back(binding, texture, 1, stage, &*linear);
        set_layout = device.createDescriptorSetLayoutUnique({{}, bindings});
        layout = device.createPipelineLayoutUnique({{}, *set_layout});
        const vk::DescriptorPoolSize sizes[] = {{block, count}, {alone, count}, {texture, count * 7}};
        pool = device.createDescriptorPoolUnique({{}, count, sizes});
        const std::vector<vk::DescriptorSetLayout> layouts(count, *set_layout);
        sets = device.allocateDescriptorSets({*pool, layouts});
        const vk::DescriptorBufferInfo buffer(blocks, 0, sizeof(BokehParameters));
        for (uint32_t i = 0; i < count; i++) {
            const auto bind = [&](uint32_t binding, vk::DescriptorType type, vk::ImageView view) {
                const vk::DescriptorImageInfo image({}, view, READ.layout);
                device.updateDescriptorSets(vk::WriteDescriptorSet(sets[i], binding, 0, 1, type, &image, &buffer), {});
            };
            bind(PARAMETERS, block, {});
            bind(DEPTH, texture, depth);
            const std::vector<std::string> &names = frame[i].reads;
            for (size_t k = 0; k < names.size(); k++)
                if (names[k] != "-")
                    bind(COLORS[k], texture, names[k] == "color" ? color : targets.at(names[k]).view);
        }
    }

    vk::UniqueShaderModule load(const std::string &folder, const std::string &entry)
    {
        const std::string code = read(folder + "/" + entry + ".spv");
        return device.createShaderModuleUnique({{}, code.size(), (const uint32_t *)code.data()});
    }

    // Creates the pipeline of a pass. It has no vertex buffer, depth test or culling. It has no blending either,
    // because alpha is data.
    void make_pipeline(const BokehPass &pass, vk::ShaderModule vertex, vk::ShaderModule fragment)
    {
        const std::string entry = pass.entry + "_PS";
        const vk::Rect2D area({}, targets[pass.writes[0]].size);
        const vk::Viewport whole(0, 0, (float)area.extent.width, (float)area.extent.height, 0, 1);
        // If the number of sides is a constant, compilers can unroll the loops of the last pass
        const vk::SpecializationMapEntry sides(0, 0, sizeof pass.sides);
        const vk::SpecializationInfo constants(1, &sides, sizeof pass.sides, &pass.sides);
        const vk::PipelineShaderStageCreateInfo stages[] = {
            {{}, vk::ShaderStageFlagBits::eVertex, vertex, "BokehFullScreen_VS"},
            {{}, vk::ShaderStageFlagBits::eFragment, fragment, entry.c_str(), &constants}};
        const vk::PipelineVertexInputStateCreateInfo input;
        const vk::PipelineInputAssemblyStateCreateInfo assembly({}, vk::PrimitiveTopology::eTriangleList);
        const vk::PipelineViewportStateCreateInfo viewport({}, whole, area);
        const auto rasterization = vk::PipelineRasterizationStateCreateInfo().setLineWidth(1);
        const vk::PipelineMultisampleStateCreateInfo samples;
        const std::vector<vk::PipelineColorBlendAttachmentState> off(
            pass.writes.size(), vk::PipelineColorBlendAttachmentState().setColorWriteMask(vk::ColorComponentFlags(15)));
        const vk::PipelineColorBlendStateCreateInfo blend({}, false, vk::LogicOp::eCopy, off);
        const std::vector<vk::Format> formats(pass.writes.size(), FORMAT);
        const vk::PipelineRenderingCreateInfo rendering(0, formats);
        pipelines.push_back(device.createGraphicsPipelineUnique({}, vk::GraphicsPipelineCreateInfo(
            {}, stages, &input, &assembly, nullptr, &viewport, &rasterization, &samples, nullptr, &blend, nullptr,
            *layout).setPNext(&rendering)).value);
    }
};
