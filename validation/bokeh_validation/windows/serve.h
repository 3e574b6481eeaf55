/* What every program here is: a server that is asked by a line on standard input and answers with one on standard
 * output. Starting a program under Wine takes half a second, so one process takes many jobs.
 *
 *   start    prints one line, "ready TEXT", or "unavailable TEXT" and ends
 *   request  the name of a job file in the working directory; data go through files there, named without a folder
 *   answer   "ok TEXT" or "failed TEXT", one line
 *   end      when standard input ends
 */
#ifndef BOKEH_SERVE_H
#define BOKEH_SERVE_H

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One line to standard output, at once. */
static void say(const char *kind, const char *format, ...)
{
    char text[2048];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    for (char *at = text; *at; at++)
        if (*at == '\r' || *at == '\n')
            *at = ' ';
    printf("%s %s\n", kind, text);
    fflush(stdout);
}

/* A whole file with a zero byte behind it, to be freed; NULL where it cannot be read. */
static char *read_file(const char *name, size_t *size)
{
    FILE *file = fopen(name, "rb");
    if (!file)
        return NULL;
    char *data = NULL;
    long length = -1;
    if (fseek(file, 0, SEEK_END) == 0)
        length = ftell(file);
    if (length >= 0 && fseek(file, 0, SEEK_SET) == 0)
        data = malloc((size_t)length + 1);
    if (data && fread(data, 1, (size_t)length, file) != (size_t)length) {
        free(data);
        data = NULL;
    }
    fclose(file);
    if (data) {
        data[length] = 0;
        if (size)
            *size = (size_t)length;
    }
    return data;
}

/* 1 where all of it was written. */
static int write_file(const char *name, const void *data, size_t size)
{
    FILE *file = fopen(name, "wb");
    if (!file)
        return 0;
    int whole = fwrite(data, 1, size, file) == size;
    return fclose(file) == 0 && whole;
}

/* Answer requests until standard input ends. `work` says "ok" or "failed" exactly once. */
static void serve(void (*work)(const char *job))
{
    char line[1024];
    while (fgets(line, sizeof line, stdin)) {
        line[strcspn(line, "\r\n")] = 0;
        if (line[0])
            work(line);
    }
}

#endif
