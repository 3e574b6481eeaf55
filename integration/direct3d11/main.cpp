// SPDX-License-Identifier: MIT
//
// Depth of field on Direct3D 11, shader model 5.
//
//   direct3d11           a window: click to focus, 1 to 5 choose the method, D goes through the debug views
//   direct3d11 FOLDER    the same without a window to see; leaves its pictures in FOLDER, for the tests
//
// Run it in this folder: it compiles scene.hlsl and dof.hlsl.
#define _CRT_SECURE_NO_WARNINGS
#include <windows.h>
#include <windowsx.h>
#include <d3d11.h>
#include <d3dcompiler.h>
#include <dxgi.h>

#include <initializer_list>

#include "../direct3d9/capture.h"
#include "../direct3d9/scene.h"

constexpr int ZOOM = 2, MAX_TEXTURES = 8, MAX_COLORS = 6, MAX_TARGETS = 4, MAX_PASSES = 15, NUM_DEBUG_VIEWS = 4;

struct Target {
    int width, height;
    ID3D11Texture2D *texture;
    ID3D11RenderTargetView *target;
    ID3D11ShaderResourceView *view;
};

enum Shader {
    SCENE,
    DISPLAY,
    LINEAR_DEPTH,
    SIGNED_COC_MAP,
    COC_MAP,
    DEBUG_VIEW,
    HEXAGON_FIRST,
    HEXAGON_SECOND,
    OCTAGON_FIRST,
    OCTAGON_SECOND,
    LINE,
    LINE_FINAL,
    LAYER_TILES,
    LAYER_REACH,
    LAYER_SPLIT,
    LAYER_KERNELS,
    LAYER_SPREAD,
    LAYER_SIZES,
    LAYER_HOLES,
    LAYER_FILL,
    HEXAGON_LAYER_FIRST,
    HEXAGON_LAYER_SECOND,
    LAYERED,
    NUM_SHADERS
};

// The file, the entry, and BOKEH_NUM_SAMPLES: the most on an edge of an exact polygon, all on a line of the paper's.
static const struct {
    const wchar_t *file;
    const char *entry, *samples;
} SHADERS[NUM_SHADERS] = {
    {L"scene.hlsl", "Scene_PS", "13"},
    {L"scene.hlsl", "Display_PS", "13"},
    {L"dof.hlsl", "BokehLinearDepth_PS", "13"},
    {L"dof.hlsl", "BokehSignedCoCMap_PS", "13"},
    {L"dof.hlsl", "BokehCoCMap_PS", "13"},
    {L"dof.hlsl", "BokehDebug_PS", "13"},
    {L"dof.hlsl", "BokehHexagonFirst_PS", "33"},
    {L"dof.hlsl", "BokehHexagonSecond_PS", "33"},
    {L"dof.hlsl", "BokehOctagonFirst_PS", "33"},
    {L"dof.hlsl", "BokehOctagonSecond_PS", "33"},
    {L"dof.hlsl", "BokehDepthOfField_PS", "13"},
    {L"dof.hlsl", "BokehDepthOfFieldFinal_PS", "13"},
    {L"dof.hlsl", "BokehLayerTiles_PS", "13"},
    {L"dof.hlsl", "BokehLayerReach_PS", "13"},
    {L"dof.hlsl", "BokehLayerSplit_PS", "13"},
    {L"dof.hlsl", "BokehLayerKernels_PS", "13"},
    {L"dof.hlsl", "BokehLayerSpread_PS", "13"},
    {L"dof.hlsl", "BokehLayerSizes_PS", "13"},
    {L"dof.hlsl", "BokehLayerHoles_PS", "13"},
    {L"dof.hlsl", "BokehLayerFill_PS", "13"},
    {L"dof.hlsl", "BokehHexagonLayerFirst_PS", "13"},
    {L"dof.hlsl", "BokehHexagonLayerSecond_PS", "13"},
    {L"dof.hlsl", "BokehLayered_PS", "13"},
};

