/* SPDX-License-Identifier: MIT
 *
 * The window, the autofocus and the check of errors of both Direct3D samples. Include it after capture.h, SHOTS,
 * `parameters`, `camera`, `shot` and `debug_view`, which it uses.
 */
#ifndef WINDOW_H
#define WINDOW_H

/* Each sample defines these three functions. aim_at() aims the autofocus: it reads the depths of the last frame at a
 * pixel and around it. show_frame() draws a frame in the window. capture() writes what the tests compare. */
static void aim_at(int x, int y);
static void show_frame(void);
static void capture(const char *folder);

#define CHECK(call) check((call), #call)
static void check(HRESULT status, const char *call)
{
    if (FAILED(status)) {
        fprintf(stderr, "%s returned %08lx\n", call, (unsigned long)status);
        exit(1);
    }
}

static HWND window;

/* Depths in metres. The autofocus moves to the nearest of them. */
static float aimed[NUM_AIMS];

/* Focuses on a point of the world, at once. */
static void focus_on_place(const float place[3])
{
    parameters.FocusDistance = view_depth(&camera, place);
    for (int i = 0; i < NUM_AIMS; i++)
        aimed[i] = parameters.FocusDistance;
}

/* Sets the camera and the lens, and focuses on the subject of the scene. */
static void set_camera(void)
{
    camera = make_camera();
    parameters.FocalLength = focal_length();
    parameters.ApertureDiameter = parameters.FocalLength / F_STOP;
    parameters.MaxCoC = MAX_COC;
    focus_on_place(SUBJECT);
}

/* Moves the focus smoothly towards the nearest of the aimed depths. Call it in every frame, with the time since the
 * last frame in seconds. With INFINITY, the focus arrives at once. */
static void pull_focus(float seconds)
{
    parameters.FocusDistance = pulled_focus(parameters.FocusDistance, aimed, seconds, PULL_SECONDS);
}

/* A click focuses. If the mouse moves by more than CLICK pixels between press and release, it drags instead. */
enum { CLICK = 5 };

static LRESULT CALLBACK on_message(HWND owner, UINT message, WPARAM w, LPARAM l)
{
    static int x, y;
    if (message == WM_LBUTTONDOWN) {
        x = GET_X_LPARAM(l);
        y = GET_Y_LPARAM(l);
    } else if (message == WM_LBUTTONUP && abs(GET_X_LPARAM(l) - x) <= CLICK && abs(GET_Y_LPARAM(l) - y) <= CLICK)
        aim_at(x / ZOOM, y / ZOOM);
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

/* Clicks on a pixel and pulls the focus for NUM_PULLED frames. Returns what the tests compare. */
static CapturedPull pulled_to(int x, int y)
{
    CapturedPull pulled = {x, y, 1.0f / 30.0f, PULL_SECONDS, parameters.FocusDistance, {0}, {0}};
    const LPARAM place = MAKELPARAM(x * ZOOM, y * ZOOM);
    memcpy(pulled.depths, aimed, sizeof aimed);
    on_message(window, WM_LBUTTONDOWN, 0, 0);
    on_message(window, WM_LBUTTONUP, 0, place);
    check(memcmp(pulled.depths, aimed, sizeof aimed) ? E_FAIL : S_OK, "a drag, which must not aim,");
    on_message(window, WM_LBUTTONDOWN, 0, place);
    on_message(window, WM_LBUTTONUP, 0, place);
    memcpy(pulled.depths, aimed, sizeof aimed);
    for (int i = 0; i < NUM_PULLED; i++) {
        pull_focus(pulled.frame);
        pulled.distances[i] = parameters.FocusDistance;
    }
    return pulled;
}

static void make_window(const char *title)
{
    WNDCLASSA kind = {0};
    RECT area = {0, 0, WIDTH * ZOOM, HEIGHT * ZOOM};
    const DWORD style = WS_OVERLAPPED | WS_CAPTION | WS_SYSMENU;
    kind.lpfnWndProc = on_message;
    kind.hInstance = GetModuleHandleA(NULL);
    kind.lpszClassName = "bokeh";
    kind.hCursor = LoadCursor(NULL, IDC_CROSS);
    RegisterClassA(&kind);
    AdjustWindowRect(&area, style, FALSE);
    window = CreateWindowA("bokeh", title, style, CW_USEDEFAULT, CW_USEDEFAULT, area.right - area.left,
                           area.bottom - area.top, NULL, NULL, kind.hInstance, NULL);
    if (!window) {
        fprintf(stderr, "cannot open a window: is there a display?\n");
        exit(1);
    }
}

/* Captures into the folder that was given as an argument. Without one, draws frames until the window is closed. */
static int run(int argc, char **argv)
{
    MSG message = {0};
    ULONGLONG last = GetTickCount64();
    if (argc > 1) {
        capture(argv[1]);
        /* leave at once: in exit(), a driver's threads may still use what it frees (seen with Mesa under Wine) */
        TerminateProcess(GetCurrentProcess(), 0);
    }
    ShowWindow(window, SW_SHOW);
    while (message.message != WM_QUIT) {
        const ULONGLONG now = GetTickCount64();
        pull_focus((now - last) * 0.001f);
        last = now;
        show_frame();
        while (message.message != WM_QUIT && PeekMessageA(&message, NULL, 0, 0, PM_REMOVE))
            DispatchMessageA(&message);
    }
    return 0;
}

#endif
