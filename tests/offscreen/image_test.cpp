#include "pcm/offscreen/image.h"

#include "tests/faults.h"
#include "tests/support.h"

#include "pcm/system/error.h"

#include <filesystem>
#include <fstream>
#include <random>

namespace {

using namespace pcm;
namespace fs = std::filesystem;

Image noise(int width, int height, unsigned seed)
{
    std::mt19937 random(seed);
    Image image{width, height, {}};
    for (int i = 0; i < width * height * 4; ++i) image.rgba.push_back(static_cast<std::uint8_t>(random()));
    return image;
}

std::string bytes_of(const fs::path& file)
{
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

template <class Function>
ErrorCode code_of(Function&& function)
{
    try {
        function();
    } catch (const Error& error) {
        return error.code();
    }
    ADD_FAILURE() << "nothing was thrown";
    return ErrorCode::cancelled;
}

TEST(Png, KeepsEveryBit)
{
    const test::TemporaryFolder folder;
    for (const auto& [width, height] : {std::pair{1, 1}, {7, 3}, {64, 48}, {3, 300}}) {
        const Image image = noise(width, height, static_cast<unsigned>(width));
        write_png(folder / "a.png", image);
        EXPECT_EQ(read_png(folder / "a.png"), image);
        write_png(folder / "a.png", image, false);  // overwrites the file, opaque
        const Image opaque = read_png(folder / "a.png");
        ASSERT_EQ(opaque.rgba.size(), image.rgba.size());
        for (std::size_t i = 0; i < image.rgba.size(); ++i) EXPECT_EQ(opaque.rgba[i], i % 4 == 3 ? 255 : image.rgba[i]);
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()),
              1);  // nothing but the file
}

TEST(Png, TheUpperRowComesFirst)
{
    const test::TemporaryFolder folder;
    write_png(folder / "a.png", {1, 2, {255, 0, 0, 255, 0, 0, 255, 255}});
    EXPECT_EQ(read_png(folder / "a.png").pixel(0, 0)[0], 255);
    EXPECT_EQ(read_png(folder / "a.png").pixel(0, 1)[2], 255);
}

TEST(Png, SaysWhatCannotBeWritten)
{
    const test::TemporaryFolder folder;
    EXPECT_EQ(code_of([&] { write_png(folder / "a.png", Image{2, 2, {1, 2, 3}}); }), ErrorCode::invalid_argument);
    EXPECT_EQ(code_of([&] { write_png(folder / "a.png", Image{-1, -1, {0, 0, 0, 0}}); }), ErrorCode::invalid_argument);
    EXPECT_EQ(code_of([&] { write_png(folder / "a.png", Image{}); }), ErrorCode::invalid_argument);
    EXPECT_EQ(code_of([&] { write_png(folder / "none" / "a.png", noise(2, 2, 1)); }), ErrorCode::not_found);
    fs::create_directory(folder / "folder.png");
    EXPECT_EQ(code_of([&] { write_png(folder / "folder.png", noise(2, 2, 1)); }), ErrorCode::exists);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);  // the folder alone
}

// The bytes that numpy.save() writes, with as many blanks.
TEST(Npy, HasTheHeaderOfNumPyAndThePixels)
{
    const test::TemporaryFolder folder;
    const Image image{2, 1, {1, 2, 3, 4, 5, 6, 7, 8}};
    write_npy(folder / "a.npy", image);
    std::string header = "{'descr': '|u1', 'fortran_order': False, 'shape': (1, 2, 4), }";
    header += std::string(117 - header.size(), ' ') + "\n";
    const std::string before("\x93NUMPY\x01\x00\x76\x00", 10);
    EXPECT_EQ(bytes_of(folder / "a.npy"), before + header + "\x01\x02\x03\x04\x05\x06\x07\x08");
    write_npy(folder / "a.npy", image, false);
    EXPECT_NE(bytes_of(folder / "a.npy").find("(1, 2, 3)"), std::string::npos);
    EXPECT_EQ(bytes_of(folder / "a.npy").substr(128), "\x01\x02\x03\x05\x06\x07");
    for (const int size :
         {9, 10, 99, 100, 1000, 10000}) {  // as the number of digits grows the data stay where they are
        write_npy(folder / "a.npy", noise(size, 1, 1));
        EXPECT_EQ(bytes_of(folder / "a.npy").size(), 128 + 4 * static_cast<std::size_t>(size));
    }
    EXPECT_EQ(code_of([&] { write_npy(folder / "b.npy", Image{2, 2, {1, 2, 3}}); }), ErrorCode::invalid_argument);
    EXPECT_FALSE(fs::exists(folder / "b.npy"));
}

// Every call that changes files fails once: opening, writing, syncing, renaming.
TEST(Png, AFailedWriteLeavesTheOldPicture)
{
    const test::TemporaryFolder folder;
    const std::string program = (fs::read_symlink("/proc/self/exe").parent_path() / "write_picture").string();
    const std::vector<std::string> command{program, (folder / "a.png").string()};
    const long calls = test::count_calls(command, folder.path());
    EXPECT_GE(calls, 4);
    write_png(folder / "a.png", noise(2, 2, 1));
    const std::string old = bytes_of(folder / "a.png");
    for (const std::string kind : {"eio", "full"})
        for (long at = 1; at <= calls; ++at) {
            const test::Faulty result = test::run_with_fault(command, folder.path(), kind, at);
            if (kind == "full" && result.code == 0) {  // the call needed no space
                write_png(folder / "a.png", noise(2, 2, 1));
                continue;
            }
            EXPECT_EQ(result.code, 1) << kind << " at call " << at;
            EXPECT_NE(result.err.find("a.png"), std::string::npos) << result.err;
            EXPECT_EQ(bytes_of(folder / "a.png"), old) << kind << " at call " << at;
            EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
        }
}

TEST(Png, DamageIsReportedAndHarmless)
{
    const test::TemporaryFolder folder;
    write_png(folder / "whole.png", noise(20, 20, 5));
    const std::string whole = bytes_of(folder / "whole.png");
    EXPECT_EQ(code_of([&] { read_png(folder / "none.png"); }), ErrorCode::not_found);
    const auto read = [&](const std::string& bytes) {
        std::ofstream(folder / "bad.png", std::ios::binary) << bytes;
        return code_of([&] { read_png(folder / "bad.png"); });
    };
    for (std::size_t length = 0; length + 16 < whole.size(); length += 7)
        EXPECT_EQ(read(whole.substr(0, length)), ErrorCode::bad_format) << length;
    std::string huge = whole;  // its header says 2^30 x 2^30 pixels, and its checksum is wrong
    huge[16] = huge[20] = 0x40;
    EXPECT_EQ(read(huge), ErrorCode::bad_format);
    std::string turned = whole;
    turned[whole.size() / 2] = static_cast<char>(~turned[whole.size() / 2]);
    EXPECT_EQ(read(turned), ErrorCode::bad_format);
}

TEST(Image, ColoursAreDividedByTheirAlpha)
{
    Image image{4, 1, {10, 20, 30, 0, 10, 20, 30, 255, 64, 128, 32, 128, 200, 1, 0, 100}};
    unpremultiply(image);
    EXPECT_EQ(image.rgba,
              (std::vector<std::uint8_t>{10, 20, 30, 0, 10, 20, 30, 255, 128, 255, 64, 128, 255, 3, 0, 100}));
}

}  // namespace
