/* Passes of shader model 3 on Direct3D 9 (jobs: passes.h).
 *
 * The vertex shader takes a quad: corner as POSITION, uv as TEXCOORD0, uv (0,0) at the first row. c20.xy of its
 * constants is 1 / width and 1 / height of the viewport: pixel centres are at whole numbers in Direct3D 9.
 */
#define COBJMACROS
#include <windows.h>
#include <d3d9.h>

#include "passes.h"

#define TEXEL_SIZE_REGISTER 20

/* Of two channels a shader reads blue 1, in later versions of Direct3D 0. */
static const D3DFORMAT FORMATS[NUM_FORMATS] = {
    D3DFMT_A16B16G16R16F, D3DFMT_A32B32G32R32F, D3DFMT_G16R16F, D3DFMT_G32R32F, D3DFMT_R32F,
};

static IDirect3D9 *direct3d;
static IDirect3DDevice9 *device;

static void copy_rows(void *to, int to_pitch, const void *from, int from_pitch, int bytes, int rows)
{
    for (int row = 0; row < rows; row++)
        memcpy((char *)to + (size_t)row * to_pitch, (const char *)from + (size_t)row * from_pitch, bytes);
}

static int make_texture(Texture *texture, const void *pixels)
{
    TRY(IDirect3DDevice9_CreateTexture(device, texture->width, texture->height, 1, 0, FORMATS[texture->format],
                                       D3DPOOL_MANAGED, (IDirect3DTexture9 **)&texture->handle, NULL));
    D3DLOCKED_RECT locked;
    TRY(IDirect3DTexture9_LockRect((IDirect3DTexture9 *)texture->handle, 0, &locked, NULL, 0));
    int bytes = texture->width * TEXEL_BYTES[texture->format];
    copy_rows(locked.pBits, locked.Pitch, pixels, bytes, bytes, texture->height);
    TRY(IDirect3DTexture9_UnlockRect((IDirect3DTexture9 *)texture->handle, 0));
    return 1;
}

static int make_target(Texture *texture)
{
    TRY(IDirect3DDevice9_CreateTexture(device, texture->width, texture->height, 1, D3DUSAGE_RENDERTARGET,
                                       FORMATS[texture->format], D3DPOOL_DEFAULT,
                                       (IDirect3DTexture9 **)&texture->handle, NULL));
    IDirect3DSurface9 *surface;
    TRY(IDirect3DTexture9_GetSurfaceLevel((IDirect3DTexture9 *)texture->handle, 0, &surface));
    HRESULT cleared = IDirect3DDevice9_ColorFill(device, surface, NULL, 0);
    IDirect3DSurface9_Release(surface);
    TRY(cleared);
    return 1;
}

static void drop(Texture *texture)
{
    IDirect3DTexture9_Release((IDirect3DTexture9 *)texture->handle);
}

static int make_shader(int is_vertex, const void *code, size_t size, void **shader)
{
    (void)size; /* the code ends with a token of its own */
    if (is_vertex)
        TRY(IDirect3DDevice9_CreateVertexShader(device, code, (IDirect3DVertexShader9 **)shader));
    else
        TRY(IDirect3DDevice9_CreatePixelShader(device, code, (IDirect3DPixelShader9 **)shader));
    return 1;
}

static int set_inputs(const Job *job)
{
    for (int slot = 0; slot < NUM_SLOTS; slot++) {
        const Texture *texture = job->inputs[slot].texture;
        DWORD filter = job->inputs[slot].linear ? D3DTEXF_LINEAR : D3DTEXF_POINT;
        TRY(IDirect3DDevice9_SetTexture(device, slot, texture ? (IDirect3DBaseTexture9 *)texture->handle : NULL));
        TRY(IDirect3DDevice9_SetSamplerState(device, slot, D3DSAMP_MINFILTER, filter));
        TRY(IDirect3DDevice9_SetSamplerState(device, slot, D3DSAMP_MAGFILTER, filter));
    }
    return 1;
}

static int set_constants(const Job *job)
{
    float texel[4] = {1.0f / job->viewport.width, 1.0f / job->viewport.height, 0.0f, 0.0f};
    TRY(IDirect3DDevice9_SetVertexShaderConstantF(device, TEXEL_SIZE_REGISTER, texel, 1));
    for (int i = 0; i < NUM_VALUES; i++) {
        float value[4] = {job->values[i], 0.0f, 0.0f, 0.0f};
        TRY(IDirect3DDevice9_SetPixelShaderConstantF(device, i, value, 1));
    }
    return 1;
}

static int draw_quad(void)
{
    static const float QUAD[4][6] = {
        {-1, 1, 0, 1, 0, 0},
        {1, 1, 0, 1, 1, 0},
        {-1, -1, 0, 1, 0, 1},
        {1, -1, 0, 1, 1, 1},
    };
    TRY(IDirect3DDevice9_BeginScene(device));
    HRESULT drawn = IDirect3DDevice9_DrawPrimitiveUP(device, D3DPT_TRIANGLESTRIP, 2, QUAD, sizeof QUAD[0]);
    TRY(IDirect3DDevice9_EndScene(device));
    TRY(drawn);
    return 1;
}

static int set_target(int index, const Texture *target)
{
    IDirect3DSurface9 *surface;
    TRY(IDirect3DTexture9_GetSurfaceLevel((IDirect3DTexture9 *)target->handle, 0, &surface));
    HRESULT status = IDirect3DDevice9_SetRenderTarget(device, index, surface);
    IDirect3DSurface9_Release(surface);
    TRY(status);
    return 1;
}

