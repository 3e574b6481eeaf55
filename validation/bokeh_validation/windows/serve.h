/* What every program here is: a server that is asked by a line on standard input and answers with one on standard
 * output. Starting a program under Wine takes half a second, so one process takes many jobs.
 *
 *   start    prints one line, "ready TEXT", or "unavailable TEXT" and ends
 *   request  a line that says what to do; data go through files of the working directory, named without a folder
 *   answer   "ok", or "failed" and what went wrong, one line
 *   end      when standard input ends
 */
#pragma once

#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>

#include <wrl/client.h>

using Microsoft::WRL::ComPtr;

/* Say what is wrong, as printf does, to whoever asked. */
template <typename... Values> [[noreturn]] void fail(const char *format, Values... values)
{
    char text[1024];
    snprintf(text, sizeof text, format, values...);
    throw std::runtime_error(text);
}

/* Fail where a call of Windows fails. */
#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        if (HRESULT status_ = (call); FAILED(status_))                                                                 \
            fail("%.200s returned %08lx", #call, (unsigned long)status_);                                              \
    } while (0)

inline std::string read_file(const std::string &name)
{
    std::ifstream file(name, std::ios::binary);
    if (!file)
        fail("cannot read %s", name.c_str());
    return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_file(const std::string &name, const void *data, size_t size)
{
    std::ofstream file(name, std::ios::binary);
    file.write((const char *)data, size);
    file.close();
    if (!file)
        fail("cannot write %s", name.c_str());
}

/* One line to standard output, at once. */
inline void say(const char *kind, const std::string &text)
{
    std::cout << kind << ' ' << text << std::endl;
}

/* Say what `start` says of itself, and answer requests until standard input ends. */
inline int serve(const std::function<std::string()> &start, const std::function<void(const std::string &)> &work)
{
    try {
        say("ready", start());
    } catch (const std::exception &error) {
        say("unavailable", error.what());
        return 1;
    }
    for (std::string line; std::getline(std::cin, line);) {
        try {
            work(line);
            say("ok", "");
        } catch (const std::exception &error) {
            say("failed", error.what());
        }
    }
    return 0;
}
