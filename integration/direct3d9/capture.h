/* SPDX-License-Identifier: MIT
 *
 * Writes the files that the tests of this repository read. This is not part of the effect: leave it out of your
 * program. validation/engines/capture.py describes the files.
 */
#ifndef CAPTURE_H
#define CAPTURE_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene.h"

typedef struct {
    const char *name, *method, *aperture;
    float focus_distance, clockwise; /* metres; degrees */
} CapturedShot;

/* A record of the autofocus at a pixel: the depths that it reads there, then the focus distance after each frame. */
enum { NUM_PULLED = 12 };
typedef struct {
    int x, y;
    float frame, tau, from, depths[NUM_AIMS], distances[NUM_PULLED];
} CapturedPull;

static FILE *open_file(const char *folder, const char *name)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    if (!file) {
        fprintf(stderr, "cannot write %s\n", path);
        exit(1);
    }
    return file;
}

static void close_file(FILE *file, const char *folder, const char *name)
{
    if (fclose(file)) {
        fprintf(stderr, "cannot write all of %s/%s\n", folder, name);
        exit(1);
    }
}

static void write_file(const char *folder, const char *name, const void *bytes, size_t size)
{
    FILE *file = open_file(folder, name);
    fwrite(bytes, 1, size, file);
    close_file(file, folder, name);
}

/* Writes a BMP file. `bytes` has the top row first and four bytes per pixel: blue, green, red, and one unused. */
static void write_bmp(const char *folder, const char *name, const void *bytes, int width, int height)
{
    const size_t head = 54, size = (size_t)width * height * 4;
    const unsigned words[13] = {(unsigned)(head + size), 0, 54, 40, (unsigned)width, (unsigned)-height, 1 | 32 << 16};
    char *whole = (char *)malloc(head + size);
    memcpy(whole, "BM", 2);
    memcpy(whole + 2, words, sizeof words);
    memcpy(whole + head, bytes, size);
    write_file(folder, name, whole, head + size);
    free(whole);
}

/* Writes capture.json. `stored` is JSON that describes the kind of depth in depth.f32 for exact and layered; NULL means
 * metres. */
static void write_capture(const char *folder, const char *engine, const char *adapter, const char *stored,
                          const CapturedShot *shots, int num_shots, const CapturedPull *pull)
{
    FILE *file = open_file(folder, "capture.json");
    fprintf(file, "{\"engine\": \"%s\", \"device\": \"%s\", \"width\": %d, \"height\": %d,\n", engine, adapter, WIDTH,
            HEIGHT);
    fprintf(file, " \"color\": \"color.f16\", \"depth\": \"depth.f32\", \"shots\": [");
    for (int i = 0; i < num_shots; i++) {
        const CapturedShot *shot = &shots[i];
        fprintf(file, "%s\n  {\"name\": \"%s\", \"result\": \"%s.f16\", \"method\": \"%s\", \"aperture\": \"%s\",",
                i ? "," : "", shot->name, shot->name, shot->method, shot->aperture);
        if (stored && !strcmp(shot->method, "paper"))
            fprintf(file, " \"depth\": \"metres.f32\",");
        else if (stored)
            fprintf(file, " \"stored\": %s,", stored);
        if (shot->clockwise)
            fprintf(file, " \"clockwise\": %.9g,", shot->clockwise);
        if (!strcmp(shot->method, "layered"))
            fprintf(file, " \"written\": \"%s.written\",", shot->name);
        fprintf(file, "\n   \"camera\": {\"aperture_diameter\": %.9g, \"focal_length\": %.9g, \"focus_distance\": %.9g,"
                " \"sensor_height\": %.9g, \"max_coc\": %.9g}}", focal_length() / F_STOP, focal_length(),
                shot->focus_distance, SENSOR_HEIGHT, MAX_COC);
    }
    fprintf(file, "],\n \"pull\": {\"frame\": %.9g, \"seconds\": %.9g, \"from\": %.9g, \"points\": [", pull->frame,
            pull->tau, pull->from);
    for (int i = 0; i < NUM_AIMS; i++)
        fprintf(file, "%s[%.9g, %.9g, %.9g]", i ? ", " : "", (pull->x + AIMS[i][0] + 0.5) / WIDTH,
                (pull->y + AIMS[i][1] + 0.5) / HEIGHT, pull->depths[i]);
    fprintf(file, "], \"distances\": [");
    for (int i = 0; i < NUM_PULLED; i++)
        fprintf(file, "%s%.9g", i ? ", " : "", pull->distances[i]);
    fprintf(file, "]}}\n");
    close_file(file, folder, "capture.json");
}

#endif
