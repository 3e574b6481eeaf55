// Stand-ins for what a Build.cs of Unreal 5 uses.

using System.Collections.Generic;

namespace UnrealBuildTool
{
    public class ReadOnlyTargetRules { }

    public class ModuleRules
    {
        public enum PCHUsageMode { Default, NoPCHs, NoSharedPCHs, UseSharedPCHs, UseExplicitOrSharedPCHs }

        public ModuleRules(ReadOnlyTargetRules Target) { }

        public PCHUsageMode PCHUsage;
        public readonly List<string> PublicDependencyModuleNames = new List<string>();
        public readonly List<string> PrivateDependencyModuleNames = new List<string>();
    }
}