// One full-screen pass.
struct Pass {
    Shader shader;
    float number;             // degrees of a line; BokehAxis and BokehLayer of a pass of layers, which reads one of them
    Target *depth;            // t1
    Target *from[MAX_COLORS]; // BokehColorSamp, B to F
    Target *to[MAX_TARGETS];
};

// Registers of BokehColorSamp, B to F
static const int COLOR_REGISTERS[MAX_COLORS] = {0, 2, 3, 4, 6, 7};

struct Shot {
    const char *name, *method, *aperture;
    Pass passes[MAX_PASSES];
};

static Target color, z_buffer, depth, coc, t2, t3, t4, result;
// 1/8 of the size, 1/4 and 1/2
static Target tiles, rows, reach, tile_leftovers, tile_sums, row_leftovers, row_sums, reaches, sizes;
static Target middle_holes, far_holes, shares, middle, back;
static Target near_layer, far_layer, sums, leftovers, near2, near3, near_blurred, far2, far3, far_blurred;

// Depth buffer to metres
static const Pass MAKE_DEPTH = {LINEAR_DEPTH, 0, &z_buffer, {}, {&depth}};

static const Shot SHOTS[] = {
    {"layered-hexagon", "layered", "hexagon", {
        {SIGNED_COC_MAP, 0, &depth, {&color}, {&coc}},
        {LAYER_TILES, 0, nullptr, {&coc}, {&tiles}},
        {LAYER_REACH, 0, nullptr, {&tiles}, {&rows}},
        {LAYER_REACH, 1, nullptr, {&rows}, {&reach}},
        {LAYER_SPLIT, 0, nullptr, {&coc, &reach}, {&near_layer, &far_layer, &sums, &leftovers}},
        {LAYER_KERNELS, 0, nullptr, {&sums, &leftovers}, {&tile_leftovers, &tile_sums}},
        {LAYER_SPREAD, 0, nullptr, {&tile_leftovers, &tile_sums, &reach}, {&row_leftovers, &row_sums}},
        {LAYER_SIZES, 0, nullptr, {&row_leftovers, &row_sums, &reach}, {&reaches, &sizes}},
        {LAYER_HOLES, 0, nullptr, {&coc, &reach}, {&middle_holes, &far_holes, &shares}},
        {LAYER_FILL, 0, nullptr, {&middle_holes, &far_holes, &shares, &reach}, {&middle, &back}},
        {HEXAGON_LAYER_FIRST, 0, nullptr, {&near_layer, &sizes}, {&near2, &near3}},
        {HEXAGON_LAYER_SECOND, 0, nullptr, {&near2, &near3, nullptr, nullptr, &sizes}, {&near_blurred}},
        {HEXAGON_LAYER_FIRST, 1, nullptr, {&far_layer, &sizes}, {&far2, &far3}},
        {HEXAGON_LAYER_SECOND, 1, nullptr, {&far2, &far3, nullptr, nullptr, &sizes}, {&far_blurred}},
        {LAYERED, 0, nullptr, {&coc, &reaches, &near_blurred, &far_blurred, &middle, &back}, {&result}},
    }},
    {"exact-hexagon", "exact", "hexagon", {
        {SIGNED_COC_MAP, 0, &depth, {&color}, {&coc}},
        {HEXAGON_FIRST, 0, nullptr, {&coc}, {&t2, &t3}},
        {HEXAGON_SECOND, 0, nullptr, {&t2, &t3}, {&result}},
    }},
    {"exact-octagon", "exact", "octagon", {
        {SIGNED_COC_MAP, 0, &depth, {&color}, {&coc}},
        {OCTAGON_FIRST, 0, nullptr, {&coc}, {&t2, &t3, &t4}},
        {OCTAGON_SECOND, 0, nullptr, {&t2, &t3, &t4}, {&result}},
    }},
    {"paper-hexagon", "paper", "hexagon", {
        {COC_MAP, 0, &depth, {&color}, {&coc}},
        {LINE, 90, &depth, {&coc}, {&t2}},
        {LINE, 30, &depth, {&t2}, {&t3}},
        {LINE_FINAL, 150, &depth, {&t2, &t3}, {&result}},
    }},
    {"paper-octagon", "paper", "octagon", {
        {COC_MAP, 0, &depth, {&color}, {&coc}},
        {LINE, 0, &depth, {&coc}, {&t2}},
        {LINE, 90, &depth, {&t2}, {&t3}},
        {LINE, 45, &depth, {&coc}, {&t2}},
        {LINE_FINAL, 135, &depth, {&t2, &t3}, {&result}},
    }},
};
constexpr int NUM_SHOTS = sizeof SHOTS / sizeof SHOTS[0];

