// A picture in memory, and as a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace pcm {

// Four bytes per pixel: red, green, blue, alpha. The top row comes first.
struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba;  // width * height * 4

    const std::uint8_t* pixel(int x, int y) const
    {
        return rgba.data() +
               4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
    }
    bool operator==(const Image& o) const { return width == o.width && height == o.height && rgba == o.rgba; }
};

// Divides colours by their alpha. Blending over a transparent background leaves colours premultiplied; PNG stores them
// unpremultiplied.
void unpremultiply(Image& image);

// Replaces the file atomically and durably (system/output_file.h). Without `alpha` the pixels are opaque, which saves a
// quarter of the bytes before compression. Throws Error(invalid_argument) for an image whose bytes do not match its
// size, Error(not_found | permission | no_space | io).
void write_png(const std::filesystem::path& file, const Image& image, bool alpha = true);

// The same as an array of bytes, height x width x 4 (without `alpha` x 3), in NumPy's format NPY 1.0
// (https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html). Throws as write_png().
void write_npy(const std::filesystem::path& file, const Image& image, bool alpha = true);

// Any PNG, converted to four bytes per pixel. Throws Error(not_found | permission | bad_format), and Error(unsupported)
// for more than 2^28 pixels.
Image read_png(const std::filesystem::path& file);

}  // namespace pcm
