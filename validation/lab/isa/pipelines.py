"""Create pipelines with the Vulkan driver that the environment selects, and print the driver's statistics.

This is a separate program that needs only the package `vulkan`. Standard input: {"bindings": {NUMBER: KIND}, "vertex":
[FILE, ENTRY], "fragments": [[NAME, FILE, ENTRY, TARGETS], ...]}, with files of SPIR-V. Standard output: {"version":
"22.3.6", "pipelines": {NAME: {STATISTIC: VALUE}}}. Nothing is drawn.
"""

import json
import sys

import vulkan as vk

EXTENSION = "VK_KHR_pipeline_executable_properties"
FRAGMENT = vk.VK_SHADER_STAGE_FRAGMENT_BIT
FORMAT = vk.VK_FORMAT_R16G16B16A16_SFLOAT
KINDS = {
    "uniform": vk.VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
    "combined": vk.VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
    "texture": vk.VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE,
    "sampler": vk.VK_DESCRIPTOR_TYPE_SAMPLER,
}
VALUES = ("b32", "i64", "u64", "f64")  # members of VkPipelineExecutableStatisticValueKHR, in the order of its formats


def device():
    """Return (version of the driver, first device that gives statistics, its instance, which must stay alive)."""
    application = vk.VkApplicationInfo(apiVersion=vk.VK_MAKE_VERSION(1, 3, 0))
    instance = vk.vkCreateInstance(vk.VkInstanceCreateInfo(pApplicationInfo=application), None)
    for physical in vk.vkEnumeratePhysicalDevices(instance):
        offered = vk.vkEnumerateDeviceExtensionProperties(physical, None)
        if EXTENSION in [extension.extensionName for extension in offered]:
            rendering = vk.VkPhysicalDeviceDynamicRenderingFeatures(dynamicRendering=True)
            feature = vk.VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR(
                pNext=rendering, pipelineExecutableInfo=True
            )
            queue = vk.VkDeviceQueueCreateInfo(queueFamilyIndex=0, pQueuePriorities=[1.0])
            info = vk.VkDeviceCreateInfo(pNext=feature, pQueueCreateInfos=[queue], ppEnabledExtensionNames=[EXTENSION])
            number = vk.vkGetPhysicalDeviceProperties(physical).driverVersion
            version = f"{number >> 22}.{number >> 12 & 1023}.{number & 4095}"
            return version, vk.vkCreateDevice(physical, info, None), instance
    sys.exit("no device that gives statistics")


def module(logical, file):
    """Create a shader module from a file."""
    with open(file, "rb") as stream:
        code = stream.read()
    return vk.vkCreateShaderModule(logical, vk.VkShaderModuleCreateInfo(codeSize=len(code), pCode=code), None)


def layout(logical, kinds):
    """Create the layout of what bokeh_passes.* binds in the fragment shader; kinds: binding -> one of KINDS."""
    bindings = [
        vk.VkDescriptorSetLayoutBinding(
            binding=int(number), descriptorType=KINDS[kind], descriptorCount=1, stageFlags=FRAGMENT
        )
        for number, kind in kinds.items()
    ]
    of_set = vk.vkCreateDescriptorSetLayout(logical, vk.VkDescriptorSetLayoutCreateInfo(pBindings=bindings), None)
    return vk.vkCreatePipelineLayout(logical, vk.VkPipelineLayoutCreateInfo(pSetLayouts=[of_set]), None)


def pipeline(logical, vertex, fragment, targets, of_pipeline):
    """Create a graphics pipeline that draws a full-screen triangle to half-float targets; a stage is (module, entry
    point).
    """
    stages = [
        vk.VkPipelineShaderStageCreateInfo(stage=stage, module=code, pName=entry)
        for stage, (code, entry) in ((vk.VK_SHADER_STAGE_VERTEX_BIT, vertex), (FRAGMENT, fragment))
    ]
    info = vk.VkGraphicsPipelineCreateInfo(
        pNext=vk.VkPipelineRenderingCreateInfo(
            colorAttachmentCount=targets, pColorAttachmentFormats=[FORMAT] * targets
        ),
        flags=vk.VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR,
        pStages=stages,
        pVertexInputState=vk.VkPipelineVertexInputStateCreateInfo(),
        pInputAssemblyState=vk.VkPipelineInputAssemblyStateCreateInfo(topology=vk.VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST),
        pViewportState=vk.VkPipelineViewportStateCreateInfo(viewportCount=1, scissorCount=1),
        pDynamicState=vk.VkPipelineDynamicStateCreateInfo(
            pDynamicStates=[vk.VK_DYNAMIC_STATE_VIEWPORT, vk.VK_DYNAMIC_STATE_SCISSOR]
        ),
        pRasterizationState=vk.VkPipelineRasterizationStateCreateInfo(lineWidth=1.0),
        pMultisampleState=vk.VkPipelineMultisampleStateCreateInfo(rasterizationSamples=vk.VK_SAMPLE_COUNT_1_BIT),
        pColorBlendState=vk.VkPipelineColorBlendStateCreateInfo(
            pAttachments=[vk.VkPipelineColorBlendAttachmentState(colorWriteMask=15) for _ in range(targets)],
            blendConstants=[0.0] * 4,
        ),
        layout=of_pipeline,
        basePipelineIndex=-1,
    )
    return vk.vkCreateGraphicsPipelines(logical, None, 1, [info], None)[0]


def counted(logical, compiled):
    """Return {statistic: number} of the fragment stage of a pipeline."""
    executables = vk.vkGetDeviceProcAddr(logical, "vkGetPipelineExecutablePropertiesKHR")
    statistics = vk.vkGetDeviceProcAddr(logical, "vkGetPipelineExecutableStatisticsKHR")
    for index, executable in enumerate(executables(logical, vk.VkPipelineInfoKHR(pipeline=compiled))):
        if executable.stages & FRAGMENT:
            asked = vk.VkPipelineExecutableInfoKHR(pipeline=compiled, executableIndex=index)
            return {text(item.name): getattr(item.value, VALUES[item.format]) for item in statistics(logical, asked)}
    sys.exit("the driver says nothing of the fragment stage")


def text(name):
    """Return a C string as str, in whichever form the binding returns it."""
    return name if isinstance(name, str) else vk.ffi.string(name).decode()


def main():
    """Read the request from standard input and print the statistics; see the top of this file."""
    asked = json.load(sys.stdin)
    version, logical, _ = device()
    file, entry = asked["vertex"]
    vertex, of_pipeline, pipelines = (module(logical, file), entry), layout(logical, asked["bindings"]), {}
    for program, file, entry, targets in asked["fragments"]:
        compiled = pipeline(logical, vertex, (module(logical, file), entry), targets, of_pipeline)
        pipelines[program] = counted(logical, compiled)
    json.dump({"version": version, "pipelines": pipelines}, sys.stdout)


if __name__ == "__main__":
    main()