// The constant buffer b0 of the package's passes, as docs/parameters.md lists it: 40 floats, 160 bytes.
static struct alignas(16) {
    float apertureDiameter, focalLength, focusDistance, sensorHeight = 0.024f, maxCoC, constantCoC;
    float aspectRatio = (float)WIDTH / HEIGHT, angle, angleB;
    float bleedingBias = 0.02f, bleedingMult = 30.0f, blurCoC = 1.0f, useMax, debugMode;
    float lineLength = 1.0f, lineCenterX, lineCenterY, squeeze = 1.0f, spacing = 1.0f;
    float imageWidth = WIDTH, imageHeight = HEIGHT, jitter, frame, sides = 6.0f, edge;
    float depthKind = 1.0f, zNear = Z_NEAR, zFar = Z_FAR; // 1: 0 at the near plane, 1 at the far plane
    float viewportX, viewportY, textureWidth, textureHeight; // not read: the image fills its textures
    float passIndex, axis, layer, catsEye, roundness, lateral, axialRed, axialBlue;
} parameters;

static HWND window;
static ID3D11Device *device;
static ID3D11DeviceContext *context;
static IDXGISwapChain *swap_chain;
static ID3D11RenderTargetView *back_buffer;
static ID3D11DepthStencilView *z_buffer_target;
static ID3D11Buffer *triangles, *camera_buffer, *parameters_buffer;
static ID3D11InputLayout *layout;
static ID3D11VertexShader *scene_vertex_shader, *full_screen_vertex_shader;
static ID3D11PixelShader *shaders[NUM_SHADERS];
static ID3D11SamplerState *sampler;
static Camera camera;
static const Shot *shot = &SHOTS[0];
static int debug_view = -1; // -1: the finished picture

#define CHECK(call) check((call), #call)
static void check(HRESULT status, const char *call)
{
    if (FAILED(status)) {
        fprintf(stderr, "%s returned %08lx\n", call, (unsigned long)status);
        exit(1);
    }
}

// ---- what Direct3D is asked for once ----

static ID3D11Texture2D *make_texture(int width, int height, DXGI_FORMAT format, D3D11_USAGE usage, UINT bind,
                                     UINT access)
{
    const D3D11_TEXTURE2D_DESC wanted = {(UINT)width, (UINT)height, 1, 1, format, {1, 0}, usage, bind, access, 0};
    ID3D11Texture2D *texture;
    CHECK(device->CreateTexture2D(&wanted, nullptr, &texture));
    return texture;
}

static Target make_target(int width, int height, DXGI_FORMAT format)
{
    Target target = {width, height, nullptr, nullptr, nullptr};
    target.texture = make_texture(width, height, format, D3D11_USAGE_DEFAULT,
                                  D3D11_BIND_RENDER_TARGET | D3D11_BIND_SHADER_RESOURCE, 0);
    CHECK(device->CreateRenderTargetView(target.texture, nullptr, &target.target));
    CHECK(device->CreateShaderResourceView(target.texture, nullptr, &target.view));
    return target;
}

// Of 1 / scale of the size, rounded up
static void make_targets(std::initializer_list<Target *> targets, int scale)
{
    for (Target *target : targets)
        *target = make_target((WIDTH + scale - 1) / scale, (HEIGHT + scale - 1) / scale,
                              DXGI_FORMAT_R16G16B16A16_FLOAT);
}

