#include "pcm/offscreen/image.h"

#include "pcm/system/error.h"
#include "pcm/system/output_file.h"

#include <png.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {
namespace {

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using InputFile = std::unique_ptr<std::FILE, Close>;

// libpng's simplified interface keeps the first error as text.
struct Png {
    png_image image{};
    Png() { image.version = PNG_IMAGE_VERSION; }
    ~Png() { png_image_free(&image); }
    Png(const Png&) = delete;
    Png& operator=(const Png&) = delete;
};

// The bytes that a file has: of each pixel four, or three without alpha.
std::vector<std::uint8_t> pixels_of(const std::filesystem::path& file, const Image& image, bool alpha)
{
    const auto pixels = static_cast<std::size_t>(image.width > 0 ? image.width : 0) *
                        static_cast<std::size_t>(image.height > 0 ? image.height : 0);
    if (pixels == 0 || image.rgba.size() != 4 * pixels)
        throw Error(ErrorCode::invalid_argument, file,
                    "a picture of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                        " pixels with " + std::to_string(image.rgba.size()) + " bytes cannot be written");
    if (alpha) return image.rgba;
    std::vector<std::uint8_t> opaque(3 * pixels);
    for (std::size_t i = 0; i < pixels; ++i) std::memcpy(&opaque[3 * i], &image.rgba[4 * i], 3);
    return opaque;
}

}  // namespace

void unpremultiply(Image& image)
{
    for (std::size_t i = 0; i + 3 < image.rgba.size(); i += 4) {
        const unsigned alpha = image.rgba[i + 3];
        if (alpha == 0 || alpha == 255) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const unsigned value = (image.rgba[i + c] * 255u + alpha / 2) / alpha;
            image.rgba[i + c] = static_cast<std::uint8_t>(value < 255 ? value : 255);
        }
    }
}

void write_png(const std::filesystem::path& file, const Image& image, bool alpha)
{
    const std::vector<std::uint8_t> pixels = pixels_of(file, image, alpha);
    Png png;
    png.image.width = static_cast<png_uint_32>(image.width);
    png.image.height = static_cast<png_uint_32>(image.height);
    png.image.format = alpha ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png.image);
    std::vector<std::byte> encoded(size);
    if (!png_image_write_to_memory(&png.image, encoded.data(), &size, 0, pixels.data(), 0, nullptr))
        throw Error(ErrorCode::io, file, std::string("encoding the picture failed: ") + png.image.message);
    OutputFile out(file);
    out.append(encoded.data(), size);
    out.finish();
}

void write_npy(const std::filesystem::path& file, const Image& image, bool alpha)
{
    const std::vector<std::uint8_t> pixels = pixels_of(file, image, alpha);
    std::string header = "{'descr': '|u1', 'fortran_order': False, 'shape': (" + std::to_string(image.height) + ", " +
                         std::to_string(image.width) + ", " + (alpha ? "4" : "3") + "), }";
    constexpr std::size_t before = 10, step = 64;  // bytes of magic, version and length; the data begin at a multiple
    header.append(step - 1 - (before + header.size()) % step, ' ');
    header += '\n';
    const char length[2] = {static_cast<char>(header.size() & 0xff), static_cast<char>(header.size() >> 8)};
    OutputFile out(file);
    out.append(std::string_view("\x93NUMPY\x01\x00", 8));
    out.append(length, sizeof length);
    out.append(header);
    out.append(pixels.data(), pixels.size());
    out.finish();
}

Image read_png(const std::filesystem::path& file)
{
    errno = 0;
    const InputFile in(std::fopen(file.c_str(), "rb"));
    if (!in) throw Error::from_errno(errno, file, "opening the picture");
    Png png;
    if (!png_image_begin_read_from_stdio(&png.image, in.get()))
        throw Error(ErrorCode::bad_format, file, std::string("this is not a PNG picture: ") + png.image.message);
    if (std::uint64_t(png.image.width) * png.image.height > (std::uint64_t(1) << 28))
        throw Error(ErrorCode::unsupported, file,
                    "a picture of " + std::to_string(png.image.width) + " x " + std::to_string(png.image.height) +
                        " pixels; at most 2^28 of them are read");
    png.image.format = PNG_FORMAT_RGBA;
    Image image;
    image.width = static_cast<int>(png.image.width);
    image.height = static_cast<int>(png.image.height);
    image.rgba.resize(std::size_t(png.image.width) * png.image.height * 4);
    if (!png_image_finish_read(&png.image, nullptr, image.rgba.data(), 0, nullptr))
        throw Error(ErrorCode::bad_format, file, std::string("the PNG picture is damaged: ") + png.image.message);
    return image;
}

}  // namespace pcm
