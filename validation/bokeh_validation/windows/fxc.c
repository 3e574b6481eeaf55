/* Microsoft's HLSL compiler as a server (serve.h): d3dcompiler_47.dll, which lies beside this program.
 *
 * A job file is text, one setting a line, in any order:
 *
 *   source FILE        HLSL text
 *   profile NAME       such as ps_3_0
 *   entry NAME
 *   flags NUMBER       D3DCOMPILE_* of d3dcompiler.h, hexadecimal; 0 is what fxc.exe does without options
 *   define NAME TEXT   any number of them; TEXT is the rest of the line
 *   bytecode FILE      written when it compiles
 *   listing FILE       its disassembly, written when it compiles
 *   messages FILE      written always: errors and warnings
 *
 * All but `define` are needed. "ok" when it compiled, "failed" with the status when not; "failed job: ..." when the job
 * is wrong. There are no includes: the source is complete.
 */
#define COBJMACROS
#include <windows.h>
#include <d3dcommon.h>

#include "serve.h"

#define MAX_DEFINES 64

typedef HRESULT(WINAPI *Compile)(const void *, SIZE_T, const char *, const D3D_SHADER_MACRO *, ID3DInclude *,
                                 const char *, const char *, UINT, UINT, ID3DBlob **, ID3DBlob **);
typedef HRESULT(WINAPI *Disassemble)(const void *, SIZE_T, UINT, const char *, ID3DBlob **);

static Compile compile;
static Disassemble disassemble;

enum { SOURCE, PROFILE, ENTRY, BYTECODE, LISTING, MESSAGES, FLAGS, NUM_SETTINGS };

static const char *const SETTINGS[NUM_SETTINGS] = {"source",  "profile",  "entry", "bytecode",
                                                   "listing", "messages", "flags"};

typedef struct {
    const char *settings[NUM_SETTINGS];
    D3D_SHADER_MACRO defines[MAX_DEFINES + 1];
    int num_defines;
} Job;

/* Take one line of the job file apart. 0 for a line that means nothing, after problem(). */
static int take_line(void *state, char *line)
{
    Job *job = state;
    char *value = strchr(line, ' ');
    if (!value)
        return problem("job: cannot use the line '%s'", line);
    *value++ = 0;
    for (int i = 0; i < NUM_SETTINGS; i++)
        if (!strcmp(line, SETTINGS[i])) {
            job->settings[i] = value;
            return 1;
        }
    if (strcmp(line, "define") || job->num_defines == MAX_DEFINES)
        return problem("job: cannot use the line '%s'", line);
    char *text = strchr(value, ' ');
    if (text)
        *text++ = 0;
    job->defines[job->num_defines++] = (D3D_SHADER_MACRO){value, text ? text : "1"};
    return 1;
}

/* The text of a blob; it may or may not end in a zero byte. */
static int write_text(const char *name, ID3DBlob *blob)
{
    if (!blob)
        return write_file(name, "", 0);
    const char *text = ID3D10Blob_GetBufferPointer(blob);
    size_t size = ID3D10Blob_GetBufferSize(blob);
    while (size && !text[size - 1])
        size--;
    return write_file(name, text, size);
}

/* Disassemble what was compiled, and write both. */
static int write_code(const Job *job, ID3DBlob *code)
{
    const void *data = ID3D10Blob_GetBufferPointer(code);
    SIZE_T length = ID3D10Blob_GetBufferSize(code);
    ID3DBlob *listing = NULL;
    HRESULT listed = disassemble(data, length, 0, NULL, &listing);
    int written = write_file(job->settings[BYTECODE], data, length) && write_text(job->settings[LISTING], listing);
    if (listing)
        ID3D10Blob_Release(listing);
    if (FAILED(listed))
        return problem("job: D3DDisassemble returned %08lx", (unsigned long)listed);
    return written;
}

static int run(const Job *job)
{
    const char *const *set = job->settings;
    for (int i = 0; i < NUM_SETTINGS; i++)
        if (!set[i])
            return problem("job: %s is needed", SETTINGS[i]);
    size_t size;
    char *source = read_file(set[SOURCE], &size);
    if (!source)
        return 0;
    ID3DBlob *code = NULL, *messages = NULL;
    HRESULT status = compile(source, size, "bokeh.hlsl", job->defines, NULL, set[ENTRY], set[PROFILE],
                             strtoul(set[FLAGS], NULL, 16), 0, &code, &messages);
    int done = write_text(set[MESSAGES], messages);
    if (done && SUCCEEDED(status) && code)
        done = write_code(job, code);
    else if (done)
        done = problem("%08lx", (unsigned long)status);
    if (messages)
        ID3D10Blob_Release(messages);
    if (code)
        ID3D10Blob_Release(code);
    free(source);
    return done;
}

static int work(const char *name)
{
    Job job = {0};
    size_t size;
    char *text = read_file(name, &size);
    int done = text && each_line(text, take_line, &job) && run(&job);
    free(text);
    return done;
}

/* The version resource of the library, such as 10.0.26100.1. */
static void version_of(const wchar_t *path, char *text, size_t size)
{
    DWORD ignored, length = GetFileVersionInfoSizeW(path, &ignored);
    void *data = length ? malloc(length) : NULL;
    VS_FIXEDFILEINFO *info = NULL;
    UINT info_size = 0;
    snprintf(text, size, "unknown");
    if (data && GetFileVersionInfoW(path, 0, length, data) &&
        VerQueryValueW(data, L"\\", (void **)&info, &info_size) && info)
        snprintf(text, size, "%u.%u.%u.%u", HIWORD(info->dwFileVersionMS), LOWORD(info->dwFileVersionMS),
                 HIWORD(info->dwFileVersionLS), LOWORD(info->dwFileVersionLS));
    free(data);
}

/* The library beside this program. 0 on failure, after problem(). */
static int load(char *version, size_t size)
{
    /* by its whole path: Wine has a library of the same name, which does not know shader model 3 */
    wchar_t path[MAX_PATH + 32];
    DWORD length = GetModuleFileNameW(NULL, path, MAX_PATH);
    while (length && path[length - 1] != L'\\')
        length--;
    wcscpy(path + length, L"d3dcompiler_47.dll");
    HMODULE library = LoadLibraryW(path);
    if (!library)
        return problem("d3dcompiler_47.dll beside fxc.exe cannot be loaded (error %lu)", GetLastError());
    compile = (Compile)(void *)GetProcAddress(library, "D3DCompile");
    disassemble = (Disassemble)(void *)GetProcAddress(library, "D3DDisassemble");
    if (!compile || !disassemble)
        return problem("d3dcompiler_47.dll has no D3DCompile or no D3DDisassemble");
    version_of(path, version, size);
    return 1;
}

int main(void)
{
    char version[64];
    if (!load(version, sizeof version)) {
        say("unavailable", problem_text);
        return 1;
    }
    say("ready", version);
    serve(work);
    return 0;
}