static void make_targets()
{
    make_targets({&color, &coc, &t2, &t3, &t4, &result}, 1);
    make_targets({&near_layer, &far_layer, &sums, &leftovers}, 2);
    make_targets({&near2, &near3, &near_blurred, &far2, &far3, &far_blurred}, 2);
    make_targets({&middle_holes, &far_holes, &shares, &middle, &back}, 4);
    make_targets({&tiles, &rows, &reach, &tile_leftovers, &tile_sums, &row_leftovers, &row_sums, &reaches, &sizes}, 8);
    depth = make_target(WIDTH, HEIGHT, DXGI_FORMAT_R32_FLOAT);
}

// A depth buffer that shaders can read: without a type of its own, written as D32_FLOAT, read as R32_FLOAT.
static void make_z_buffer()
{
    ID3D11Texture2D *texture = make_texture(WIDTH, HEIGHT, DXGI_FORMAT_R32_TYPELESS, D3D11_USAGE_DEFAULT,
                                            D3D11_BIND_DEPTH_STENCIL | D3D11_BIND_SHADER_RESOURCE, 0);
    D3D11_DEPTH_STENCIL_VIEW_DESC written = {};
    written.Format = DXGI_FORMAT_D32_FLOAT;
    written.ViewDimension = D3D11_DSV_DIMENSION_TEXTURE2D;
    CHECK(device->CreateDepthStencilView(texture, &written, &z_buffer_target));
    D3D11_SHADER_RESOURCE_VIEW_DESC read = {};
    read.Format = DXGI_FORMAT_R32_FLOAT;
    read.ViewDimension = D3D11_SRV_DIMENSION_TEXTURE2D;
    read.Texture2D.MipLevels = 1;
    CHECK(device->CreateShaderResourceView(texture, &read, &z_buffer.view));
}

static ID3D11Buffer *make_buffer(const void *bytes, size_t size, UINT bind)
{
    const D3D11_BUFFER_DESC wanted = {(UINT)size, D3D11_USAGE_DEFAULT, bind, 0, 0, 0};
    const D3D11_SUBRESOURCE_DATA data = {bytes, 0, 0};
    ID3D11Buffer *buffer;
    CHECK(device->CreateBuffer(&wanted, &data, &buffer));
    return buffer;
}

static void make_buffers()
{
    triangles = make_buffer(vertices, num_vertices * sizeof vertices[0], D3D11_BIND_VERTEX_BUFFER);
    camera_buffer = make_buffer(&camera, sizeof camera, D3D11_BIND_CONSTANT_BUFFER);
    parameters_buffer = make_buffer(&parameters, sizeof parameters, D3D11_BIND_CONSTANT_BUFFER);
}

static ID3DBlob *compile(const wchar_t *file, const char *entry, const char *profile, const char *samples)
{
    const D3D_SHADER_MACRO defines[] = {{"BOKEH_NUM_SAMPLES", samples}, {nullptr, nullptr}};
    ID3DBlob *code = nullptr, *messages = nullptr;
    HRESULT status = D3DCompileFromFile(file, defines, D3D_COMPILE_STANDARD_FILE_INCLUDE, entry, profile, 0, 0, &code,
                                        &messages);
    if (FAILED(status)) {
        fprintf(stderr, "%s: %s\n", entry, messages ? (char *)messages->GetBufferPointer() : "no such file?");
        exit(1);
    }
    return code;
}

