/* SPDX-License-Identifier: MIT
 *
 * Depth of field on Direct3D 9, shader model 3.
 *
 *   direct3d9           a window: click to focus, 1 to 4 choose the shape, D goes through the debug views
 *   direct3d9 FOLDER    the same without a window to see; leaves its pictures in FOLDER, for the tests
 *
 * Run it in this folder: it compiles scene.hlsl and dof.hlsl.
 */
#define COBJMACROS
#define _CRT_SECURE_NO_WARNINGS
#include <windows.h>
#include <windowsx.h>
#include <d3d9.h>
#include <d3dcompiler.h>

#include "../parameters/BokehParameters.h"
#include "capture.h"
#include "scene.h"

enum { ZOOM = 2, MAX_INPUTS = 4, MAX_TARGETS = 3, MAX_PASSES = 5, NUM_DEBUG_VIEWS = 4 };
enum { NUM_PARAMETERS = sizeof(struct BokehParameters) / sizeof(float) };

typedef struct {
    IDirect3DTexture9 *texture;
    IDirect3DSurface9 *surface;
    D3DFORMAT format;
} Target;

typedef enum {
    SCENE_COLOR,
    SCENE_DEPTH,
    DISPLAY,
    SIGNED_COC_MAP,
    COC_MAP,
    DEBUG_VIEW,
    HEXAGON_FIRST,
    HEXAGON_SECOND,
    OCTAGON_FIRST,
    OCTAGON_SECOND,
    LINE,
    LINE_FINAL,
    NUM_SHADERS
} Shader;

static const struct {
    const wchar_t *file;
    const char *entry;
} SHADERS[NUM_SHADERS] = {
    [SCENE_COLOR] = {L"scene.hlsl", "SceneColor_PS"},
    [SCENE_DEPTH] = {L"scene.hlsl", "SceneDepth_PS"},
    [DISPLAY] = {L"scene.hlsl", "Display_PS"},
    [SIGNED_COC_MAP] = {L"dof.hlsl", "BokehSignedCoCMap_PS"},
    [COC_MAP] = {L"dof.hlsl", "BokehCoCMap_PS"},
    [DEBUG_VIEW] = {L"dof.hlsl", "BokehDebug_PS"},
    [HEXAGON_FIRST] = {L"dof.hlsl", "BokehHexagonFirst_PS"},
    [HEXAGON_SECOND] = {L"dof.hlsl", "BokehHexagonSecond_PS"},
    [OCTAGON_FIRST] = {L"dof.hlsl", "BokehOctagonFirst_PS"},
    [OCTAGON_SECOND] = {L"dof.hlsl", "BokehOctagonSecond_PS"},
    [LINE] = {L"dof.hlsl", "BokehDepthOfField_PS"},
    [LINE_FINAL] = {L"dof.hlsl", "BokehDepthOfFieldFinal_PS"},
};

/* One full-screen pass. */
typedef struct {
    Shader shader;
    float degrees;            /* of its line; an exact polygon's rotation */
    Target *from[MAX_INPUTS]; /* s0 to s3; s1 is the depth, where a pass reads it */
    Target *to[MAX_TARGETS];
} Pass;

typedef struct {
    const char *name, *method, *aperture;
    Pass passes[MAX_PASSES];
} Shot;

static Target color, depth, coc, t2, t3, t4, result;

