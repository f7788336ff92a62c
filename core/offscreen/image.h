// A picture in memory, and as a PNG file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace pcm {

// Four bytes a pixel, red, green, blue, alpha; the upper row first.
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

// Colours that were multiplied with their alpha, as blending leaves them over a transparent background, divided by it,
// as PNG wants them.
void unpremultiply(Image& image);

// Written beside the file and put in its place when it is whole. Without `alpha` the pixels are opaque, and a quarter
// is saved. Throws Error(invalid_argument) for an image whose bytes do not match its size, Error(permission | no_space
// | io ...).
void write_png(const std::filesystem::path& file, const Image& image, bool alpha = true);

// Any PNG, made to four bytes a pixel. Throws Error(not_found | permission | bad_format | unsupported); unsupported are
// pictures of more than 2^28 pixels.
Image read_png(const std::filesystem::path& file);

}  // namespace pcm
