/* Passes of shader model 3 on Direct3D 9 (requests: passes.h).
 *
 * The vertex shader takes a quad: corner as POSITION, uv as TEXCOORD0, uv (0,0) at the first row. c20.xy of its
 * constants is 1 / width and 1 / height of the viewport: pixel centres are at whole numbers in Direct3D 9.
 */
#include <windows.h>
#include <d3d9.h>

#include "passes.h"

#define TEXEL_SIZE_REGISTER 20
#define MOST_TARGETS 4

/* Of two channels a shader reads blue 1, in later versions of Direct3D 0. */
static const D3DFORMAT FORMATS[] = {D3DFMT_A16B16G16R16F, D3DFMT_A32B32G32R32F, D3DFMT_R32F};

struct D3D9 {
    using Handle = IDirect3DTexture9;
    using Pixel = IDirect3DPixelShader9;
    using Texture = ::Texture<Handle>;

    ComPtr<IDirect3D9> direct3d;
    ComPtr<IDirect3DDevice9> device;

    ComPtr<IDirect3DSurface9> surface(const Texture &texture)
    {
        ComPtr<IDirect3DSurface9> level;
        TRY(texture.handle->GetSurfaceLevel(0, &level));
        return level;
    }

    void make(Texture &texture, const char *pixels)
    {
        DWORD usage = pixels ? 0 : D3DUSAGE_RENDERTARGET;
        D3DPOOL pool = pixels ? D3DPOOL_MANAGED : D3DPOOL_DEFAULT;
        TRY(device->CreateTexture(texture.width, texture.height, 1, usage, FORMATS[texture.format.index], pool,
                                  &texture.handle, nullptr));
        if (!pixels) {
            TRY(device->ColorFill(surface(texture).Get(), nullptr, 0));
            return;
        }
        D3DLOCKED_RECT locked;
        TRY(texture.handle->LockRect(0, &locked, nullptr, 0));
        copy_rows(locked.pBits, locked.Pitch, pixels, texture.row_bytes(), texture.height, texture.row_bytes());
        TRY(texture.handle->UnlockRect(0));
    }

    void use_vertex_shader(const std::string &code)
    {
        ComPtr<IDirect3DVertexShader9> shader;
        TRY(device->CreateVertexShader((const DWORD *)code.data(), &shader));
        TRY(device->SetVertexShader(shader.Get()));
    }

    void make(const std::string &code, Pixel **shader) { TRY(device->CreatePixelShader((const DWORD *)code.data(), shader)); }

    void set_inputs(const Passes<D3D9> &pass)
    {
        for (int slot = 0; slot < NUM_SLOTS; slot++) {
            const auto &[texture, linear] = pass.inputs[slot];
            TRY(device->SetTexture(slot, texture ? texture->handle.Get() : nullptr));
            for (D3DSAMPLERSTATETYPE filter : {D3DSAMP_MINFILTER, D3DSAMP_MAGFILTER})
                TRY(device->SetSamplerState(slot, filter, linear ? D3DTEXF_LINEAR : D3DTEXF_POINT));
        }
    }

    void draw(const Passes<D3D9> &pass, const std::vector<Texture *> &targets)
    {
        for (DWORD i = 1; i < MOST_TARGETS; i++) /* those of the draw before may have another size */
            TRY(device->SetRenderTarget(i, nullptr));
        for (size_t i = 0; i < targets.size(); i++)
            TRY(device->SetRenderTarget(i, surface(*targets[i]).Get()));
        /* after the targets: setting the first one makes the viewport as large as it */
        const auto &[x, y, width, height] = pass.viewport;
        D3DVIEWPORT9 viewport{(DWORD)x, (DWORD)y, (DWORD)width, (DWORD)height, 0.0f, 1.0f};
        TRY(device->SetViewport(&viewport));
        TRY(device->SetPixelShader(pass.pixel));
        set_inputs(pass);
        float texel[4]{1.0f / width, 1.0f / height};
        TRY(device->SetVertexShaderConstantF(TEXEL_SIZE_REGISTER, texel, 1));
        for (int i = 0; i < NUM_VALUES; i++) {
            float value[4]{pass.values[i]};
            TRY(device->SetPixelShaderConstantF(i, value, 1));
        }
        static const float QUAD[4][6] = {
            {-1, 1, 0, 1, 0, 0}, {1, 1, 0, 1, 1, 0}, {-1, -1, 0, 1, 0, 1}, {1, -1, 0, 1, 1, 1}};
        TRY(device->BeginScene());
        HRESULT drawn = device->DrawPrimitiveUP(D3DPT_TRIANGLESTRIP, 2, QUAD, sizeof QUAD[0]);
        TRY(device->EndScene());
        TRY(drawn);
    }

    void read_back(const Texture &texture, char *pixels)
    {
        ComPtr<IDirect3DSurface9> copy;
        D3DLOCKED_RECT locked;
        TRY(device->CreateOffscreenPlainSurface(texture.width, texture.height, FORMATS[texture.format.index],
                                                D3DPOOL_SYSTEMMEM, &copy, nullptr));
        TRY(device->GetRenderTargetData(surface(texture).Get(), copy.Get()));
        TRY(copy->LockRect(&locked, nullptr, D3DLOCK_READONLY));
        copy_rows(pixels, texture.row_bytes(), locked.pBits, locked.Pitch, texture.height, texture.row_bytes());
        TRY(copy->UnlockRect());
    }

    /* What no draw changes. By default there is no depth test, no blending and no filter between mip levels. */
    void set_states()
    {
        TRY(device->SetFVF(D3DFVF_XYZW | D3DFVF_TEX1));
        TRY(device->SetRenderState(D3DRS_CULLMODE, D3DCULL_NONE));
        for (int slot = 0; slot < NUM_SLOTS; slot++) {
            TRY(device->SetSamplerState(slot, D3DSAMP_ADDRESSU, D3DTADDRESS_CLAMP));
            TRY(device->SetSamplerState(slot, D3DSAMP_ADDRESSV, D3DTADDRESS_CLAMP));
        }
    }

    /* What the device is. */
    std::string start()
    {
        HWND window = CreateWindowA("STATIC", "d3d9run", WS_POPUP, 0, 0, 16, 16, NULL, NULL, GetModuleHandleA(NULL), NULL);
        if (!window)
            fail("no window: no display?");
        direct3d.Attach(Direct3DCreate9(D3D_SDK_VERSION));
        if (!direct3d)
            fail("no Direct3D 9");
        D3DPRESENT_PARAMETERS present{};
        present.Windowed = TRUE;
        present.SwapEffect = D3DSWAPEFFECT_DISCARD;
        present.hDeviceWindow = window;
        TRY(direct3d->CreateDevice(D3DADAPTER_DEFAULT, D3DDEVTYPE_HAL, window,
                                   D3DCREATE_HARDWARE_VERTEXPROCESSING | D3DCREATE_FPU_PRESERVE, &present, &device));
        set_states();
        return "Direct3D 9";
    }
};

int main() { return serve_device<D3D9>(); }
