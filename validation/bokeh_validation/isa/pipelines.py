"""A program by itself: pipelines made by the Vulkan driver that the environment chooses, and what it says of them.

It runs in other Pythons too (an unpacked system's, an emulated one's), so it needs the package `vulkan` and nothing
else of this project. Standard input: {"vertex": FILE, "fragments": [[NAME, FILE, TARGETS], ...]}, files of SPIR-V.
Standard output: {"version": "22.3.6", "pipelines": {NAME: [{STATISTIC: VALUE}, CODE]}}, the code as the driver writes
it. Nothing is ever drawn.
"""

import json
import sys

import vulkan as vk

EXTENSION = "VK_KHR_pipeline_executable_properties"
FRAGMENT = vk.VK_SHADER_STAGE_FRAGMENT_BIT
FORMAT = vk.VK_FORMAT_R16G16B16A16_SFLOAT
BINDINGS = 10  # the uniform block at 0, textures and samplers from 1 on
VALUES = ("b32", "i64", "u64", "f64")  # of VkPipelineExecutableStatisticValueKHR, in the order of its formats


def device():
    """(the driver's version, the first device that tells statistics, the instance that keeps it)."""
    application = vk.VkApplicationInfo(apiVersion=vk.VK_MAKE_VERSION(1, 1, 0))
    instance = vk.vkCreateInstance(vk.VkInstanceCreateInfo(pApplicationInfo=application), None)
    for physical in vk.vkEnumeratePhysicalDevices(instance):
        offered = vk.vkEnumerateDeviceExtensionProperties(physical, None)
        if EXTENSION in [extension.extensionName for extension in offered]:
            feature = vk.VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR(pipelineExecutableInfo=True)
            queue = vk.VkDeviceQueueCreateInfo(queueFamilyIndex=0, pQueuePriorities=[1.0])
            wanted = vk.VkDeviceCreateInfo(
                pNext=feature, pQueueCreateInfos=[queue], ppEnabledExtensionNames=[EXTENSION]
            )
            number = vk.vkGetPhysicalDeviceProperties(physical).driverVersion
            version = f"{number >> 22}.{number >> 12 & 1023}.{number & 4095}"
            return version, vk.vkCreateDevice(physical, wanted, None), instance
    sys.exit("no device that tells statistics")


def module(logical, file):
    """A shader module of a file."""
    with open(file, "rb") as stream:
        code = stream.read()
    return vk.vkCreateShaderModule(logical, vk.VkShaderModuleCreateInfo(codeSize=len(code), pCode=code), None)


def layout(logical):
    """What bokeh_passes.* binds, in the fragment shader."""
    kinds = [vk.VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER] + [vk.VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER] * (BINDINGS - 1)
    bindings = [
        vk.VkDescriptorSetLayoutBinding(binding=index, descriptorType=kind, descriptorCount=1, stageFlags=FRAGMENT)
        for index, kind in enumerate(kinds)
    ]
    of_set = vk.vkCreateDescriptorSetLayout(logical, vk.VkDescriptorSetLayoutCreateInfo(pBindings=bindings), None)
    return vk.vkCreatePipelineLayout(logical, vk.VkPipelineLayoutCreateInfo(pSetLayouts=[of_set]), None)


def render_pass(logical, targets):
    """A render pass of so many half-float targets."""
    attachment = vk.VkAttachmentDescription(
        format=FORMAT,
        samples=vk.VK_SAMPLE_COUNT_1_BIT,
        loadOp=vk.VK_ATTACHMENT_LOAD_OP_DONT_CARE,
        storeOp=vk.VK_ATTACHMENT_STORE_OP_STORE,
        stencilLoadOp=vk.VK_ATTACHMENT_LOAD_OP_DONT_CARE,
        stencilStoreOp=vk.VK_ATTACHMENT_STORE_OP_DONT_CARE,
        initialLayout=vk.VK_IMAGE_LAYOUT_UNDEFINED,
        finalLayout=vk.VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
    )
    colors = [
        vk.VkAttachmentReference(attachment=index, layout=vk.VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL)
        for index in range(targets)
    ]
    subpass = vk.VkSubpassDescription(
        pipelineBindPoint=vk.VK_PIPELINE_BIND_POINT_GRAPHICS, colorAttachmentCount=targets, pColorAttachments=colors
    )
    wanted = vk.VkRenderPassCreateInfo(pAttachments=[attachment] * targets, pSubpasses=[subpass])
    return vk.vkCreateRenderPass(logical, wanted, None)


