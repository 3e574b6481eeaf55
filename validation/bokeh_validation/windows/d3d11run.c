/* Passes of shader model 5 on Direct3D 11 (jobs: passes.h).
 *
 * The vertex shader makes its three vertices itself. Samplers: s0 linear, s1 nearest, both clamp; the shader chooses,
 * so the filter of an input is not used here. Parameters: b0.
 */
#define COBJMACROS
#define INITGUID
#include <windows.h>
#include <d3d11.h>
#include <dxgi.h>

#include "passes.h"

static const DXGI_FORMAT FORMATS[NUM_FORMATS] = {
    DXGI_FORMAT_R16G16B16A16_FLOAT,
    DXGI_FORMAT_R32G32B32A32_FLOAT,
    DXGI_FORMAT_R16G16_FLOAT,
    DXGI_FORMAT_R32G32_FLOAT,
    DXGI_FORMAT_R32_FLOAT,
};

static ID3D11Device *device;
static ID3D11DeviceContext *context;
static ID3D11SamplerState *samplers[2];
static ID3D11Buffer *parameters;

static D3D11_TEXTURE2D_DESC description(const Texture *texture, D3D11_USAGE usage, UINT bind, UINT access)
{
    D3D11_TEXTURE2D_DESC wanted = {0};
    wanted.Width = texture->width;
    wanted.Height = texture->height;
    wanted.MipLevels = wanted.ArraySize = wanted.SampleDesc.Count = 1;
    wanted.Format = FORMATS[texture->format];
    wanted.Usage = usage;
    wanted.BindFlags = bind;
    wanted.CPUAccessFlags = access;
    return wanted;
}

static int make_texture(Texture *texture, const void *pixels)
{
    D3D11_TEXTURE2D_DESC wanted = description(texture, D3D11_USAGE_IMMUTABLE, D3D11_BIND_SHADER_RESOURCE, 0);
    D3D11_SUBRESOURCE_DATA data = {pixels, (UINT)(texture->width * TEXEL_BYTES[texture->format]), 0};
    TRY(ID3D11Device_CreateTexture2D(device, &wanted, &data, (ID3D11Texture2D **)&texture->handle));
    return 1;
}

static int make_target(Texture *texture)
{
    UINT bind = D3D11_BIND_SHADER_RESOURCE | D3D11_BIND_RENDER_TARGET;
    D3D11_TEXTURE2D_DESC wanted = description(texture, D3D11_USAGE_DEFAULT, bind, 0);
    TRY(ID3D11Device_CreateTexture2D(device, &wanted, NULL, (ID3D11Texture2D **)&texture->handle));
    static const float ZERO[4] = {0};
    ID3D11RenderTargetView *view;
    TRY(ID3D11Device_CreateRenderTargetView(device, (ID3D11Resource *)texture->handle, NULL, &view));
    ID3D11DeviceContext_ClearRenderTargetView(context, view, ZERO);
    ID3D11RenderTargetView_Release(view);
    return 1;
}

static void drop(Texture *texture)
{
    ID3D11Texture2D_Release((ID3D11Texture2D *)texture->handle);
}

static int make_shader(int is_vertex, const void *code, size_t size, void **shader)
{
    if (is_vertex)
        TRY(ID3D11Device_CreateVertexShader(device, code, size, NULL, (ID3D11VertexShader **)shader));
    else
        TRY(ID3D11Device_CreatePixelShader(device, code, size, NULL, (ID3D11PixelShader **)shader));
    return 1;
}

static int set_inputs(const Job *job)
{
    for (int slot = 0; slot < NUM_SLOTS; slot++) {
        ID3D11ShaderResourceView *view = NULL;
        if (job->inputs[slot].texture) {
            ID3D11Resource *texture = job->inputs[slot].texture->handle;
            TRY(ID3D11Device_CreateShaderResourceView(device, texture, NULL, &view));
        }
        ID3D11DeviceContext_PSSetShaderResources(context, slot, 1, &view);
        if (view)
            ID3D11ShaderResourceView_Release(view); /* the context has its own reference */
    }
    return 1;
}

static int draw(const Job *job, Texture *const *targets, int num_targets)
{
    ID3D11RenderTargetView *views[MAX_TARGETS];
    for (int i = 0; i < num_targets; i++)
        TRY(ID3D11Device_CreateRenderTargetView(device, (ID3D11Resource *)targets[i]->handle, NULL, &views[i]));
    D3D11_VIEWPORT viewport = {(float)job->viewport.x,     (float)job->viewport.y,      (float)job->viewport.width,
                               (float)job->viewport.height, 0, 1};
    ID3D11DeviceContext_RSSetViewports(context, 1, &viewport);
    ID3D11DeviceContext_OMSetRenderTargets(context, num_targets, views, NULL);
    int ready = set_inputs(job);
    if (ready) {
        ID3D11DeviceContext_UpdateSubresource(context, (ID3D11Resource *)parameters, 0, NULL, job->values, 0, 0);
        ID3D11DeviceContext_VSSetShader(context, job->vertex, NULL, 0);
        ID3D11DeviceContext_PSSetShader(context, job->pixel, NULL, 0);
        ID3D11DeviceContext_Draw(context, 3, 0);
    }
    /* a texture cannot be read while it is bound as the target */
    ID3D11DeviceContext_OMSetRenderTargets(context, 0, NULL, NULL);
    for (int i = 0; i < num_targets; i++)
        ID3D11RenderTargetView_Release(views[i]);
    return ready;
}

