/* Full-screen passes as requests to a server (serve.h), for any Direct3D: d3d9run.cpp and d3d11run.cpp give the device.
 *
 *   clear                        forget all textures
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
 * FILEs are names in the working directory. A pixel shader's is read once: other contents need another name.
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
static const std::map<std::string, Format> FORMATS_BY_NAME = {{"half4", {0, 8}}, {"float4", {1, 16}}, {"float1", {2, 4}}};

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

/* What there is, and what the next draw reads. A Device has the types Handle and Pixel, makes them and draws. A name or
 * number that is not there is std::out_of_range. */
template <typename Device> struct Passes {
    using Texture = ::Texture<typename Device::Handle>;
    using Pixel = typename Device::Pixel;

    struct Input {
        const Texture *texture;
        bool linear;
    };

    Device device{};
    std::map<int, Texture> textures{};
    std::map<std::string, ComPtr<Pixel>> shaders{};
    Pixel *pixel = nullptr;
    std::array<Input, NUM_SLOTS> inputs{}; /* without a texture: empty */
    std::array<float, NUM_VALUES> values{};
    std::array<int, 4> viewport{};

    void make(Texture &texture, std::istream &rest)
    {
        std::string format, file;
        rest >> texture.width >> texture.height >> format >> file;
        texture.format = FORMATS_BY_NAME.at(format);
        device.make(texture, file.empty() ? nullptr : read_file(file).data());
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
        std::string pixels((size_t)texture.row_bytes() * texture.height, '\0');
        device.read_back(texture, pixels.data());
        write_file(file, pixels.data(), pixels.size());
    }

    void take(const std::string &request)
    {
        std::istringstream rest(request);
        int number, slot;
        std::string word, name;
        rest >> word;
        if (word == "clear")
            textures.clear();
        else if (word == "texture" && rest >> number)
            make(textures[number], rest);
        else if (word == "vertex" && rest >> name)
            device.use_vertex_shader(read_file(name));
        else if (word == "pixel" && rest >> name) {
            if (!shaders.count(name))
                device.make(read_file(name), &shaders[name]);
            pixel = shaders[name].Get();
        } else if (word == "input" && rest >> slot >> number >> name)
            inputs.at(slot) = {&textures.at(number), name == "linear"};
        else if (word == "values")
            for (size_t index = 0; rest >> name; index++)
                values.at(index) = strtof(name.c_str(), nullptr); /* inf and nan too */
        else if (word == "viewport")
            for (int &number : viewport)
                rest >> number;
        else if (word == "draw")
            draw(rest);
        else if (word == "keep" && rest >> number >> name)
            keep(textures.at(number), name);
        else
            fail("cannot use '%.200s'", request.c_str());
    }
};

/* Take requests on a device. */
template <typename Device> int serve_device()
{
    Passes<Device> passes;
    return serve([&] { return passes.device.start(); }, [&](const std::string &request) { passes.take(request); });
}