static const Shot SHOTS[] = {
    {"exact-hexagon", "exact", "hexagon", {
        {SIGNED_COC_MAP, 0, {&color, &depth}, {&coc}},
        {HEXAGON_FIRST, 0, {&coc}, {&t2, &t3}},
        {HEXAGON_SECOND, 0, {&t2, NULL, &t3}, {&result}},
    }},
    {"exact-octagon", "exact", "octagon", {
        {SIGNED_COC_MAP, 0, {&color, &depth}, {&coc}},
        {OCTAGON_FIRST, 0, {&coc}, {&t2, &t3, &t4}},
        {OCTAGON_SECOND, 0, {&t2, NULL, &t3, &t4}, {&result}},
    }},
    {"paper-hexagon", "paper", "hexagon", {
        {COC_MAP, 0, {&color, &depth}, {&coc}},
        {LINE, 90, {&coc, &depth}, {&t2}},
        {LINE, 30, {&t2, &depth}, {&t3}},
        {LINE_FINAL, 150, {&t2, &depth, &t3}, {&result}},
    }},
    {"paper-octagon", "paper", "octagon", {
        {COC_MAP, 0, {&color, &depth}, {&coc}},
        {LINE, 0, {&coc, &depth}, {&t2}},
        {LINE, 90, {&t2, &depth}, {&t3}},
        {LINE, 45, {&coc, &depth}, {&t2}},
        {LINE_FINAL, 135, {&t2, &depth, &t3}, {&result}},
    }},
};
enum { NUM_SHOTS = sizeof SHOTS / sizeof SHOTS[0] };

/* Registers c0 and up of the package's passes, as docs/reference/parameters.md lists them. */
static struct BokehParameters parameters = {
    .SensorHeight = 0.024f,
    .BleedingBias = 0.02f,
    .BleedingMult = 30.0f,
    .BlurCoC = 1.0f,
    .LineLength = 1.0f,
    .Squeeze = 1.0f,
    .AspectRatio = (float)WIDTH / HEIGHT,
    .ImageWidth = WIDTH,
    .ImageHeight = HEIGHT,
};

static HWND window;
static IDirect3D9 *direct3d;
static IDirect3DDevice9 *device;
static IDirect3DPixelShader9 *shaders[NUM_SHADERS];
static IDirect3DVertexShader9 *scene_vertex_shader, *quad_vertex_shader;
static IDirect3DSurface9 *back_buffer, *z_buffer;
static Camera camera;
static const Shot *shot = &SHOTS[0];
static int debug_view = -1; /* -1: the finished picture */

#define CHECK(call) check((call), #call)
static void check(HRESULT status, const char *call)
{
    if (FAILED(status)) {
        fprintf(stderr, "%s returned %08lx\n", call, (unsigned long)status);
        exit(1);
    }
}

/* ---- what Direct3D is asked for once ---- */

static Target make_target(int width, int height, D3DFORMAT format)
{
    Target target = {.format = format};
    CHECK(IDirect3DDevice9_CreateTexture(device, width, height, 1, D3DUSAGE_RENDERTARGET, format, D3DPOOL_DEFAULT,
                                         &target.texture, NULL));
    CHECK(IDirect3DTexture9_GetSurfaceLevel(target.texture, 0, &target.surface));
    return target;
}

static void make_targets(void)
{
    Target *half_floats[] = {&color, &coc, &t2, &t3, &t4, &result};
    for (int i = 0; i < 6; i++)
        *half_floats[i] = make_target(WIDTH, HEIGHT, D3DFMT_A16B16G16R16F);
    depth = make_target(WIDTH, HEIGHT, D3DFMT_R32F);
    CHECK(IDirect3DDevice9_CreateDepthStencilSurface(device, WIDTH, HEIGHT, D3DFMT_D24X8, D3DMULTISAMPLE_NONE, 0, TRUE,
                                                     &z_buffer, NULL));
}

static const DWORD *compile(const wchar_t *file, const char *entry, const char *profile)
{
    ID3DBlob *code = NULL, *messages = NULL;
    HRESULT status = D3DCompileFromFile(file, NULL, D3D_COMPILE_STANDARD_FILE_INCLUDE, entry, profile, 0, 0, &code,
                                        &messages);
    if (FAILED(status)) {
        fprintf(stderr, "%s: %s\n", entry, messages ? (char *)ID3D10Blob_GetBufferPointer(messages) : "no such file?");
        exit(1);
    }
    return (const DWORD *)ID3D10Blob_GetBufferPointer(code);
}

