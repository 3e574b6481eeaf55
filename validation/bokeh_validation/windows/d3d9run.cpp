/* Full-screen passes of shader model 3 on Direct3D 9, as requests to a server (serve.h).
 *
 *   clear                        forget all textures
 *   texture N W H FORMAT FILE    make texture N from a file: rows from v = 0 on without gaps. FORMAT is half4, float4
 *                                or float1
 *   texture N W H FORMAT         make it a target, 0 everywhere
 *   vertex FILE                  vertex shader of the draws to come
 *   pixel FILE                   pixel shader of the draws to come
 *   input SLOT N FILTER          texture N in a slot (s register) of the next draw; linear or nearest, clamp
 *   values NUMBER ...            parameter I: c(I).x of the pixel shader
 *   viewport X Y W H             the draws to come fill these texels, Y from the first row on; uv is 0 .. 1 over them
 *   draw N [N [N [N]]]           draw onto these targets; what is around the viewport stays
 *   keep N FILE                  write texture N, in its format, rows as above
 *
 * FILEs are names in the working directory. A pixel shader's is read once: other contents need another name.
 *
 * The vertex shader takes a quad: corner as POSITION, uv as TEXCOORD0, uv (0,0) at the first row. c20.xy of its
 * constants is 1 / width and 1 / height of the viewport: pixel centres are at whole numbers in Direct3D 9.
 */
#include <windows.h>
#include <d3d9.h>

#include <array>
#include <cstring>
#include <map>
#include <vector>

#include "serve.h"

#define TEXEL_SIZE_REGISTER 20
#define MOST_TARGETS 4
#define NUM_SLOTS 16 /* what shader model 3 has; a pass reads fewer */
/* NUM_VALUES, the number of parameters, comes from the build */

struct Format {
    D3DFORMAT kind;
    int bytes; /* of a texel */
};
/* Of two channels a shader reads blue 1, in later versions of Direct3D 0. */
static const std::map<std::string, Format> FORMATS = {
    {"half4", {D3DFMT_A16B16G16R16F, 8}}, {"float4", {D3DFMT_A32B32G32R32F, 16}}, {"float1", {D3DFMT_R32F, 4}}};

struct Texture {
    int width, height;
    Format format;
    ComPtr<IDirect3DTexture9> handle;

    int row_bytes() const { return width * format.bytes; }

    ComPtr<IDirect3DSurface9> surface() const
    {
        ComPtr<IDirect3DSurface9> level;
        TRY(handle->GetSurfaceLevel(0, &level));
        return level;
    }
};

struct Input {
    const Texture *texture; /* nullptr: empty */
    bool linear;
};

/* What a draw reads, apart from its vertex shader. */
struct State {
    IDirect3DPixelShader9 *pixel;
    std::array<Input, NUM_SLOTS> inputs;
    std::array<float, NUM_VALUES> values;
    std::array<int, 4> viewport;
};

/* Copy rows between memory without gaps and a mapped texture. */
static void copy_rows(void *to, size_t to_pitch, const void *from, size_t from_pitch, int rows, size_t bytes)
{
    for (int row = 0; row < rows; row++)
        memcpy((char *)to + row * to_pitch, (const char *)from + row * from_pitch, bytes);
}

struct Device {
    ComPtr<IDirect3D9> direct3d;
    ComPtr<IDirect3DDevice9> device;