static void make_shaders()
{
    const D3D11_INPUT_ELEMENT_DESC elements[] = {
        {"POSITION", 0, DXGI_FORMAT_R32G32B32_FLOAT, 0, 0, D3D11_INPUT_PER_VERTEX_DATA, 0},
        {"RADIANCE", 0, DXGI_FORMAT_R32G32B32A32_FLOAT, 0, 12, D3D11_INPUT_PER_VERTEX_DATA, 0},
    };
    ID3DBlob *code = compile(L"scene.hlsl", "Scene_VS", "vs_5_0", "13");
    CHECK(device->CreateVertexShader(code->GetBufferPointer(), code->GetBufferSize(), nullptr, &scene_vertex_shader));
    CHECK(device->CreateInputLayout(elements, 2, code->GetBufferPointer(), code->GetBufferSize(), &layout));
    code = compile(L"dof.hlsl", "BokehFullScreen_VS", "vs_5_0", "13");
    CHECK(device->CreateVertexShader(code->GetBufferPointer(), code->GetBufferSize(), nullptr,
                                     &full_screen_vertex_shader));
    for (int i = 0; i < NUM_SHADERS; i++) {
        code = compile(SHADERS[i].file, SHADERS[i].entry, "ps_5_0", SHADERS[i].samples);
        CHECK(device->CreatePixelShader(code->GetBufferPointer(), code->GetBufferSize(), nullptr, &shaders[i]));
    }
}

// The sampler s0 that the passes expect: linear, clamp.
static void make_sampler()
{
    D3D11_SAMPLER_DESC wanted = {};
    wanted.AddressU = wanted.AddressV = wanted.AddressW = D3D11_TEXTURE_ADDRESS_CLAMP;
    wanted.ComparisonFunc = D3D11_COMPARISON_NEVER;
    wanted.MaxLOD = D3D11_FLOAT32_MAX;
    wanted.Filter = D3D11_FILTER_MIN_MAG_LINEAR_MIP_POINT;
    CHECK(device->CreateSamplerState(&wanted, &sampler));
}

static void make_device()
{
    const D3D_FEATURE_LEVEL level = D3D_FEATURE_LEVEL_11_0;
    DXGI_SWAP_CHAIN_DESC wanted = {};
    wanted.BufferDesc.Width = WIDTH * ZOOM;
    wanted.BufferDesc.Height = HEIGHT * ZOOM;
    wanted.BufferDesc.Format = DXGI_FORMAT_R8G8B8A8_UNORM;
    wanted.SampleDesc.Count = 1;
    wanted.BufferUsage = DXGI_USAGE_RENDER_TARGET_OUTPUT;
    wanted.BufferCount = 1;
    wanted.OutputWindow = window;
    wanted.Windowed = TRUE;
    CHECK(D3D11CreateDeviceAndSwapChain(nullptr, D3D_DRIVER_TYPE_HARDWARE, nullptr, 0, &level, 1, D3D11_SDK_VERSION,
                                        &wanted, &swap_chain, &device, nullptr, &context));
    ID3D11Texture2D *texture;
    CHECK(swap_chain->GetBuffer(0, IID_ID3D11Texture2D, (void **)&texture));
    CHECK(device->CreateRenderTargetView(texture, nullptr, &back_buffer));
}

// ---- the scene: colour and depth buffer ----

static void set_viewport(int left, int width, int height)
{
    const D3D11_VIEWPORT viewport = {(float)left, 0, (float)width, (float)height, 0, 1};
    context->RSSetViewports(1, &viewport);
}

static void draw_scene()
{
    const float black[4] = {0, 0, 0, 1};
    const UINT stride = sizeof vertices[0], offset = 0;
    ID3D11ShaderResourceView *const none[MAX_TEXTURES] = {};
    context->PSSetShaderResources(0, MAX_TEXTURES, none);
    context->OMSetRenderTargets(1, &color.target, z_buffer_target);
    context->ClearRenderTargetView(color.target, black);
    context->ClearDepthStencilView(z_buffer_target, D3D11_CLEAR_DEPTH, 1.0f, 0);
    set_viewport(0, WIDTH, HEIGHT);
    context->IASetInputLayout(layout);
    context->IASetVertexBuffers(0, 1, &triangles, &stride, &offset);
    context->IASetPrimitiveTopology(D3D11_PRIMITIVE_TOPOLOGY_TRIANGLELIST);
    context->VSSetConstantBuffers(0, 1, &camera_buffer);
    context->VSSetShader(scene_vertex_shader, nullptr, 0);
    context->PSSetShader(shaders[SCENE], nullptr, 0);
    context->Draw(num_vertices, 0);
}

