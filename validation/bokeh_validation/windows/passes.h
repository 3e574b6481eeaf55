/* A list of full-screen passes as a job of a server (serve.h), for any Direct3D: d3d9run.cpp and d3d11run.cpp give the
 * device.
 *
 * A job file is text, one command a line, done in this order:
 *
 *   texture N W H FORMAT FILE    make texture N from a file: rows from v = 0 on without gaps. FORMAT is half4, float4
 *                                or float1
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
#pragma once

#include <array>
#include <cstring>
#include <map>
#include <vector>

#include "renderer.h"
#include "serve.h"

constexpr int NUM_SLOTS = 16;  /* what shader model 3 has; a pass reads fewer */
constexpr int NUM_VALUES = 36; /* room for the parameters; a multiple of 4, since they are a constant buffer */
constexpr int MAX_TARGETS = 4; /* what Direct3D 9 cards have at the most */

/* FORMATS of a program are in this order. */
constexpr struct {
    const char *name;
    int bytes;
} TEXELS[] = {{"half4", 8}, {"float4", 16}, {"float1", 4}};

template <typename Handle> struct Texture {
    int width, height, format;
    ComPtr<Handle> handle;

    int row_bytes() const { return width * TEXELS[format].bytes; }
};

struct Area {
    int x, y, width, height;
};

/* A job so far, and what the next draw reads. A Device has types Handle, Vertex and Pixel, and makes and draws them. */
template <typename Device> struct Job {
    using Texture = ::Texture<typename Device::Handle>;

    struct Input {
        const Texture *texture; /* null: empty */
        bool linear;
    };

    std::map<int, Texture> textures;
    typename Device::Vertex *vertex = nullptr;
    typename Device::Pixel *pixel = nullptr;
    std::array<Input, NUM_SLOTS> inputs{};
    std::array<float, NUM_VALUES> values{};
    Area viewport{};

    Texture &find(int number)
    {
        if (!textures.count(number))
            fail("texture %d is not there", number);
        return textures[number];
    }

    void add(Device &device, std::istream &rest, int number, int width, int height, const std::string &format)
    {
        int kind = 0;
        while (kind < (int)std::size(TEXELS) && format != TEXELS[kind].name)
            kind++;
        if (kind == (int)std::size(TEXELS))
            fail("no format %s", format.c_str());
        if (textures.count(number))
            fail("texture %d is there already", number);
        Texture made{width, height, kind, nullptr};
        if (std::string file; rest >> file) {
            std::string pixels = read_file(file);
            if (pixels.size() != (size_t)made.row_bytes() * height)
                fail("%s has %zu bytes", file.c_str(), pixels.size());
            device.fill(made, pixels.data());
        } else
            device.make_target(made);
        textures[number] = made;
    }

    void draw(Device &device, std::istream &numbers)
    {
        if (!vertex || !pixel || !viewport.width)
            fail("draw needs viewport, vertex and pixel before it");
        std::vector<Texture *> targets;
        for (int number; numbers >> number;)
            targets.push_back(&find(number));
        if (targets.empty() || targets.size() > MAX_TARGETS)
            fail("draw needs 1 to %d numbers", MAX_TARGETS);
        device.draw(*this, targets);
        inputs = {};
    }

    void keep(Device &device, int number, const std::string &file)
    {
        const Texture &texture = find(number);
        std::vector<char> pixels((size_t)texture.row_bytes() * texture.height);
        device.read_back(texture, pixels.data());
        write_file(file, pixels.data(), pixels.size());
    }

    /* Do one line. False where it means nothing. */
    bool take(Device &device, const std::string &word, std::istream &rest)
    {
        int number, slot, width, height;
        std::string name;
        if (word == "texture" && rest >> number >> width >> height >> name)
            add(device, rest, number, width, height, name);
        else if (word == "vertex" && rest >> name)
            vertex = device.vertex(name);
        else if (word == "pixel" && rest >> name)
            pixel = device.pixel(name);
        else if (word == "input" && rest >> slot >> number >> name) {
            if (slot < 0 || slot >= NUM_SLOTS)
                fail("no slot %d", slot);
            inputs[slot] = {&find(number), name == "linear"};
        } else if (word == "values") {
            size_t count = 0;
            for (std::string text; rest >> text; values[count++] = strtof(text.c_str(), nullptr)) /* inf and nan too */
                if (count == values.size())
                    fail("no parameter %d", NUM_VALUES);
        } else if (word == "draw")
            draw(device, rest);
        else if (word == "keep" && rest >> number >> name)
            keep(device, number, name);
        else
            return word == "viewport" && rest >> viewport.x >> viewport.y >> viewport.width >> viewport.height;
        return true;
    }
};

/* Take jobs on a device. */
template <typename Device> int serve_device()
{
    Device device;
    auto start = [&] {
        char name[512];
        auto [adapter, kind] = device.start();
        device_name(adapter.c_str(), name, sizeof name);
        return name + (", " + kind);
    };
    return serve(start, [&](const std::string &name) {
        Job<Device> job;
        each_line(name, [&](auto &word, auto &rest) { return job.take(device, word, rest); });
    });
}

/* What `make` makes of a file, once for each name. */
template <typename Shader, typename Make>
Shader *cached(std::map<std::string, ComPtr<Shader>> &known, const std::string &name, const Make &make)
{
    if (!known.count(name)) {
        ComPtr<Shader> made;
        make(read_file(name), &made);
        known[name] = made;
    }
    return known[name].Get();
}