static void make_shaders(void)
{
    CHECK(IDirect3DDevice9_CreateVertexShader(device, compile(L"scene.hlsl", "Scene_VS", "vs_3_0"),
                                              &scene_vertex_shader));
    CHECK(IDirect3DDevice9_CreateVertexShader(device, compile(L"dof.hlsl", "BokehFullScreen_VS", "vs_3_0"),
                                              &quad_vertex_shader));
    for (int i = 0; i < NUM_SHADERS; i++)
        CHECK(IDirect3DDevice9_CreatePixelShader(device, compile(SHADERS[i].file, SHADERS[i].entry, "ps_3_0"),
                                                 &shaders[i]));
}

static void make_device(void)
{
    D3DPRESENT_PARAMETERS present = {
        .Windowed = TRUE,
        .SwapEffect = D3DSWAPEFFECT_DISCARD,
        .BackBufferWidth = WIDTH * ZOOM,
        .BackBufferHeight = HEIGHT * ZOOM,
        .BackBufferFormat = D3DFMT_X8R8G8B8,
        .hDeviceWindow = window,
    };
    D3DCAPS9 caps;
    direct3d = Direct3DCreate9(D3D_SDK_VERSION);
    if (!direct3d) {
        fprintf(stderr, "no Direct3D 9\n");
        exit(1);
    }
    CHECK(IDirect3D9_CreateDevice(direct3d, D3DADAPTER_DEFAULT, D3DDEVTYPE_HAL, window,
                                  D3DCREATE_HARDWARE_VERTEXPROCESSING, &present, &device));
    CHECK(IDirect3DDevice9_GetDeviceCaps(device, &caps));
    if (caps.NumSimultaneousRTs < MAX_TARGETS) {
        fprintf(stderr, "this card has %lu targets at once: use BokehExactEdge_PS\n", caps.NumSimultaneousRTs);
        exit(1);
    }
    CHECK(IDirect3DDevice9_GetRenderTarget(device, 0, &back_buffer));
    CHECK(IDirect3DDevice9_SetRenderState(device, D3DRS_CULLMODE, D3DCULL_NONE));
    /* alpha is the CoC, not opacity */
    CHECK(IDirect3DDevice9_SetRenderState(device, D3DRS_ALPHABLENDENABLE, FALSE));
}

/* ---- the scene: colour and depth ---- */

static void draw_triangles(Shader shader, Target *target)
{
    CHECK(IDirect3DDevice9_SetRenderTarget(device, 0, target->surface));
    CHECK(IDirect3DDevice9_Clear(device, 0, NULL, D3DCLEAR_TARGET | D3DCLEAR_ZBUFFER, 0, 1.0f, 0));
    CHECK(IDirect3DDevice9_SetPixelShader(device, shaders[shader]));
    CHECK(IDirect3DDevice9_DrawPrimitiveUP(device, D3DPT_TRIANGLELIST, num_vertices / 3, vertices, sizeof vertices[0]));
}

/* Twice: into the colour and, by SceneDepth_PS, into the depth. In one go where your card has targets of different
 * widths at once (D3DPMISCCAPS_MRTINDEPENDENTBITDEPTHS). */
static void draw_scene(void)
{
    for (int i = 1; i < MAX_TARGETS; i++)
        CHECK(IDirect3DDevice9_SetRenderTarget(device, i, NULL));
    CHECK(IDirect3DDevice9_SetDepthStencilSurface(device, z_buffer));
    CHECK(IDirect3DDevice9_SetRenderState(device, D3DRS_ZENABLE, TRUE));
    CHECK(IDirect3DDevice9_SetFVF(device, D3DFVF_XYZ | D3DFVF_TEX1 | D3DFVF_TEXCOORDSIZE4(0)));
    CHECK(IDirect3DDevice9_SetVertexShader(device, scene_vertex_shader));
    CHECK(IDirect3DDevice9_SetVertexShaderConstantF(device, 0, camera.eye, sizeof camera / sizeof camera.eye));
    draw_triangles(SCENE_COLOR, &color);
    draw_triangles(SCENE_DEPTH, &depth);
}

