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
 * "ok" when it compiled, "failed" with the status when not; "failed job: ..." when the job is wrong.
 * There are no includes: the source is complete.
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

typedef struct {
    const char *source, *profile, *entry, *bytecode, *listing, *messages;
    UINT flags;
    D3D_SHADER_MACRO defines[MAX_DEFINES + 1];
} Job;

/* Take one line of the job file apart. 0 for a line that means nothing. */
static int take_line(Job *job, char *line, int *defines)
{
    char *value = strchr(line, ' ');
    if (!value)
        return 0;
    *value++ = 0;
    if (!strcmp(line, "source"))
        job->source = value;
    else if (!strcmp(line, "profile"))
        job->profile = value;
    else if (!strcmp(line, "entry"))
        job->entry = value;
    else if (!strcmp(line, "bytecode"))
        job->bytecode = value;
    else if (!strcmp(line, "listing"))
        job->listing = value;
    else if (!strcmp(line, "messages"))
        job->messages = value;
    else if (!strcmp(line, "flags"))
        job->flags = strtoul(value, NULL, 16);
    else if (!strcmp(line, "define") && *defines < MAX_DEFINES) {
        char *text = strchr(value, ' ');
        if (text)
            *text++ = 0;
        job->defines[*defines].Name = value;
        job->defines[(*defines)++].Definition = text ? text : "1";
    } else
        return 0;
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

static void run(const Job *job)
{
    size_t size;
    char *source = read_file(job->source, &size);
    if (!source) {
        say("failed", "job: cannot read %s", job->source);
        return;
    }
    ID3DBlob *code = NULL, *messages = NULL, *listing = NULL;
    HRESULT status = compile(source, size, "bokeh.hlsl", job->defines, NULL, job->entry, job->profile, job->flags, 0,
                             &code, &messages);
    int written = write_text(job->messages, messages);
    if (SUCCEEDED(status) && code) {
        const void *data = ID3D10Blob_GetBufferPointer(code);
        SIZE_T length = ID3D10Blob_GetBufferSize(code);
        written &= write_file(job->bytecode, data, length);
        HRESULT listed = disassemble(data, length, 0, NULL, &listing);
        written &= write_text(job->listing, listing);
        if (!written)
            say("failed", "job: an output file cannot be written");
        else if (FAILED(listed))
            say("failed", "job: D3DDisassemble returned %08lx", (unsigned long)listed);
        else
            say("ok", "%08lx", (unsigned long)status);
    } else if (!written)
        say("failed", "job: %s cannot be written", job->messages);
    else
        say("failed", "%08lx", (unsigned long)status);
    if (listing)
        ID3D10Blob_Release(listing);
    if (messages)
        ID3D10Blob_Release(messages);
    if (code)
        ID3D10Blob_Release(code);
    free(source);
}

static void work(const char *name)
{
    Job job = {0};
    int defines = 0;
    char *text = read_file(name, NULL);
    if (!text) {
        say("failed", "job: cannot read %s", name);
        return;
    }
    for (char *line = text, *next; line && *line; line = next) {
        next = strchr(line, '\n');
        if (next)
            *next++ = 0;
        line[strcspn(line, "\r")] = 0;
        if (*line && !take_line(&job, line, &defines)) {
            say("failed", "job: cannot use the line '%s'", line);
            free(text);
            return;
        }
    }
    if (job.source && job.profile && job.entry && job.bytecode && job.listing && job.messages)
        run(&job);
    else
        say("failed", "job: source, profile, entry, bytecode, listing and messages are needed");
    free(text);
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

int main(void)
{
    /* by its whole path: Wine has a library of the same name, which does not know shader model 3 */
    wchar_t path[MAX_PATH + 32];
    DWORD length = GetModuleFileNameW(NULL, path, MAX_PATH);
    while (length && path[length - 1] != L'\\')
        length--;
    wcscpy(path + length, L"d3dcompiler_47.dll");
    HMODULE library = LoadLibraryW(path);
    if (!library) {
        say("unavailable", "d3dcompiler_47.dll beside fxc.exe cannot be loaded (error %lu)", GetLastError());
        return 1;
    }
    compile = (Compile)(void *)GetProcAddress(library, "D3DCompile");
    disassemble = (Disassemble)(void *)GetProcAddress(library, "D3DDisassemble");
    if (!compile || !disassemble) {
        say("unavailable", "d3dcompiler_47.dll has no D3DCompile or no D3DDisassemble");
        return 1;
    }
    char version[64];
    version_of(path, version, sizeof version);
    say("ready", "%s", version);
    serve(work);
    return 0;
}