def pipeline(logical, vertex, fragment, targets, of_pipeline):
    """A graphics pipeline of a full-screen triangle."""
    stages = [
        vk.VkPipelineShaderStageCreateInfo(stage=stage, module=code, pName="main")
        for stage, code in ((vk.VK_SHADER_STAGE_VERTEX_BIT, vertex), (FRAGMENT, fragment))
    ]
    area = vk.VkExtent2D(width=1920, height=1080)
    view = vk.VkViewport(x=0, y=0, width=1920, height=1080, minDepth=0, maxDepth=1)
    scissor = vk.VkRect2D(offset=vk.VkOffset2D(x=0, y=0), extent=area)
    wanted = vk.VkGraphicsPipelineCreateInfo(
        flags=vk.VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR
        | vk.VK_PIPELINE_CREATE_CAPTURE_INTERNAL_REPRESENTATIONS_BIT_KHR,
        pStages=stages,
        pVertexInputState=vk.VkPipelineVertexInputStateCreateInfo(),
        pInputAssemblyState=vk.VkPipelineInputAssemblyStateCreateInfo(topology=vk.VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST),
        pViewportState=vk.VkPipelineViewportStateCreateInfo(pViewports=[view], pScissors=[scissor]),
        pRasterizationState=vk.VkPipelineRasterizationStateCreateInfo(lineWidth=1.0),
        pMultisampleState=vk.VkPipelineMultisampleStateCreateInfo(rasterizationSamples=vk.VK_SAMPLE_COUNT_1_BIT),
        pColorBlendState=vk.VkPipelineColorBlendStateCreateInfo(
            pAttachments=[vk.VkPipelineColorBlendAttachmentState(colorWriteMask=15) for _ in range(targets)],
            blendConstants=[0.0] * 4,
        ),
        layout=of_pipeline,
        renderPass=render_pass(logical, targets),
        basePipelineIndex=-1,
    )
    return vk.vkCreateGraphicsPipelines(logical, None, 1, [wanted], None)[0]


def told(logical, made):
    """(statistic -> number, code) of the fragment stage."""
    executables = vk.vkGetDeviceProcAddr(logical, "vkGetPipelineExecutablePropertiesKHR")
    statistics = vk.vkGetDeviceProcAddr(logical, "vkGetPipelineExecutableStatisticsKHR")
    for index, one in enumerate(executables(logical, vk.VkPipelineInfoKHR(pipeline=made))):
        if one.stages & FRAGMENT:
            asked = vk.VkPipelineExecutableInfoKHR(pipeline=made, executableIndex=index)
            found = statistics(logical, asked)
            return {text(item.name): getattr(item.value, VALUES[item.format]) for item in found}, code(logical, asked)
    sys.exit("the driver tells nothing of the fragment stage")


def code(logical, asked):
    """The machine code as text: the last of the driver's representations, which the package's own call leaves out."""
    name, ffi = "vkGetPipelineExecutableInternalRepresentationsKHR", vk.ffi
    representations = ffi.cast("PFN_" + name, vk.lib.vkGetDeviceProcAddr(logical, name.encode()))
    asked, count = ffi.addressof(asked), ffi.new("uint32_t *")
    representations(logical, asked, count, ffi.NULL)
    found = ffi.new("VkPipelineExecutableInternalRepresentationKHR[]", count[0])
    for one in found:
        one.sType = vk.VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INTERNAL_REPRESENTATION_KHR
    # the first call tells the sizes, the second one fills the text in
    representations(logical, asked, count, found)
    last = found[count[0] - 1]
    last.pData = space = ffi.new("char[]", last.dataSize + 1)
    representations(logical, asked, count, found)
    return ffi.string(space).decode("utf-8", "replace")


def text(name):
    """A C string, whichever way the binding hands it out."""
    return name if isinstance(name, str) else vk.ffi.string(name).decode()


def main():
    """See above."""
    asked = json.load(sys.stdin)
    version, logical, _ = device()
    vertex, of_pipeline, found = module(logical, asked["vertex"]), layout(logical), {}
    for program, file, targets in asked["fragments"]:
        made = pipeline(logical, vertex, module(logical, file), targets, of_pipeline)
        found[program] = told(logical, made)
    json.dump({"version": version, "pipelines": found}, sys.stdout)


if __name__ == "__main__":
    main()
