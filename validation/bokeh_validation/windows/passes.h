/* A list of full-screen passes as a request to a server (serve.h), for any Direct3D: d3d9run.cpp and d3d11run.cpp give the
 * device.
 *
 * A request is the name of a file: text, one command a line, done in this order:
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
 * All textures are gone after the request.
 */
#pragma once

#include <array>
#include <cstring>
#include <map>
#include <vector>

#include "serve.h"

constexpr int NUM_SLOTS = 16; /* what shader model 3 has; a pass reads fewer */
/* NUM_VALUES, room for the parameters, comes from the build: a multiple of 4, since they are a constant buffer */

/* Place in the FORMATS of a program, and bytes of a texel. */
struct Format {
    int index, bytes;
};
static const std::map<std::string, Format> FORMATS_BY_NAME = {
    {"half4", {0, 8}}, {"float4", {1, 16}}, {"float1", {2, 4}}};

template <typename Handle> struct Texture {
    int width, height;
    Format format;
    ComPtr<Handle> handle;

    int row_bytes() const { return width * format.bytes; }
};

/* Copy rows between memory without gaps and a mapped texture. */
inline void copy_rows(void *to, size_t to_pitch, const void *from, size_t from_pitch, int rows, size_t bytes)
{
    for (int row = 0; row < rows; row++)
        memcpy((char *)to + row * to_pitch, (const char *)from + row * from_pitch, bytes);
}

struct Area {
    int x, y, width, height;
};

/* A request so far, and what the next draw reads. A Device has types Handle, Vertex and Pixel, and makes and draws
 * them; its shaders stay from request to request. A name or number that is not there is std::out_of_range. */
template <typename Device> struct Passes {
    using Texture = ::Texture<typename Device::Handle>;

    struct Input {
        const Texture *texture; /* null: empty */
        bool linear;
    };

    Device &device;
    std::map<int, Texture> textures{};
    typename Device::Vertex *vertex = nullptr;
    typename Device::Pixel *pixel = nullptr;
    std::array<Input, NUM_SLOTS> inputs{};
    std::array<float, NUM_VALUES> values{};
    Area viewport{};

    void add(Texture &texture, const std::string &file)
    {
        std::string pixels = file.empty() ? "" : read_file(file);
        if (!file.empty() && pixels.size() != (size_t)texture.row_bytes() * texture.height)
            fail("%s has %zu bytes", file.c_str(), pixels.size());
        device.make(texture, file.empty() ? nullptr : pixels.data());
    }

    void draw(std::istream &numbers)
    {
        std::vector<Texture *> targets;
        for (int number; numbers >> number;)
            targets.push_back(&textures.at(number));
        device.draw(*this, targets);
        inputs = {};
    }

    void keep(const Texture &texture, const std::string &file)
    {
        std::vector<char> pixels((size_t)texture.row_bytes() * texture.height);
        device.read_back(texture, pixels.data());
        write_file(file, pixels.data(), pixels.size());
    }

    /* Do one line. False where it means nothing. */
    bool take(const std::string &word, std::istream &rest)
    {
        int number, slot, width, height;
        std::string name, file;
        if (word == "texture" && rest >> number >> width >> height >> name) {
            rest >> file;
            add(textures[number] = {width, height, FORMATS_BY_NAME.at(name), nullptr}, file);
        } else if (word == "vertex" && rest >> name)
            vertex = cached(device.vertices, name);
        else if (word == "pixel" && rest >> name)
            pixel = cached(device.pixels, name);
        else if (word == "input" && rest >> slot >> number >> name)
            inputs.at(slot) = {&textures.at(number), name == "linear"};
        else if (word == "values") {
            size_t index = 0;
            for (std::string text; rest >> text;)
                values.at(index++) = strtof(text.c_str(), nullptr); /* inf and nan too */
        } else if (word == "draw")
            draw(rest);
        else if (word == "keep" && rest >> number >> name)
            keep(textures.at(number), name);
        else
            return word == "viewport" && rest >> viewport.x >> viewport.y >> viewport.width >> viewport.height;
        return true;
    }

    /* The shader of a file, made once for each name. */
    template <typename Shader> Shader *cached(std::map<std::string, ComPtr<Shader>> &known, const std::string &name)
    {
        if (!known.count(name))
            device.make(read_file(name), known[name].GetAddressOf());
        return known[name].Get();
    }
};

/* Take requests on a device. */
template <typename Device> int serve_device()
{
    Device device;
    return serve([&] { return device.start(); }, [&](const std::string &name) {
        Passes<Device> passes{device};
        std::istringstream text(read_file(name));
        for (std::string line, word; std::getline(text, line);) {
            std::istringstream rest(line);
            if (rest >> word && !passes.take(word, rest))
                fail("cannot use the line '%.200s'", line.c_str());
        }
    });
}