// ---- the effect ----

// Three vertices without a buffer: BokehFullScreen_VS makes them.
static void draw_full_screen(Shader shader)
{
    context->UpdateSubresource(parameters_buffer, 0, nullptr, &parameters, 0, 0);
    context->PSSetConstantBuffers(0, 1, &parameters_buffer);
    context->PSSetSamplers(0, 1, &sampler);
    context->IASetInputLayout(nullptr);
    context->IASetPrimitiveTopology(D3D11_PRIMITIVE_TOPOLOGY_TRIANGLELIST);
    context->VSSetShader(full_screen_vertex_shader, nullptr, 0);
    context->PSSetShader(shaders[shader], nullptr, 0);
    context->Draw(3, 0);
}

// A texture cannot be read while it is a target: first nothing is read, then the targets, then what is read.
static void set_textures(ID3D11RenderTargetView *const *targets, int num_targets, ID3D11ShaderResourceView *const *read)
{
    ID3D11ShaderResourceView *const none[MAX_TEXTURES] = {};
    context->PSSetShaderResources(0, MAX_TEXTURES, none);
    context->OMSetRenderTargets(num_targets, targets, nullptr);
    context->PSSetShaderResources(0, MAX_TEXTURES, read);
}

static void draw_pass(const Pass &pass)
{
    ID3D11RenderTargetView *targets[MAX_TARGETS] = {};
    ID3D11ShaderResourceView *read[MAX_TEXTURES] = {};
    int num_targets = 0;
    while (num_targets < MAX_TARGETS && pass.to[num_targets]) {
        targets[num_targets] = pass.to[num_targets]->target;
        num_targets++;
    }
    for (int i = 0; i < MAX_COLORS; i++)
        read[COLOR_REGISTERS[i]] = pass.from[i] ? pass.from[i]->view : nullptr;
    read[1] = pass.depth ? pass.depth->view : nullptr;
    set_textures(targets, num_targets, read);
    set_viewport(0, pass.to[0]->width, pass.to[0]->height);
    const bool is_line = pass.shader == LINE || pass.shader == LINE_FINAL;
    parameters.angle = is_line ? pass.number * PI / 180.0f : 0.0f; // elsewhere the rotation of the polygon
    parameters.axis = parameters.layer = pass.number;
    draw_full_screen(pass.shader);
}

// From `color` and the depth buffer to `result`.
static void draw_depth_of_field()
{
    draw_pass(MAKE_DEPTH);
    for (int i = 0; i < MAX_PASSES && shot->passes[i].to[0]; i++)
        draw_pass(shot->passes[i]);
}

// ---- the screen ----

// A part of the screen: an HDR picture tone-mapped, or, where `shader` is DEBUG_VIEW, a debug view of the CoC map.
static void show(Shader shader, const Target &picture, ID3D11RenderTargetView *screen, int left, int width, int height)
{
    ID3D11ShaderResourceView *const read[MAX_TEXTURES] = {picture.view, depth.view};
    set_textures(&screen, 1, read);
    set_viewport(left, width, height);
    draw_full_screen(shader);
}

static void draw_frame()
{
    draw_scene();
    draw_depth_of_field();
    if (debug_view < 0) {
        show(DISPLAY, result, back_buffer, 0, WIDTH * ZOOM, HEIGHT * ZOOM);
    } else {
        parameters.debugMode = (float)debug_view;
        show(DEBUG_VIEW, coc, back_buffer, 0, WIDTH * ZOOM, HEIGHT * ZOOM);
    }
}

// ---- focus ----

