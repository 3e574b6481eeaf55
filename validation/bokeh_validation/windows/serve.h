/* What every program here is: a server that is asked by a line on standard input and answers with one on standard
 * output. Starting a program under Wine takes half a second, so one process takes many jobs.
 *
 *   start    prints one line, "ready TEXT", or "unavailable TEXT" and ends
 *   request  the name of a job file in the working directory; data go through files there, named without a folder
 *   answer   "ok", or "failed" and what went wrong, one line
 *   end      when standard input ends
 */
#ifndef BOKEH_SERVE_H
#define BOKEH_SERVE_H

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

/* One line to standard output, at once. */
static void say(const char *kind, const char *text)
{
    printf("%s ", kind);
    for (; *text; text++)
        putchar(*text == '\r' || *text == '\n' ? ' ' : *text);
    printf("\n");
    fflush(stdout);
}

/* A whole file with a zero byte behind it, to be freed; NULL, after problem(), where it cannot be read. */
static char *read_file(const char *name, size_t *size)
{
    FILE *file = fopen(name, "rb");
    char *data = NULL;
    long length = -1;
    if (file && fseek(file, 0, SEEK_END) == 0)
        length = ftell(file);
    if (length >= 0 && fseek(file, 0, SEEK_SET) == 0)
        data = calloc((size_t)length + 1, 1);
    if (data && fread(data, 1, (size_t)length, file) != (size_t)length) {
        free(data);
        data = NULL;
    }
    if (file)
        fclose(file);
    if (!data)
        problem("cannot read %s", name);
    *size = (size_t)length;
    return data;
}

/* 1 where all of it was written, else 0, after problem(). */
static int write_file(const char *name, const void *data, size_t size)
{
    FILE *file = fopen(name, "wb");
    int whole = file && fwrite(data, 1, size, file) == size;
    return (file && fclose(file) == 0 && whole) || problem("cannot write %s", name);
}

/* Take each line of a text that is not empty, until one fails. 0 on failure, after problem(). */
static int each_line(char *text, int (*take)(void *state, char *line), void *state)
{
    for (char *line = text, *after; line; line = after) {
        after = strchr(line, '\n');
        if (after)
            *after++ = 0;
        line[strcspn(line, "\r")] = 0;
        if (*line && !take(state, line))
            return 0;
    }
    return 1;
}

/* Answer requests until standard input ends. `work` returns 0 on failure, after problem(). */
static void serve(int (*work)(const char *job))
{
    char line[1024];
    while (fgets(line, sizeof line, stdin)) {
        line[strcspn(line, "\r\n")] = 0;
        if (!line[0])
            continue;
        if (work(line))
            say("ok", "");
        else
            say("failed", problem_text);
    }
}

#endif
