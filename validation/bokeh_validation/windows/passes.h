/* A list of full-screen passes as a job of a server (serve.h), for any Direct3D: d3d9run.c and d3d11run.c fill in the
 * functions of `Device`.
 *
 * A job file is text, one command a line, done in this order:
 *
 *   size W H FORMAT              of every target from now on, whatever those before have; any FORMAT
 *   texture N W H FORMAT FILE    make texture N from a file: rows from v = 0 on without gaps. FORMAT is half4, float4,
 *                                half2, float2 or float1
 *   vertex FILE                  vertex shader of the draws to come
 *   pixel FILE                   pixel shader of the next draw
 *   input SLOT N FILTER          texture N in a slot (s and t register) of the next draw; linear or nearest, clamp
 *   value I NUMBER               parameter I: c(I).x in shader model 3, byte 4 I of b0 in 4 and up
 *   viewport X Y W H             the next draw fills these texels only, Y from the first row on; uv is 0 .. 1 over them
 *   draw N [N [N [N]]]           draw; each target of the pixel shader becomes a texture. With a viewport, N may be one
 *                                that an earlier draw has made, of the same size and format: it keeps what is around;
 *                                a new one is 0 there
 *   keep N FILE                  write texture N, in the format of its target, rows as above
 *
 * FILEs are names in the working directory. A shader file is read once: other contents need another name.
 * All textures are gone after the job. Answers: "ok" or "failed WHAT WENT WRONG".
 */
#ifndef BOKEH_PASSES_H
#define BOKEH_PASSES_H

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
    int is_target;
} Texture;

typedef struct {
    int texture; /* -1: empty */
    int linear;
} Input;

/* A part of the targets, in texels. */
typedef struct {
    int x, y, width, height;
} Area;

/* What a draw reads and writes. */
typedef struct {
    void *vertex, *pixel;
    Input inputs[NUM_SLOTS];
    float values[NUM_VALUES];
    int has_viewport;
    Area viewport; /* as a device sees it: the whole target where the job names none */
} Draw;

/* Each function is given by a program. 0 on failure, after problem(). */
static int make_texture(Texture *texture, const void *pixels);
static int make_target(Texture *texture); /* 0 everywhere */
static int make_shader(int is_vertex, const void *code, size_t size, void **shader);
static int draw(const Draw *what, const Texture *textures, Texture *const *targets, int num_targets);
static int read_back(const Texture *texture, void *pixels);
static void drop(Texture *texture);

static char problem_text[1024];

/* Remember what went wrong; returns 0. */
static int problem(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(problem_text, sizeof problem_text, format, arguments);
    va_end(arguments);
    return 0;
}

/* Leave the function where a Direct3D call fails. */
#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        HRESULT status_ = (call);                                                                                      \
        if (FAILED(status_))                                                                                           \
            return problem("%.200s returned %08lx", #call, (unsigned long)status_);                                    \
    } while (0)

static struct {
    char name[128];
    void *handle;
} shaders[MAX_SHADERS];
static int num_shaders;

static int find_shader(const char *name, int is_vertex, void **shader)
{
    for (int i = 0; i < num_shaders; i++)
        if (!strcmp(shaders[i].name, name)) {
            *shader = shaders[i].handle;
            return 1;
        }
    size_t size;
    char *code = read_file(name, &size);
    if (!code)
        return problem("cannot read %s", name);
    int made = make_shader(is_vertex, code, size, shader);
    free(code);
    if (made && num_shaders < MAX_SHADERS && strlen(name) < sizeof shaders[0].name) {
        strcpy(shaders[num_shaders].name, name);
        shaders[num_shaders++].handle = *shader;
    }
    return made;
}

static int find_format(const char *name, Format *format)
{
    for (int i = 0; i < NUM_FORMATS; i++)
        if (!strcmp(name, FORMAT_NAMES[i])) {
            *format = (Format)i;
            return 1;
        }
    return problem("no format %s", name);
}

static int is_texture(const Texture *textures, int number, int wanted)
{
    if (number < 0 || number >= MAX_TEXTURES || !textures[number].handle != !wanted)
        return problem("texture %d is %s", number, wanted ? "not there" : "there already, or too many");
    return 1;
}

static int load_texture(Texture *texture, const char *file)
{
    size_t size;
    char *pixels = read_file(file, &size);
    if (!pixels)
        return problem("cannot read %s", file);
    int made;
    if (size != (size_t)texture->width * texture->height * TEXEL_BYTES[texture->format])
        made = problem("%s has %lu bytes", file, (unsigned long)size);
    else
        made = make_texture(texture, pixels);
    free(pixels);
    return made;
}

static int keep_texture(const Texture *texture, const char *file)
{
    size_t size = (size_t)texture->width * texture->height * TEXEL_BYTES[texture->format];
    void *pixels = malloc(size);
    if (!pixels)
        return problem("no memory for %s", file);
    int done = read_back(texture, pixels) && (write_file(file, pixels, size) || problem("cannot write %s", file));
    free(pixels);
    return done;
}

/* Forget what is told for each draw anew. */
static void start_draw(Draw *next)
{
    for (int slot = 0; slot < NUM_SLOTS; slot++)
        next->inputs[slot].texture = -1;
    next->pixel = NULL;
    next->has_viewport = 0;
}

