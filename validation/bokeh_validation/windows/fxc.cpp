/* Microsoft's HLSL compiler as a server (serve.h): d3dcompiler_47.dll, which lies beside this program.
 *
 * A request is PROFILE ENTRY FLAGS, such as "ps_3_0 main 0"; FLAGS are D3DCOMPILE_* of d3dcompiler.h, hexadecimal.
 * It compiles the file fxc.source, which is complete: there are no includes. fxc.messages are the errors and warnings;
 * where it compiles, fxc.bytecode is what comes out and fxc.listing its disassembly. Else the answer is the status.
 */
#include <windows.h>
#include <d3dcommon.h>

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

static void work(const std::string &request)
{
    std::istringstream words(request);
    std::string profile, entry, source = read_file("fxc.source");
    UINT flags;
    if (!(words >> profile >> entry >> std::hex >> flags))
        fail("not PROFILE ENTRY FLAGS");
    ComPtr<ID3DBlob> code, messages, listing;
    HRESULT status = compile(source.data(), source.size(), "bokeh.hlsl", nullptr, nullptr, entry.c_str(),
                             profile.c_str(), flags, 0, &code, &messages);
    write_text("fxc.messages", messages.Get());
    if (FAILED(status) || !code)
        fail("%08lx", (unsigned long)status);
    write_file("fxc.bytecode", code->GetBufferPointer(), code->GetBufferSize());
    TRY(disassemble(code->GetBufferPointer(), code->GetBufferSize(), 0, nullptr, &listing));
    write_text("fxc.listing", listing.Get());
}

static std::string start()
{
    /* by its whole path: Wine has a library of the same name, which does not know shader model 3 */
    wchar_t path[MAX_PATH + 32];
    std::wstring program(path, GetModuleFileNameW(nullptr, path, MAX_PATH));
    HMODULE library = LoadLibraryW((program.substr(0, program.rfind(L'\\') + 1) + L"d3dcompiler_47.dll").c_str());
    if (!library)
        fail("d3dcompiler_47.dll beside fxc.exe cannot be loaded (error %lu)", GetLastError());
    compile = (Compile)(void *)GetProcAddress(library, "D3DCompile");
    disassemble = (Disassemble)(void *)GetProcAddress(library, "D3DDisassemble");
    if (!compile || !disassemble)
        fail("d3dcompiler_47.dll has no D3DCompile or no D3DDisassemble");
    return "";
}

int main() { return serve(start, work); }
