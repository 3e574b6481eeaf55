/* Microsoft's HLSL compiler as a server (serve.h): d3dcompiler_47.dll.
 *
 * A request is PROFILE ENTRY, such as "ps_3_0 main". It compiles the file fxc.source, which is complete: there are no
 * includes. fxc.messages are the errors and warnings; where it compiles, fxc.bytecode is what comes out and fxc.listing
 * its disassembly. Else the answer is the status.
 */
#include <windows.h>
#include <d3dcompiler.h>

#include "serve.h"

static void write_blob(const char *name, ID3DBlob *blob)
{
    write_file(name, blob ? blob->GetBufferPointer() : "", blob ? blob->GetBufferSize() : 0);
}

static void work(const std::string &request)
{
    std::istringstream words(request);
    std::string profile, entry, source = read_file("fxc.source");
    words >> profile >> entry;
    ComPtr<ID3DBlob> code, messages, listing;
    HRESULT status = D3DCompile(source.data(), source.size(), "bokeh.hlsl", nullptr, nullptr, entry.c_str(),
                                profile.c_str(), 0, 0, &code, &messages);
    write_blob("fxc.messages", messages.Get());
    TRY(status);
    write_blob("fxc.bytecode", code.Get());
    TRY(D3DDisassemble(code->GetBufferPointer(), code->GetBufferSize(), 0, nullptr, &listing));
    write_blob("fxc.listing", listing.Get());
}

int main()
{
    return serve([] { return ""; }, work);
}