// Rows of a target, from the upper one on, without gaps.
static void read_back(const Target &target, int texel_bytes, void *pixels)
{
    const int width = target.width, height = target.height;
    D3D11_TEXTURE2D_DESC known;
    D3D11_MAPPED_SUBRESOURCE mapped;
    target.texture->GetDesc(&known);
    ID3D11Texture2D *copy = make_texture(width, height, known.Format, D3D11_USAGE_STAGING, 0, D3D11_CPU_ACCESS_READ);
    context->CopyResource(copy, target.texture);
    CHECK(context->Map(copy, 0, D3D11_MAP_READ, 0, &mapped));
    for (int row = 0; row < height; row++)
        memcpy((char *)pixels + row * width * texel_bytes, (char *)mapped.pData + row * mapped.RowPitch,
               (size_t)width * texel_bytes);
    context->Unmap(copy, 0);
    copy->Release();
}

// The depths that the focus goes to.
static float aimed[NUM_AIMS];

// On a place in the world.
static void focus_on_place(const float place[3])
{
    parameters.focusDistance = view_depth(&camera, place);
    for (int i = 0; i < NUM_AIMS; i++)
        aimed[i] = parameters.focusDistance;
}

// At what is seen at a pixel of the last frame and around it.
static void aim_at(int x, int y)
{
    static float metres[HEIGHT][WIDTH];
    read_back(depth, sizeof(float), metres);
    for (int i = 0; i < NUM_AIMS; i++) {
        const int column = x + AIMS[i][0], row = y + AIMS[i][1];
        const int inside = column >= 0 && column < WIDTH && row >= 0 && row < HEIGHT;
        aimed[i] = inside ? metres[row][column] : metres[y][x];
    }
}

// Each frame, with the seconds that it took. INFINITY: there at once.
static void pull_focus(float seconds)
{
    parameters.focusDistance = pulled_focus(parameters.focusDistance, aimed, seconds, PULL_SECONDS);
}

// ---- the program ----

static LRESULT CALLBACK on_message(HWND owner, UINT message, WPARAM w, LPARAM l)
{
    if (message == WM_LBUTTONDOWN)
        aim_at(GET_X_LPARAM(l) / ZOOM, GET_Y_LPARAM(l) / ZOOM);
    else if (message == WM_KEYDOWN && w >= '1' && w < '1' + NUM_SHOTS)
        shot = &SHOTS[w - '1'];
    else if (message == WM_KEYDOWN && w == 'D')
        debug_view = debug_view + 1 < NUM_DEBUG_VIEWS ? debug_view + 1 : -1;
    else if (message == WM_DESTROY)
        PostQuitMessage(0);
    else
        return DefWindowProcA(owner, message, w, l);
    return 0;
}

static void make_window()
{
    WNDCLASSA kind = {};
    RECT area = {0, 0, WIDTH * ZOOM, HEIGHT * ZOOM};
    const DWORD style = WS_OVERLAPPED | WS_CAPTION | WS_SYSMENU;
    kind.lpfnWndProc = on_message;
    kind.hInstance = GetModuleHandleA(nullptr);
    kind.lpszClassName = "bokeh";
    kind.hCursor = LoadCursor(nullptr, IDC_CROSS);
    RegisterClassA(&kind);
    AdjustWindowRect(&area, style, FALSE);
    window = CreateWindowA("bokeh", "Polygonal bokeh, Direct3D 11", style, CW_USEDEFAULT, CW_USEDEFAULT,
                           area.right - area.left, area.bottom - area.top, nullptr, nullptr, kind.hInstance, nullptr);
    if (!window) {
        fprintf(stderr, "no window: no display?\n");
        exit(1);
    }
}

static void run()
{
    MSG message = {};
    ULONGLONG last = GetTickCount64();
    ShowWindow(window, SW_SHOW);
    while (message.message != WM_QUIT) {
        const ULONGLONG now = GetTickCount64();
        pull_focus((now - last) * 0.001f);
        last = now;
        draw_frame();
        CHECK(swap_chain->Present(1, 0));
        while (message.message != WM_QUIT && PeekMessageA(&message, nullptr, 0, 0, PM_REMOVE))
            DispatchMessageA(&message);
    }
}