/* ---- the effect ---- */

/* Parameter i goes to register c(i), into its x. */
static void set_parameters(void)
{
    const float *values = (const float *)&parameters;
    float registers[NUM_PARAMETERS][4] = {{0}};
    for (int i = 0; i < NUM_PARAMETERS; i++)
        registers[i][0] = values[i];
    CHECK(IDirect3DDevice9_SetPixelShaderConstantF(device, 0, registers[0], NUM_PARAMETERS));
}

static void set_texture(int slot, const Target *target, D3DTEXTUREFILTERTYPE filter)
{
    CHECK(IDirect3DDevice9_SetTexture(device, slot, target ? (IDirect3DBaseTexture9 *)target->texture : NULL));
    CHECK(IDirect3DDevice9_SetSamplerState(device, slot, D3DSAMP_MINFILTER, filter));
    CHECK(IDirect3DDevice9_SetSamplerState(device, slot, D3DSAMP_MAGFILTER, filter));
    CHECK(IDirect3DDevice9_SetSamplerState(device, slot, D3DSAMP_ADDRESSU, D3DTADDRESS_CLAMP));
    CHECK(IDirect3DDevice9_SetSamplerState(device, slot, D3DSAMP_ADDRESSV, D3DTADDRESS_CLAMP));
}

/* A quad over the viewport. BokehFullScreen_VS moves it by half a pixel of what c20 says: Direct3D 9 has its pixel
 * centres at whole numbers. */
static void draw_quad(Shader shader, int width, int height)
{
    static const float STRIP[4][5] = {{-1, 1, 0, 0, 0}, {1, 1, 0, 1, 0}, {-1, -1, 0, 0, 1}, {1, -1, 0, 1, 1}};
    const float texel_size[4] = {1.0f / width, 1.0f / height, 0, 0};
    CHECK(IDirect3DDevice9_SetDepthStencilSurface(device, NULL));
    CHECK(IDirect3DDevice9_SetRenderState(device, D3DRS_ZENABLE, FALSE));
    CHECK(IDirect3DDevice9_SetFVF(device, D3DFVF_XYZ | D3DFVF_TEX1));
    CHECK(IDirect3DDevice9_SetVertexShader(device, quad_vertex_shader));
    CHECK(IDirect3DDevice9_SetVertexShaderConstantF(device, 20, texel_size, 1));
    CHECK(IDirect3DDevice9_SetPixelShader(device, shaders[shader]));
    CHECK(IDirect3DDevice9_DrawPrimitiveUP(device, D3DPT_TRIANGLESTRIP, 2, STRIP, sizeof STRIP[0]));
}

static void draw_pass(const Pass *pass)
{
    for (int i = 0; i < MAX_TARGETS; i++)
        CHECK(IDirect3DDevice9_SetRenderTarget(device, i, pass->to[i] ? pass->to[i]->surface : NULL));
    /* colour and depth are copied texel by texel, all else is sampled between texels */
    for (int i = 0; i < MAX_INPUTS; i++)
        set_texture(i, pass->from[i], pass->from[i] == &color || i == 1 ? D3DTEXF_POINT : D3DTEXF_LINEAR);
    parameters.Angle = pass->degrees * PI / 180.0f;
    set_parameters();
    draw_quad(pass->shader, WIDTH, HEIGHT);
}

/* From `color` and `depth` to `result`. */
static void draw_depth_of_field(void)
{
    for (int i = 0; i < MAX_PASSES && shot->passes[i].to[0]; i++)
        draw_pass(&shot->passes[i]);
}

/* ---- the screen ---- */

