/* A list of full-screen passes as a job of a server (serve.h), for any Direct3D: d3d9run.c and d3d11run.c give the
 * functions that are declared below.
 *
 * A job file is text, one command a line, done in this order:
 *
 *   texture N W H FORMAT FILE    make texture N from a file: rows from v = 0 on without gaps. FORMAT is half4, float4,
 *                                half2, float2 or float1
 *   texture N W H FORMAT         make it a target, 0 everywhere
 *   vertex FILE                  vertex shader of the draws to come
 *   pixel FILE                   pixel shader of the draws to come
 *   input SLOT N FILTER          texture N in a slot (s and t register) of the next draw; linear or nearest, clamp
 *   values NUMBER ...            parameter I: c(I).x in shader model 3, byte 4 I of b0 in 4 and up
 *   viewport X Y W H             the draws to come fill these texels, Y from the first row on; uv is 0 .. 1 over them
 *   draw N [N [N [N]]]           draw onto these targets; what is around the viewport stays
 *   keep N FILE                  write texture N, in its format, rows as above
 *
 * FILEs are names in the working directory. A shader file is read once: other contents need another name.
 * All textures are gone after the job. Answers: "ok" or "failed WHAT WENT WRONG".
 */
#ifndef BOKEH_PASSES_H
#define BOKEH_PASSES_H

#include "renderer.h"
#include "serve.h"

#define MAX_TEXTURES 64
#define MAX_SHADERS 4096
#define NUM_SLOTS 16  /* what shader model 3 has; a pass reads fewer */
#define NUM_VALUES 36 /* room for the parameters; a multiple of 4, since they are a constant buffer */
#define MAX_TARGETS 4 /* what Direct3D 9 cards have at the most */

typedef enum { HALF4, FLOAT4, HALF2, FLOAT2, FLOAT1, NUM_FORMATS } Format;

static const char *const FORMAT_NAMES[NUM_FORMATS] = {"half4", "float4", "half2", "float2", "float1"};
static const int TEXEL_BYTES[NUM_FORMATS] = {8, 16, 4, 8, 4};

typedef struct {
    int width, height;
    Format format;
    void *handle; /* NULL: this number is free */
} Texture;

/* A job so far, and what the next draw reads. */
typedef struct {
    Texture textures[MAX_TEXTURES];
    void *vertex, *pixel;
    struct {
        const Texture *texture; /* NULL: empty */
        int linear;
    } inputs[NUM_SLOTS];
    float values[NUM_VALUES];
    struct {
        int x, y, width, height;
    } viewport;
} Job;

/* Each function is given by a program. 0 on failure, after problem(). */
static int make_texture(Texture *texture, const void *pixels);
static int make_target(Texture *texture); /* 0 everywhere */
static int make_shader(int is_vertex, const void *code, size_t size, void **shader);
static int draw(const Job *job, Texture *const *targets, int num_targets);
static int read_back(const Texture *texture, void *pixels);
static void drop(Texture *texture);

/* Leave the function where a Direct3D call fails. */
#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        HRESULT status_ = (call);                                                                                      \
        if (FAILED(status_))                                                                                           \
            return problem("%.200s returned %08lx", #call, (unsigned long)status_);                                    \
    } while (0)

static int find_shader(const char *name, int is_vertex, void **shader)
{
    static struct {
        char name[128];
        void *handle;
    } known[MAX_SHADERS];
    static int num_known;
    for (int i = 0; i < num_known; i++)
        if (!strcmp(known[i].name, name)) {
            *shader = known[i].handle;
            return 1;
        }
    size_t size;
    char *code = read_file(name, &size);
    int made = code && make_shader(is_vertex, code, size, shader);
    free(code);
    if (made && num_known < MAX_SHADERS) {
        strcpy(known[num_known].name, name);
        known[num_known++].handle = *shader;
    }
    return made;
}

static Texture *find_texture(Job *job, int number)
{
    if (number >= 0 && number < MAX_TEXTURES && job->textures[number].handle)
        return &job->textures[number];
    problem("texture %d is not there", number);
    return NULL;
}