static int is_within(const Area *area, const Texture *size)
{
    if (area->x < 0 || area->y < 0 || area->width < 1 || area->height < 1 || area->x > size->width - area->width ||
        area->y > size->height - area->height)
        return problem("viewport %d %d %d %d is not within %d x %d", area->x, area->y, area->width, area->height,
                       size->width, size->height);
    return 1;
}

/* Make a target of a draw, or find the one to draw over. */
static int find_target(Texture *textures, int number, const Texture *size, const Draw *next)
{
    int is_there = number >= 0 && number < MAX_TEXTURES && textures[number].handle;
    if (!next->has_viewport || !is_there) {
        Texture target = *size;
        if (!is_texture(textures, number, 0) || !make_target(&target))
            return 0;
        target.is_target = 1;
        textures[number] = target;
        return 1;
    }
    const Texture *target = &textures[number];
    if (!target->is_target || target->width != size->width || target->height != size->height ||
        target->format != size->format)
        return problem("texture %d is no target of this size and format", number);
    for (int slot = 0; slot < NUM_SLOTS; slot++)
        if (next->inputs[slot].texture == number)
            return problem("texture %d is read and drawn over", number);
    return 1;
}

static int do_draw(const char *numbers, Texture *textures, const Texture *size, Draw *next)
{
    int number[MAX_TARGETS + 1]; /* with room for one too many */
    int count = sscanf(numbers, "%d %d %d %d %d", &number[0], &number[1], &number[2], &number[3], &number[4]);
    Texture *targets[MAX_TARGETS];
    if (count < 1 || count > MAX_TARGETS || !next->vertex || !next->pixel || !size->width)
        return problem("draw needs size, vertex and pixel before it, and 1 to %d numbers", MAX_TARGETS);
    if (!next->has_viewport)
        next->viewport = (Area){0, 0, size->width, size->height};
    if (!is_within(&next->viewport, size))
        return 0;
    for (int i = 0; i < count; i++) {
        if (!find_target(textures, number[i], size, next))
            return 0;
        targets[i] = &textures[number[i]];
    }
    int done = draw(next, textures, targets, count);
    start_draw(next);
    return done;
}

/* Do one line of a job. 0 on failure, after problem(). */
static int do_line(const char *line, Texture *textures, Texture *size, Draw *next)
{
    char word[16], format[16], file[128];
    int number, slot, width, height, read = 0;
    float value;
    sscanf(line, "%15s %n", word, &read);
    const char *rest = line + read;
    if (!strcmp(word, "size") && sscanf(rest, "%d %d %15s", &size->width, &size->height, format) == 3)
        return find_format(format, &size->format);
    if (!strcmp(word, "texture") && sscanf(rest, "%d %d %d %15s %127s", &number, &width, &height, format, file) == 5) {
        Texture made = {width, height, HALF4, NULL, 0};
        if (!is_texture(textures, number, 0) || !find_format(format, &made.format) || !load_texture(&made, file))
            return 0;
        textures[number] = made;
        return 1;
    }
    if (!strcmp(word, "vertex") && sscanf(rest, "%127s", file) == 1)
        return find_shader(file, 1, &next->vertex);
    if (!strcmp(word, "pixel") && sscanf(rest, "%127s", file) == 1)
        return find_shader(file, 0, &next->pixel);
    if (!strcmp(word, "input") && sscanf(rest, "%d %d %15s", &slot, &number, format) == 3) {
        if (slot < 0 || slot >= NUM_SLOTS)
            return problem("no slot %d", slot);
        next->inputs[slot].texture = number;
        next->inputs[slot].linear = !strcmp(format, "linear");
        return is_texture(textures, number, 1);
    }
    if (!strcmp(word, "value") && sscanf(rest, "%d %f", &slot, &value) == 2) {
        if (slot < 0 || slot >= NUM_VALUES)
            return problem("no parameter %d", slot);
        next->values[slot] = value;
        return 1;
    }
    Area *area = &next->viewport;
    if (!strcmp(word, "viewport") && sscanf(rest, "%d %d %d %d", &area->x, &area->y, &area->width, &area->height) == 4)
        return next->has_viewport = 1;
    if (!strcmp(word, "draw"))
        return do_draw(rest, textures, size, next);
    if (!strcmp(word, "keep") && sscanf(rest, "%d %127s", &number, file) == 2)
        return is_texture(textures, number, 1) && keep_texture(&textures[number], file);
    return problem("cannot use the line '%.200s'", line);
}

static void run_passes(const char *name)
{
    Texture textures[MAX_TEXTURES] = {0}, size = {0};
    Draw next = {0};
    start_draw(&next);
    char *text = read_file(name, NULL);
    int done = text ? 1 : problem("cannot read %s", name);
    for (char *line = text, *after; done && line && *line; line = after) {
        after = strchr(line, '\n');
        if (after)
            *after++ = 0;
        line[strcspn(line, "\r")] = 0;
        if (*line)
            done = do_line(line, textures, &size, &next);
    }
    free(text);
    for (int i = 0; i < MAX_TEXTURES; i++)
        if (textures[i].handle)
            drop(&textures[i]);
    if (done)
        say("ok", "");
    else
        say("failed", "%s", problem_text);
}

#endif