static void adapter_name(char *name, int size)
{
    IDXGIDevice *dxgi;
    IDXGIAdapter *adapter;
    DXGI_ADAPTER_DESC known;
    CHECK(device->QueryInterface(IID_IDXGIDevice, (void **)&dxgi));
    CHECK(dxgi->GetAdapter(&adapter));
    CHECK(adapter->GetDesc(&known));
    WideCharToMultiByte(CP_UTF8, 0, known.Description, -1, name, size, nullptr, nullptr);
}

// All that the passes of a shot wrote, one target after the other.
static void write_targets(const char *folder, const Shot &written)
{
    static char pixels[WIDTH * HEIGHT * 8];
    char name[64];
    snprintf(name, sizeof name, "%s.written", written.name);
    FILE *file = open_file(folder, name);
    for (const Pass &pass : written.passes)
        for (const Target *target : pass.to)
            if (target) {
                read_back(*target, 8, pixels);
                fwrite(pixels, 8, (size_t)target->width * target->height, file);
            }
    close_file(file, folder, name);
}

// Every shot for the tests, and a picture: sharp, near and far field, blurred.
static void capture(const char *folder)
{
    static char pixels[WIDTH * HEIGHT * 3 * 8];
    CapturedShot shots[NUM_SHOTS];
    Target picture = make_target(WIDTH * 3, HEIGHT, DXGI_FORMAT_B8G8R8A8_UNORM);
    for (int i = 0; i < NUM_SHOTS; i++) {
        char name[64];
        shot = &SHOTS[i];
        draw_frame();
        read_back(result, 8, pixels);
        snprintf(name, sizeof name, "%s.f16", shot->name);
        write_file(folder, name, pixels, WIDTH * HEIGHT * 8);
        if (!strcmp(shot->method, "layered"))
            write_targets(folder, *shot);
        shots[i] = {shot->name, shot->method, shot->aperture, parameters.focusDistance};
        if (i == 0) {
            parameters.debugMode = 3.0f;
            show(DISPLAY, color, picture.target, 0, WIDTH, HEIGHT);
            show(DEBUG_VIEW, coc, picture.target, WIDTH, WIDTH, HEIGHT);
            show(DISPLAY, result, picture.target, WIDTH * 2, WIDTH, HEIGHT);
        }
        // the shots after the first are focused on the subject as one that clicks on it does
        aim_at(WIDTH * 9 / 20, HEIGHT / 2);
        pull_focus(INFINITY);
    }
    read_back(picture, 4, pixels);
    write_bmp(folder, "picture.bmp", pixels, WIDTH * 3, HEIGHT);
    read_back(color, 8, pixels);
    write_file(folder, "color.f16", pixels, WIDTH * HEIGHT * 8);
    read_back(depth, 4, pixels);
    write_file(folder, "depth.f32", pixels, WIDTH * HEIGHT * 4);
    char name[256];
    adapter_name(name, sizeof name);
    CapturedPull pulled = {136, 32, 1.0f / 30.0f, PULL_SECONDS, parameters.focusDistance, {}, {}};
    aim_at(pulled.x, pulled.y);
    memcpy(pulled.depths, aimed, sizeof aimed);
    for (int i = 0; i < NUM_PULLED; i++) {
        pull_focus(pulled.frame);
        pulled.distances[i] = parameters.focusDistance;
    }
    write_capture(folder, "Direct3D 11", name, shots, NUM_SHOTS, &pulled);
}

int main(int argc, char **argv)
{
    make_window();
    make_device();
    make_scene();
    camera = make_camera();
    make_targets();
    make_z_buffer();
    make_buffers();
    make_shaders();
    make_sampler();
    parameters.focalLength = focal_length();
    parameters.apertureDiameter = parameters.focalLength / F_STOP;
    parameters.maxCoC = MAX_COC;
    focus_on_place(SUBJECT);
    if (argc > 1)
        capture(argv[1]);
    else
        run();
}
