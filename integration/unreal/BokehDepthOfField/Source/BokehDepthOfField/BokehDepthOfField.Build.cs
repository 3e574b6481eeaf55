// SPDX-License-Identifier: MIT

using UnrealBuildTool;

public class BokehDepthOfField : ModuleRules
{
    public BokehDepthOfField(ReadOnlyTargetRules Target) : base(Target)
    {
        PCHUsage = PCHUsageMode.UseExplicitOrSharedPCHs;
        PublicDependencyModuleNames.AddRange(new string[] { "Core", "CoreUObject", "Engine" });
        PrivateDependencyModuleNames.AddRange(new string[] { "Projects", "RenderCore", "Renderer", "RHI" });
    }
}
