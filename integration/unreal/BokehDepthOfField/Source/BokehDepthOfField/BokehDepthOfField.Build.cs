// Copyright (c) 2026 the authors of the polygonal bokeh shader package
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