static int draw(const Job *job, Texture *const *targets, int num_targets)
{
    D3DCAPS9 caps;
    TRY(IDirect3DDevice9_GetDeviceCaps(device, &caps));
    int most = (int)caps.NumSimultaneousRTs;
    if (num_targets > most)
        return problem("%d targets, but the device has %d at once", num_targets, most);
    for (int i = 1; i < most; i++) /* those of the draw before may have another size */
        TRY(IDirect3DDevice9_SetRenderTarget(device, i, NULL));
    for (int i = 0; i < num_targets; i++)
        if (!set_target(i, targets[i]))
            return 0;
    /* after the targets: setting the first one makes the viewport as large as it */
    D3DVIEWPORT9 viewport = {job->viewport.x, job->viewport.y, job->viewport.width, job->viewport.height, 0.0f, 1.0f};
    TRY(IDirect3DDevice9_SetViewport(device, &viewport));
    TRY(IDirect3DDevice9_SetVertexShader(device, job->vertex));
    TRY(IDirect3DDevice9_SetPixelShader(device, job->pixel));
    return set_inputs(job) && set_constants(job) && draw_quad();
}

static int read_back(const Texture *texture, void *pixels)
{
    IDirect3DSurface9 *surface, *copy;
    TRY(IDirect3DDevice9_CreateOffscreenPlainSurface(device, texture->width, texture->height, FORMATS[texture->format],
                                                     D3DPOOL_SYSTEMMEM, &copy, NULL));
    D3DLOCKED_RECT locked;
    HRESULT status = IDirect3DTexture9_GetSurfaceLevel((IDirect3DTexture9 *)texture->handle, 0, &surface);
    if (SUCCEEDED(status)) {
        status = IDirect3DDevice9_GetRenderTargetData(device, surface, copy);
        IDirect3DSurface9_Release(surface);
    }
    if (SUCCEEDED(status))
        status = IDirect3DSurface9_LockRect(copy, &locked, NULL, D3DLOCK_READONLY);
    if (SUCCEEDED(status)) {
        int bytes = texture->width * TEXEL_BYTES[texture->format];
        copy_rows(pixels, bytes, locked.pBits, locked.Pitch, bytes, texture->height);
        IDirect3DSurface9_UnlockRect(copy);
    }
    IDirect3DSurface9_Release(copy);
    return SUCCEEDED(status) ? 1 : problem("reading back returned %08lx", (unsigned long)status);
}

/* States that no draw changes. */
static int set_states(void)
{
    static const D3DVERTEXELEMENT9 ELEMENTS[] = {
        {0, 0, D3DDECLTYPE_FLOAT4, D3DDECLMETHOD_DEFAULT, D3DDECLUSAGE_POSITION, 0},
        {0, 16, D3DDECLTYPE_FLOAT2, D3DDECLMETHOD_DEFAULT, D3DDECLUSAGE_TEXCOORD, 0},
        D3DDECL_END(),
    };
    IDirect3DVertexDeclaration9 *declaration;
    TRY(IDirect3DDevice9_CreateVertexDeclaration(device, ELEMENTS, &declaration));
    TRY(IDirect3DDevice9_SetVertexDeclaration(device, declaration));
    TRY(IDirect3DDevice9_SetDepthStencilSurface(device, NULL));
    TRY(IDirect3DDevice9_SetRenderState(device, D3DRS_ZENABLE, FALSE));
    TRY(IDirect3DDevice9_SetRenderState(device, D3DRS_CULLMODE, D3DCULL_NONE));
    TRY(IDirect3DDevice9_SetRenderState(device, D3DRS_ALPHABLENDENABLE, FALSE));
    for (int slot = 0; slot < NUM_SLOTS; slot++) {
        TRY(IDirect3DDevice9_SetSamplerState(device, slot, D3DSAMP_MIPFILTER, D3DTEXF_NONE));
        TRY(IDirect3DDevice9_SetSamplerState(device, slot, D3DSAMP_ADDRESSU, D3DTADDRESS_CLAMP));
        TRY(IDirect3DDevice9_SetSamplerState(device, slot, D3DSAMP_ADDRESSV, D3DTADDRESS_CLAMP));
    }
    return 1;
}

static int make_device(void)
{
    HWND window = CreateWindowA("STATIC", "d3d9run", WS_POPUP, 0, 0, 16, 16, NULL, NULL, GetModuleHandleA(NULL), NULL);
    if (!window)
        return problem("no window: no display?");
    direct3d = Direct3DCreate9(D3D_SDK_VERSION);
    if (!direct3d)
        return problem("no Direct3D 9");
    D3DPRESENT_PARAMETERS present = {0};
    present.Windowed = TRUE;
    present.SwapEffect = D3DSWAPEFFECT_DISCARD;
    present.BackBufferWidth = present.BackBufferHeight = 16;
    present.BackBufferFormat = D3DFMT_X8R8G8B8;
    present.hDeviceWindow = window;
    TRY(IDirect3D9_CreateDevice(direct3d, D3DADAPTER_DEFAULT, D3DDEVTYPE_HAL, window,
                                D3DCREATE_HARDWARE_VERTEXPROCESSING | D3DCREATE_FPU_PRESERVE, &present, &device));
    return set_states();
}

int main(void)
{
    D3DADAPTER_IDENTIFIER9 adapter;
    if (!make_device()) {
        say("unavailable", problem_text);
        return 1;
    }
    if (FAILED(IDirect3D9_GetAdapterIdentifier(direct3d, D3DADAPTER_DEFAULT, 0, &adapter)))
        strcpy(adapter.Description, "adapter without a name");
    serve_device(adapter.Description, "Direct3D 9");
    return 0;
}
