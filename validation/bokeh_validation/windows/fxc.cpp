/* Microsoft's HLSL compiler as a server (serve.h): d3dcompiler_47.dll, which lies beside this program.
 *
 * A job file is text, one setting a line, in any order; all but `define` are needed:
 *
 *   source FILE        HLSL text
 *   profile NAME       such as ps_3_0
 *   entry NAME
 *   flags NUMBER       D3DCOMPILE_* of d3dcompiler.h, hexadecimal; 0 is what fxc.exe does without options
 *   define NAME TEXT   any number of them; TEXT is the rest of the line
 *   bytecode FILE      written when it compiles
 *   listing FILE       its disassembly, written when it compiles
 *   messages FILE      written always: errors and warnings
 *
 * "ok" when it compiled, "failed" with the status when not; "failed" with words when the job is wrong.
 * There are no includes: the source is complete.
 */
#include <windows.h>
#include <d3dcommon.h>

#include <map>
#include <vector>

#include "serve.h"

typedef HRESULT(WINAPI *Compile)(const void *, SIZE_T, const char *, const D3D_SHADER_MACRO *, ID3DInclude *,
                                 const char *, const char *, UINT, UINT, ID3DBlob **, ID3DBlob **);
typedef HRESULT(WINAPI *Disassemble)(const void *, SIZE_T, UINT, const char *, ID3DBlob **);

static Compile compile;
static Disassemble disassemble;

/* The text of a blob; it may or may not end in a zero byte. */
static void write_text(const std::string &name, ID3DBlob *blob)
{
    const char *text = blob ? (const char *)blob->GetBufferPointer() : "";
    size_t size = blob ? blob->GetBufferSize() : 0;
    while (size && !text[size - 1])
        size--;
    write_file(name, text, size);
}

static void work(const std::string &name)
{
    std::map<std::string, std::string> settings, defines;
    each_line(name, [&](auto &word, auto &rest) {
        std::string key;
        if (word == "define" && !(rest >> key))
            return false;
        return (bool)std::getline(rest >> std::ws, word == "define" ? defines[key] : settings[word]);
    });
    std::vector<D3D_SHADER_MACRO> macros;
    for (const auto &[key, text] : defines)
        macros.push_back({key.c_str(), text.c_str()});
    macros.push_back({});
    for (const char *needed : {"source", "profile", "entry", "flags", "bytecode", "listing", "messages"})
        if (!settings.count(needed))
            fail("%s is needed", needed);
    std::string source = read_file(settings["source"]);
    UINT flags = strtoul(settings["flags"].c_str(), nullptr, 16);
    ComPtr<ID3DBlob> code, messages, listing;
    HRESULT status = compile(source.data(), source.size(), "bokeh.hlsl", macros.data(), nullptr,
                             settings["entry"].c_str(), settings["profile"].c_str(), flags, 0, &code, &messages);
    write_text(settings["messages"], messages.Get());
    if (FAILED(status) || !code)
        fail("%08lx", (unsigned long)status);
    write_file(settings["bytecode"], code->GetBufferPointer(), code->GetBufferSize());
    TRY(disassemble(code->GetBufferPointer(), code->GetBufferSize(), 0, nullptr, &listing));
    write_text(settings["listing"], listing.Get());
}

/* The version resource of the library, such as 10.0.26100.1. */
static std::string version_of(const wchar_t *path)
{
    DWORD ignored;
    std::string data(GetFileVersionInfoSizeW(path, &ignored), 0);
    VS_FIXEDFILEINFO *info;
    UINT size;
    if (data.empty() || !GetFileVersionInfoW(path, 0, data.size(), data.data()) ||
        !VerQueryValueW(data.data(), L"\\", (void **)&info, &size))
        return "unknown";
    std::ostringstream text;
    text << HIWORD(info->dwFileVersionMS) << '.' << LOWORD(info->dwFileVersionMS) << '.'
         << HIWORD(info->dwFileVersionLS) << '.' << LOWORD(info->dwFileVersionLS);
    return text.str();
}

static std::string start()
{
    /* by its whole path: Wine has a library of the same name, which does not know shader model 3 */
    wchar_t path[MAX_PATH + 32];
    std::wstring program(path, GetModuleFileNameW(nullptr, path, MAX_PATH));
    std::wstring beside = program.substr(0, program.rfind(L'\\') + 1) + L"d3dcompiler_47.dll";
    HMODULE library = LoadLibraryW(beside.c_str());
    if (!library)
        fail("d3dcompiler_47.dll beside fxc.exe cannot be loaded (error %lu)", GetLastError());
    compile = (Compile)(void *)GetProcAddress(library, "D3DCompile");
    disassemble = (Disassemble)(void *)GetProcAddress(library, "D3DDisassemble");
    if (!compile || !disassemble)
        fail("d3dcompiler_47.dll has no D3DCompile or no D3DDisassemble");
    return version_of(beside.c_str());
}

int main() { return serve(start, work); }