static int read_back(const Texture *texture, void *pixels)
{
    D3D11_TEXTURE2D_DESC wanted = description(texture, D3D11_USAGE_STAGING, 0, D3D11_CPU_ACCESS_READ);
    ID3D11Texture2D *copy;
    TRY(ID3D11Device_CreateTexture2D(device, &wanted, NULL, &copy));
    ID3D11DeviceContext_CopyResource(context, (ID3D11Resource *)copy, (ID3D11Resource *)texture->handle);
    D3D11_MAPPED_SUBRESOURCE mapped;
    HRESULT status = ID3D11DeviceContext_Map(context, (ID3D11Resource *)copy, 0, D3D11_MAP_READ, 0, &mapped);
    if (SUCCEEDED(status)) {
        size_t bytes = (size_t)texture->width * TEXEL_BYTES[texture->format];
        for (int row = 0; row < texture->height; row++)
            memcpy((char *)pixels + row * bytes, (char *)mapped.pData + (size_t)row * mapped.RowPitch, bytes);
        ID3D11DeviceContext_Unmap(context, (ID3D11Resource *)copy, 0);
    }
    ID3D11Texture2D_Release(copy);
    return SUCCEEDED(status) ? 1 : problem("reading back returned %08lx", (unsigned long)status);
}

/* States and buffers that last as long as the device. */
static int set_states(void)
{
    D3D11_SAMPLER_DESC sampler = {0};
    sampler.AddressU = sampler.AddressV = sampler.AddressW = D3D11_TEXTURE_ADDRESS_CLAMP;
    sampler.MaxAnisotropy = 1;
    sampler.ComparisonFunc = D3D11_COMPARISON_NEVER;
    sampler.MaxLOD = D3D11_FLOAT32_MAX;
    sampler.Filter = D3D11_FILTER_MIN_MAG_LINEAR_MIP_POINT;
    TRY(ID3D11Device_CreateSamplerState(device, &sampler, &samplers[0]));
    sampler.Filter = D3D11_FILTER_MIN_MAG_MIP_POINT;
    TRY(ID3D11Device_CreateSamplerState(device, &sampler, &samplers[1]));
    D3D11_BUFFER_DESC buffer = {sizeof(float) * NUM_VALUES, D3D11_USAGE_DEFAULT, D3D11_BIND_CONSTANT_BUFFER, 0, 0, 0};
    TRY(ID3D11Device_CreateBuffer(device, &buffer, NULL, &parameters));
    ID3D11DeviceContext_PSSetSamplers(context, 0, 2, samplers);
    ID3D11DeviceContext_PSSetConstantBuffers(context, 0, 1, &parameters);
    ID3D11DeviceContext_IASetPrimitiveTopology(context, D3D11_PRIMITIVE_TOPOLOGY_TRIANGLELIST);
    return 1;
}

/* Name of the adapter that the device is on. */
static int adapter_name(char *text, size_t size)
{
    IDXGIDevice *dxgi;
    IDXGIAdapter *adapter;
    DXGI_ADAPTER_DESC known;
    TRY(ID3D11Device_QueryInterface(device, &IID_IDXGIDevice, (void **)&dxgi));
    TRY(IDXGIDevice_GetAdapter(dxgi, &adapter));
    TRY(IDXGIAdapter_GetDesc(adapter, &known));
    IDXGIAdapter_Release(adapter);
    IDXGIDevice_Release(dxgi);
    if (!WideCharToMultiByte(CP_UTF8, 0, known.Description, -1, text, (int)size, NULL, NULL))
        return problem("the adapter has no name");
    return 1;
}

static int make_device(D3D_FEATURE_LEVEL *level)
{
    TRY(D3D11CreateDevice(NULL, D3D_DRIVER_TYPE_HARDWARE, NULL, 0, NULL, 0, D3D11_SDK_VERSION, &device, level,
                          &context));
    if (*level < D3D_FEATURE_LEVEL_11_0)
        return problem("feature level %x: shader model 5 needs b000", *level);
    return set_states();
}

int main(void)
{
    D3D_FEATURE_LEVEL level;
    char adapter[256], suffix[64];
    if (!make_device(&level) || !adapter_name(adapter, sizeof adapter)) {
        say("unavailable", problem_text);
        return 1;
    }
    snprintf(suffix, sizeof suffix, "Direct3D 11, feature level %x", level);
    serve_device(adapter, suffix);
    return 0;
}