/* A part of the screen: an HDR picture tone-mapped, or, where `shader` is DEBUG_VIEW, a debug view of the CoC map. */
static void show(Shader shader, Target *picture, IDirect3DSurface9 *screen, int left, int width, int height)
{
    const D3DVIEWPORT9 viewport = {left, 0, width, height, 0, 1};
    for (int i = 1; i < MAX_TARGETS; i++)
        CHECK(IDirect3DDevice9_SetRenderTarget(device, i, NULL));
    CHECK(IDirect3DDevice9_SetRenderTarget(device, 0, screen));
    CHECK(IDirect3DDevice9_SetViewport(device, &viewport));
    set_texture(0, picture, D3DTEXF_POINT);
    set_texture(1, &depth, D3DTEXF_POINT);
    set_parameters();
    draw_quad(shader, width, height);
}

static void draw_frame(void)
{
    CHECK(IDirect3DDevice9_BeginScene(device));
    draw_scene();
    draw_depth_of_field();
    if (debug_view < 0) {
        show(DISPLAY, &result, back_buffer, 0, WIDTH * ZOOM, HEIGHT * ZOOM);
    } else {
        parameters.DebugMode = (float)debug_view;
        show(DEBUG_VIEW, &coc, back_buffer, 0, WIDTH * ZOOM, HEIGHT * ZOOM);
    }
    CHECK(IDirect3DDevice9_EndScene(device));
}

/* ---- focus ---- */

/* Rows of a target, from the upper one on, without gaps. */
static void read_back(const Target *target, int width, int height, int texel_bytes, void *pixels)
{
    IDirect3DSurface9 *copy;
    D3DLOCKED_RECT locked;
    CHECK(IDirect3DDevice9_CreateOffscreenPlainSurface(device, width, height, target->format, D3DPOOL_SYSTEMMEM, &copy,
                                                       NULL));
    CHECK(IDirect3DDevice9_GetRenderTargetData(device, target->surface, copy));
    CHECK(IDirect3DSurface9_LockRect(copy, &locked, NULL, D3DLOCK_READONLY));
    for (int row = 0; row < height; row++)
        memcpy((char *)pixels + row * width * texel_bytes, (char *)locked.pBits + row * locked.Pitch,
               (size_t)width * texel_bytes);
    CHECK(IDirect3DSurface9_UnlockRect(copy));
    IDirect3DSurface9_Release(copy);
}

/* The depths that the focus goes to. */
static float aimed[NUM_AIMS];

/* On a place in the world. */
static void focus_on_place(const float place[3])
{
    parameters.FocusDistance = view_depth(&camera, place);
    for (int i = 0; i < NUM_AIMS; i++)
        aimed[i] = parameters.FocusDistance;
}

/* At what is seen at a pixel of the last frame and around it. */
static void aim_at(int x, int y)
{
    static float metres[HEIGHT][WIDTH];
    read_back(&depth, WIDTH, HEIGHT, sizeof(float), metres);
    for (int i = 0; i < NUM_AIMS; i++) {
        const int column = x + AIMS[i][0], row = y + AIMS[i][1];
        const int inside = column >= 0 && column < WIDTH && row >= 0 && row < HEIGHT;
        aimed[i] = inside ? metres[row][column] : metres[y][x];
    }
}

/* Each frame, with the seconds that it took. INFINITY: there at once. */
static void pull_focus(float seconds)
{
    parameters.FocusDistance = pulled_focus(parameters.FocusDistance, aimed, seconds, PULL_SECONDS);
}

/* ---- the program ---- */

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

static void make_window(void)
{
    WNDCLASSA class = {.lpfnWndProc = on_message, .hInstance = GetModuleHandleA(NULL), .lpszClassName = "bokeh"};
    RECT area = {0, 0, WIDTH * ZOOM, HEIGHT * ZOOM};
    const DWORD style = WS_OVERLAPPED | WS_CAPTION | WS_SYSMENU;
    class.hCursor = LoadCursor(NULL, IDC_CROSS);
    RegisterClassA(&class);
    AdjustWindowRect(&area, style, FALSE);
    window = CreateWindowA("bokeh", "Polygonal bokeh, Direct3D 9", style, CW_USEDEFAULT, CW_USEDEFAULT,
                           area.right - area.left, area.bottom - area.top, NULL, NULL, class.hInstance, NULL);
    if (!window) {
        fprintf(stderr, "no window: no display?\n");
        exit(1);
    }
}