/* `file` is empty for a target. */
static int add_texture(Job *job, int number, Texture made, const char *format, const char *file)
{
    while (made.format < NUM_FORMATS && strcmp(format, FORMAT_NAMES[made.format]))
        made.format++;
    if (made.format == NUM_FORMATS || number < 0 || number >= MAX_TEXTURES || job->textures[number].handle)
        return problem("texture %d is there already, or too many, or has no format %s", number, format);
    Texture *texture = &job->textures[number];
    *texture = made;
    if (!*file)
        return make_target(texture);
    size_t size, wanted = (size_t)made.width * made.height * TEXEL_BYTES[made.format];
    char *pixels = read_file(file, &size);
    int done = pixels && (size == wanted || problem("%s has %lu bytes", file, (unsigned long)size)) &&
               make_texture(texture, pixels);
    free(pixels);
    return done;
}

static int keep_texture(const Texture *texture, const char *file)
{
    size_t size = (size_t)texture->width * texture->height * TEXEL_BYTES[texture->format];
    void *pixels = malloc(size);
    int done = pixels ? read_back(texture, pixels) && write_file(file, pixels, size) : problem("no memory for %s", file);
    free(pixels);
    return done;
}

static int do_draw(Job *job, const char *numbers)
{
    int number[MAX_TARGETS + 1]; /* with room for one too many */
    int count = sscanf(numbers, "%d %d %d %d %d", &number[0], &number[1], &number[2], &number[3], &number[4]);
    Texture *targets[MAX_TARGETS];
    if (count < 1 || count > MAX_TARGETS || !job->vertex || !job->pixel || !job->viewport.width)
        return problem("draw needs viewport, vertex and pixel before it, and 1 to %d numbers", MAX_TARGETS);
    for (int i = 0; i < count; i++)
        if (!(targets[i] = find_texture(job, number[i])))
            return 0;
    int done = draw(job, targets, count);
    memset(job->inputs, 0, sizeof job->inputs);
    return done;
}

static int set_values(Job *job, const char *numbers)
{
    int count = 0;
    for (char *after; count < NUM_VALUES; numbers = after, count++) {
        job->values[count] = strtof(numbers, &after);
        if (after == numbers)
            break;
    }
    return !*numbers || problem("no parameter %d", count);
}

/* Do one line of a job. 0 on failure, after problem(). */
static int do_line(void *state, char *line)
{
    Job *job = state;
    Texture made = {0};
    char word[16], name[16], file[128] = "";
    int number, slot, count, read = 0;
    sscanf(line, "%15s %n", word, &read);
    const char *rest = line + read;
    if (!strcmp(word, "texture")) {
        count = sscanf(rest, "%d %d %d %15s %127s", &number, &made.width, &made.height, name, file);
        if (count >= 4)
            return add_texture(job, number, made, name, file);
    }
    if (!strcmp(word, "vertex") && sscanf(rest, "%127s", file) == 1)
        return find_shader(file, 1, &job->vertex);
    if (!strcmp(word, "pixel") && sscanf(rest, "%127s", file) == 1)
        return find_shader(file, 0, &job->pixel);
    if (!strcmp(word, "input") && sscanf(rest, "%d %d %15s", &slot, &number, name) == 3) {
        if (slot < 0 || slot >= NUM_SLOTS)
            return problem("no slot %d", slot);
        job->inputs[slot].linear = !strcmp(name, "linear");
        return (job->inputs[slot].texture = find_texture(job, number)) != NULL;
    }
    if (!strcmp(word, "values"))
        return set_values(job, rest);
    if (!strcmp(word, "viewport") && sscanf(rest, "%d %d %d %d", &job->viewport.x, &job->viewport.y,
                                            &job->viewport.width, &job->viewport.height) == 4)
        return 1;
    if (!strcmp(word, "draw"))
        return do_draw(job, rest);
    if (!strcmp(word, "keep") && sscanf(rest, "%d %127s", &number, file) == 2) {
        const Texture *texture = find_texture(job, number);
        return texture && keep_texture(texture, file);
    }
    return problem("cannot use the line '%.200s'", line);
}

static int run_passes(const char *name)
{
    Job job = {0};
    size_t size;
    char *text = read_file(name, &size);
    int done = text && each_line(text, do_line, &job);
    free(text);
    for (int i = 0; i < MAX_TEXTURES; i++)
        if (job.textures[i].handle)
            drop(&job.textures[i]);
    return done;
}

/* Tell the device's name and what it is, and take jobs. */
static void serve_device(const char *adapter, const char *kind)
{
    char name[512], text[640];
    device_name(adapter, name, sizeof name);
    snprintf(text, sizeof text, "%s, %s", name, kind);
    say("ready", text);
    serve(run_passes);
}

#endif