    /* A texture with these pixels, or a target where there are none. */
    void make(Texture &texture, const char *pixels)
    {
        DWORD usage = pixels ? 0 : D3DUSAGE_RENDERTARGET;
        D3DPOOL pool = pixels ? D3DPOOL_MANAGED : D3DPOOL_DEFAULT;
        TRY(device->CreateTexture(texture.width, texture.height, 1, usage, texture.format.kind, pool, &texture.handle,
                                  nullptr));
        if (!pixels) {
            TRY(device->ColorFill(texture.surface().Get(), nullptr, 0));
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

    ComPtr<IDirect3DPixelShader9> pixel_shader(const std::string &code)
    {
        ComPtr<IDirect3DPixelShader9> shader;
        TRY(device->CreatePixelShader((const DWORD *)code.data(), &shader));
        return shader;
    }

    void set_inputs(const std::array<Input, NUM_SLOTS> &inputs)
    {
        for (int slot = 0; slot < NUM_SLOTS; slot++) {
            const auto &[texture, linear] = inputs[slot];
            TRY(device->SetTexture(slot, texture ? texture->handle.Get() : nullptr));
            for (D3DSAMPLERSTATETYPE filter : {D3DSAMP_MINFILTER, D3DSAMP_MAGFILTER})
                TRY(device->SetSamplerState(slot, filter, linear ? D3DTEXF_LINEAR : D3DTEXF_POINT));
        }
    }

    void draw(const State &state, const std::vector<Texture *> &targets)
    {
        for (DWORD i = 1; i < MOST_TARGETS; i++) /* those of the draw before may have another size */
            TRY(device->SetRenderTarget(i, nullptr));
        for (size_t i = 0; i < targets.size(); i++)
            TRY(device->SetRenderTarget(i, targets[i]->surface().Get()));
        /* after the targets: setting the first one makes the viewport as large as it */
        const auto &[x, y, width, height] = state.viewport;
        D3DVIEWPORT9 viewport{(DWORD)x, (DWORD)y, (DWORD)width, (DWORD)height, 0.0f, 1.0f};
        TRY(device->SetViewport(&viewport));
        TRY(device->SetPixelShader(state.pixel));
        set_inputs(state.inputs);
        float texel[4]{1.0f / width, 1.0f / height};
        TRY(device->SetVertexShaderConstantF(TEXEL_SIZE_REGISTER, texel, 1));
        for (int i = 0; i < NUM_VALUES; i++) {
            float value[4]{state.values[i]};
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
        TRY(device->CreateOffscreenPlainSurface(texture.width, texture.height, texture.format.kind, D3DPOOL_SYSTEMMEM,
                                                &copy, nullptr));
        TRY(device->GetRenderTargetData(texture.surface().Get(), copy.Get()));
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

/* What there is, and what the next draw reads. A name or number that is not there is std::out_of_range. */
struct Passes {
    Device device{};
    std::map<int, Texture> textures{};
    std::map<std::string, ComPtr<IDirect3DPixelShader9>> shaders{};
    State state{};

    void make(Texture &texture, std::istream &rest)
    {
        std::string format, file;
        rest >> texture.width >> texture.height >> format >> file;
        texture.format = FORMATS.at(format);
        device.make(texture, file.empty() ? nullptr : read_file(file).data());
    }

    void draw(std::istream &numbers)
    {
        std::vector<Texture *> targets;
        for (int number; numbers >> number;)
            targets.push_back(&textures.at(number));
        device.draw(state, targets);
        state.inputs = {};
    }

    void keep(const Texture &texture, const std::string &file)
    {
        std::string pixels((size_t)texture.row_bytes() * texture.height, '\0');
        device.read_back(texture, pixels.data());
        write_file(file, pixels.data(), pixels.size());
    }

    void take(const std::string &request)
    {
        std::istringstream rest(request);
        int number, slot;
        std::string word, name;
        rest >> word;
        if (word == "clear")
            textures.clear();
        else if (word == "texture" && rest >> number)
            make(textures[number], rest);
        else if (word == "vertex" && rest >> name)
            device.use_vertex_shader(read_file(name));
        else if (word == "pixel" && rest >> name) {
            if (!shaders.count(name))
                shaders[name] = device.pixel_shader(read_file(name));
            state.pixel = shaders[name].Get();
        } else if (word == "input" && rest >> slot >> number >> name)
            state.inputs.at(slot) = {&textures.at(number), name == "linear"};
        else if (word == "values")
            for (size_t index = 0; rest >> name; index++)
                state.values.at(index) = strtof(name.c_str(), nullptr); /* inf and nan too */
        else if (word == "viewport")
            for (int &side : state.viewport)
                rest >> side;
        else if (word == "draw")
            draw(rest);
        else if (word == "keep" && rest >> number >> name)
            keep(textures.at(number), name);
        else
            fail("cannot use '%.200s'", request.c_str());
    }
};

int main()
{
    Passes passes;
    return serve([&] { return passes.device.start(); }, [&](const std::string &request) { passes.take(request); });
}
