/* Passes of shader model 5 on Direct3D 11 (requests: passes.h).
 *
 * The vertex shader makes its three vertices itself. Samplers: s0 linear, s1 nearest, both clamp; the shader chooses,
 * so the filter of an input is not used here. Parameters: b0.
 */
#include <windows.h>
#include <d3d11.h>

#include "passes.h"

static const DXGI_FORMAT FORMATS[] = {
    DXGI_FORMAT_R16G16B16A16_FLOAT,
    DXGI_FORMAT_R32G32B32A32_FLOAT,
    DXGI_FORMAT_R32_FLOAT,
};

struct D3D11 {
    using Handle = ID3D11Texture2D;
    using Pixel = ID3D11PixelShader;
    using Texture = ::Texture<Handle>;

    ComPtr<ID3D11Device> device;
    ComPtr<ID3D11DeviceContext> context;
    ComPtr<ID3D11Buffer> parameters;

    /* A texture of the device as large as another and of its format; `pixels` may be null. */
    void create(const Texture &like, D3D11_USAGE usage, UINT bind, UINT access, const void *pixels, Handle **texture)
    {
        D3D11_TEXTURE2D_DESC description{};
        description.Width = like.width;
        description.Height = like.height;
        description.MipLevels = description.ArraySize = description.SampleDesc.Count = 1;
        description.Format = FORMATS[like.format.index];
        description.Usage = usage;
        description.BindFlags = bind;
        description.CPUAccessFlags = access;
        D3D11_SUBRESOURCE_DATA data{pixels, (UINT)like.row_bytes(), 0};
        TRY(device->CreateTexture2D(&description, pixels ? &data : nullptr, texture));
    }

    ComPtr<ID3D11RenderTargetView> view(const Texture &target)
    {
        ComPtr<ID3D11RenderTargetView> whole;
        TRY(device->CreateRenderTargetView(target.handle.Get(), nullptr, &whole));
        return whole;
    }

    void make(Texture &texture, const char *pixels)
    {
        static const float ZERO[4]{};
        UINT bind = D3D11_BIND_SHADER_RESOURCE | (pixels ? 0 : D3D11_BIND_RENDER_TARGET);
        create(texture, pixels ? D3D11_USAGE_IMMUTABLE : D3D11_USAGE_DEFAULT, bind, 0, pixels, &texture.handle);
        if (!pixels)
            context->ClearRenderTargetView(view(texture).Get(), ZERO);
    }

    void use_vertex_shader(const std::string &code)
    {
        ComPtr<ID3D11VertexShader> shader;
        TRY(device->CreateVertexShader(code.data(), code.size(), nullptr, &shader));
        context->VSSetShader(shader.Get(), nullptr, 0);
    }

    void make(const std::string &code, Pixel **shader)
    {
        TRY(device->CreatePixelShader(code.data(), code.size(), nullptr, shader));
    }

    void draw(const Passes<D3D11> &pass, const std::vector<Texture *> &targets)
    {
        std::vector<ComPtr<ID3D11RenderTargetView>> owned;
        std::vector<ID3D11RenderTargetView *> views;
        for (const Texture *target : targets)
            views.push_back(owned.emplace_back(view(*target)).Get());
        const auto &[x, y, width, height] = pass.viewport;
        D3D11_VIEWPORT viewport{(float)x, (float)y, (float)width, (float)height, 0, 1};
        context->RSSetViewports(1, &viewport);
        context->OMSetRenderTargets((UINT)views.size(), views.data(), nullptr);
        for (int slot = 0; slot < NUM_SLOTS; slot++) {
            ComPtr<ID3D11ShaderResourceView> input;
            if (const Texture *texture = pass.inputs[slot].texture)
                TRY(device->CreateShaderResourceView(texture->handle.Get(), nullptr, &input));
            context->PSSetShaderResources(slot, 1, input.GetAddressOf());
        }
        context->UpdateSubresource(parameters.Get(), 0, nullptr, pass.values.data(), 0, 0);
        context->PSSetShader(pass.pixel, nullptr, 0);
        context->Draw(3, 0);
        /* a texture cannot be read while it is bound as the target */
        context->OMSetRenderTargets(0, nullptr, nullptr);
    }

    void read_back(const Texture &texture, char *pixels)
    {
        ComPtr<Handle> copy;
        create(texture, D3D11_USAGE_STAGING, 0, D3D11_CPU_ACCESS_READ, nullptr, &copy);
        context->CopyResource(copy.Get(), texture.handle.Get());
        D3D11_MAPPED_SUBRESOURCE mapped;
        TRY(context->Map(copy.Get(), 0, D3D11_MAP_READ, 0, &mapped));
        copy_rows(pixels, texture.row_bytes(), mapped.pData, mapped.RowPitch, texture.height, texture.row_bytes());
        context->Unmap(copy.Get(), 0);
    }

    /* States and buffers that last as long as the device. */
    void set_states()
    {
        D3D11_SAMPLER_DESC description{};
        description.AddressU = description.AddressV = description.AddressW = D3D11_TEXTURE_ADDRESS_CLAMP;
        description.MaxAnisotropy = 1;
        description.ComparisonFunc = D3D11_COMPARISON_NEVER;
        description.MaxLOD = D3D11_FLOAT32_MAX;
        UINT slot = 0;
        for (D3D11_FILTER filter : {D3D11_FILTER_MIN_MAG_LINEAR_MIP_POINT, D3D11_FILTER_MIN_MAG_MIP_POINT}) {
            ComPtr<ID3D11SamplerState> sampler;
            description.Filter = filter;
            TRY(device->CreateSamplerState(&description, &sampler));
            context->PSSetSamplers(slot++, 1, sampler.GetAddressOf());
        }
        D3D11_BUFFER_DESC buffer{sizeof(float) * NUM_VALUES, D3D11_USAGE_DEFAULT, D3D11_BIND_CONSTANT_BUFFER, 0, 0, 0};
        TRY(device->CreateBuffer(&buffer, nullptr, &parameters));
        context->PSSetConstantBuffers(0, 1, parameters.GetAddressOf());
        context->IASetPrimitiveTopology(D3D11_PRIMITIVE_TOPOLOGY_TRIANGLELIST);
    }

    /* What the device is. */
    std::string start()
    {
        D3D_FEATURE_LEVEL level;
        TRY(D3D11CreateDevice(nullptr, D3D_DRIVER_TYPE_HARDWARE, nullptr, 0, nullptr, 0, D3D11_SDK_VERSION, &device,
                              &level, &context));
        if (level < D3D_FEATURE_LEVEL_11_0)
            fail("feature level %x: shader model 5 needs b000", level);
        set_states();
        char kind[64];
        snprintf(kind, sizeof kind, "Direct3D 11, feature level %x", level);
        return kind;
    }
};

int main() { return serve_device<D3D11>(); }
