/* The device under Wine's Direct3D, whose own adapter names are those of cards that it imitates. */
#ifndef BOKEH_RENDERER_H
#define BOKEH_RENDERER_H

#include <windows.h>
#include <GL/gl.h>
#include <stdio.h>

/* Wine's version, or NULL on Windows. */
static const char *wine_version(void)
{
    HMODULE library = GetModuleHandleA("ntdll.dll");
    const char *(CDECL *version)(void) = NULL;
    if (library)
        version = (const char *(CDECL *)(void))(void *)GetProcAddress(library, "wine_get_version");
    return version ? version() : NULL;
}

/* GL_RENDERER of an OpenGL context, which is what Wine's Direct3D draws with; empty where there is none. */
static void opengl_renderer(char *text, size_t size)
{
    static PIXELFORMATDESCRIPTOR format;
    format.nSize = sizeof format;
    format.nVersion = 1;
    format.cColorBits = 24;
    format.dwFlags = PFD_DRAW_TO_WINDOW | PFD_SUPPORT_OPENGL | PFD_DOUBLEBUFFER;
    HWND window = CreateWindowA("STATIC", "", WS_POPUP, 0, 0, 16, 16, NULL, NULL, GetModuleHandleA(NULL), NULL);
    HDC surface = window ? GetDC(window) : NULL;
    HGLRC context = NULL;
    text[0] = 0;
    if (surface && SetPixelFormat(surface, ChoosePixelFormat(surface, &format), &format))
        context = wglCreateContext(surface);
    if (context && wglMakeCurrent(surface, context)) {
        const char *name = (const char *)glGetString(GL_RENDERER);
        snprintf(text, size, "%s", name ? name : "");
        wglMakeCurrent(NULL, NULL);
    }
    if (context)
        wglDeleteContext(context);
    if (surface)
        ReleaseDC(window, surface);
    if (window)
        DestroyWindow(window);
}

/* Name of the device behind an adapter of Direct3D. */
static void device_name(const char *adapter, char *text, size_t size)
{
    const char *version = wine_version();
    char renderer[256];
    if (!version) {
        snprintf(text, size, "%s", adapter);
        return;
    }
    opengl_renderer(renderer, sizeof renderer);
    snprintf(text, size, "%s, Wine %s", renderer[0] ? renderer : "unknown OpenGL", version);
}

#endif