static void run(void)
{
    MSG message = {0};
    ULONGLONG last = GetTickCount64();
    ShowWindow(window, SW_SHOW);
    while (message.message != WM_QUIT) {
        const ULONGLONG now = GetTickCount64();
        pull_focus((now - last) * 0.001f);
        last = now;
        draw_frame();
        /* a lost device is not restored here: the sample ends */
        CHECK(IDirect3DDevice9_Present(device, NULL, NULL, NULL, NULL));
        while (message.message != WM_QUIT && PeekMessageA(&message, NULL, 0, 0, PM_REMOVE))
            DispatchMessageA(&message);
    }
}

/* Every shot for the tests, and a picture: sharp, near and far field, blurred. */
static void capture(const char *folder)
{
    static char pixels[WIDTH * HEIGHT * 3 * 8];
    CapturedShot shots[NUM_SHOTS];
    D3DADAPTER_IDENTIFIER9 adapter;
    Target picture = make_target(WIDTH * 3, HEIGHT, D3DFMT_X8R8G8B8);
    for (int i = 0; i < NUM_SHOTS; i++) {
        char name[64];
        shot = &SHOTS[i];
        draw_frame();
        read_back(&result, WIDTH, HEIGHT, 8, pixels);
        snprintf(name, sizeof name, "%s.f16", shot->name);
        write_file(folder, name, pixels, WIDTH * HEIGHT * 8);
        shots[i] = (CapturedShot){shot->name, shot->method, shot->aperture, parameters.FocusDistance};
        if (i == 0) {
            CHECK(IDirect3DDevice9_BeginScene(device));
            parameters.DebugMode = 3.0f;
            show(DISPLAY, &color, picture.surface, 0, WIDTH, HEIGHT);
            show(DEBUG_VIEW, &coc, picture.surface, WIDTH, WIDTH, HEIGHT);
            show(DISPLAY, &result, picture.surface, WIDTH * 2, WIDTH, HEIGHT);
            CHECK(IDirect3DDevice9_EndScene(device));
        }
        /* the shots after the first are focused on the subject as one that clicks on it does */
        aim_at(WIDTH * 9 / 20, HEIGHT / 2);
        pull_focus(INFINITY);
    }
    read_back(&picture, WIDTH * 3, HEIGHT, 4, pixels);
    write_bmp(folder, "picture.bmp", pixels, WIDTH * 3, HEIGHT);
    read_back(&color, WIDTH, HEIGHT, 8, pixels);
    write_file(folder, "color.f16", pixels, WIDTH * HEIGHT * 8);
    read_back(&depth, WIDTH, HEIGHT, 4, pixels);
    write_file(folder, "depth.f32", pixels, WIDTH * HEIGHT * 4);
    CHECK(IDirect3D9_GetAdapterIdentifier(direct3d, D3DADAPTER_DEFAULT, 0, &adapter));
    CapturedPull pulled = {136, 32, 1.0f / 30.0f, PULL_SECONDS, parameters.FocusDistance, {0}, {0}};
    aim_at(pulled.x, pulled.y);
    memcpy(pulled.depths, aimed, sizeof aimed);
    for (int i = 0; i < NUM_PULLED; i++) {
        pull_focus(pulled.frame);
        pulled.distances[i] = parameters.FocusDistance;
    }
    write_capture(folder, "Direct3D 9", adapter.Description, NULL, shots, NUM_SHOTS, &pulled);
}

int main(int argc, char **argv)
{
    make_window();
    make_device();
    make_targets();
    make_shaders();
    make_scene();
    camera = make_camera();
    parameters.FocalLength = focal_length();
    parameters.ApertureDiameter = parameters.FocalLength / F_STOP;
    parameters.MaxCoC = MAX_COC;
    focus_on_place(SUBJECT);
    if (argc > 1)
        capture(argv[1]);
    else
        run();
    return 0;
}
