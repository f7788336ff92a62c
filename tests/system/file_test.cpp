#include "pcm/system/file.h"

#include "pcm/system/error.h"
#include "tests/support.h"

#include <sys/stat.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace {

using namespace pcm;

std::string contents(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

ErrorCode code_of(const std::function<void()>& f)
{
    try {
        f();
    } catch (const Error& error) {
        return error.code();
    }
    ADD_FAILURE() << "nothing was thrown";
    return ErrorCode::io;
}

TEST(File, ErrorsNameThePath)
{
    const test::TemporaryFolder folder;
    try {
        File(folder / "nothing", File::Mode::read);
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::not_found);
        EXPECT_NE(std::string(error.what()).find("nothing"), std::string::npos);
    }
    std::ofstream(folder / "short") << "12345";
    const File file(folder / "short", File::Mode::read);
    char buffer[10];
    EXPECT_EQ(file.read_some_at(buffer, 10, 2), 3u);
    try {
        file.read_at(buffer, 10, 2);
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::truncated);
        EXPECT_NE(std::string(error.what()).find("ends at byte 5"), std::string::npos) << error.what();
    }
    EXPECT_THROW(File(folder / "short", File::Mode::create_new), Error);
}

TEST(File, ReplaceByABareName)
{
    const test::TemporaryFolder folder;
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(folder.path());
    replace_file("f", "text", 4);
    std::filesystem::current_path(before);
    EXPECT_EQ(std::filesystem::file_size(folder / "f"), 4u);
}

TEST(File, ReplaceLeavesTheOldOneWhenItFails)
{
    const test::TemporaryFolder folder;
    replace_file(folder / "f", "old", 3);
    std::filesystem::create_directory(folder / "f.new");  // in the way of the temporary file
    EXPECT_THROW(replace_file(folder / "f", "newer", 5), Error);
    std::ifstream file(folder / "f");
    std::string text;
    file >> text;
    EXPECT_EQ(text, "old");
}

TEST(File, EachModeOpensAsItsNameSays)
{
    const test::TemporaryFolder folder;
    const auto path = folder / "f";
    EXPECT_EQ(code_of([&] { File(path, File::Mode::read); }), ErrorCode::not_found);
    EXPECT_EQ(code_of([&] { File(path, File::Mode::change); }), ErrorCode::not_found);
    EXPECT_EQ(code_of([&] { File(folder / "no/such/folder", File::Mode::create_new); }), ErrorCode::not_found);
    File(path, File::Mode::create_new).write_at("0123456789", 10, 0);
    EXPECT_EQ(code_of([&] { File(path, File::Mode::create_new); }), ErrorCode::exists);
    {
        File file(path, File::Mode::change);
        EXPECT_EQ(file.size(), 10u);
        file.write_at("ab", 2, 3);
        file.write_at("z", 1, 12);  // beyond the end: zeros in between
    }
    EXPECT_EQ(contents(path), std::string("012ab56789\0\0z", 13));
    EXPECT_EQ(code_of([&] { File(path, File::Mode::read).write_at("x", 1, 0); }), ErrorCode::io);
    File file(path, File::Mode::create_or_truncate);
    EXPECT_EQ(file.size(), 0u);
}

constexpr File::Mode all_modes[] = {File::Mode::read, File::Mode::create_new, File::Mode::create_or_truncate,
                                    File::Mode::change, File::Mode::change_or_create};

TEST(File, NothingIsWrittenThroughALink)
{
    const test::TemporaryFolder folder;
    for (const File::Mode mode : all_modes) {
        if (mode == File::Mode::read) continue;
        std::ofstream(folder / "other") << "precious";
        std::filesystem::remove(folder / "link");
        std::filesystem::create_symlink("other", folder / "link");
        try {
            File(folder / "link", mode).write_at("xyz", 3, 0);
            EXPECT_EQ(mode, File::Mode::create_or_truncate);  // it has replaced the link
            EXPECT_FALSE(std::filesystem::is_symlink(folder / "link"));
        } catch (const Error& error) {
            EXPECT_NE(error.code(), ErrorCode::not_found) << error.what();
        }
        EXPECT_EQ(contents(folder / "other"), "precious");
        // A link to nothing makes no file elsewhere.
        std::filesystem::remove(folder / "link");
        std::filesystem::create_symlink("made", folder / "link");
        try {
            File(folder / "link", mode);
        } catch (const Error&) {
        }
        EXPECT_FALSE(std::filesystem::exists(folder / "made"));
    }
    std::filesystem::remove(folder / "link");
    std::filesystem::create_symlink("other", folder / "link");
    EXPECT_EQ(File(folder / "link", File::Mode::read).size(), 8u);
}

TEST(File, ANewFileLeavesTheOtherNamesOfTheOldOneAlone)
{
    const test::TemporaryFolder folder;
    std::ofstream(folder / "other") << "precious";
    std::filesystem::create_hard_link(folder / "other", folder / "same");
    File(folder / "same", File::Mode::create_or_truncate).write_at("xyz", 3, 0);
    EXPECT_EQ(contents(folder / "other"), "precious");
    EXPECT_EQ(contents(folder / "same"), "xyz");
    {
        File(folder / "other", File::Mode::change_or_create);
    }
    EXPECT_EQ(contents(folder / "other"), "precious");
}

TEST(File, WhatIsNoRegularFileIsRefusedAtOnce)
{
    const test::TemporaryFolder folder;
    ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0666), 0);
    std::filesystem::create_directory(folder / "folder");
    std::filesystem::create_symlink("fifo", folder / "link");
    std::filesystem::create_symlink("/dev/zero", folder / "zeros");
    for (const char* name : {"folder", "link", "zeros", "fifo"})
        for (const File::Mode mode : all_modes) {
            if (mode == File::Mode::create_or_truncate) continue;  // replaces what has the name
            try {
                File(folder / name, mode);
                ADD_FAILURE() << name << " was opened";
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), mode == File::Mode::create_new ? ErrorCode::exists : ErrorCode::unsupported)
                    << error.what();
            }
        }
    EXPECT_THROW(File(folder / "folder", File::Mode::create_or_truncate), Error);
    {
        File(folder / "fifo", File::Mode::create_or_truncate);
    }
    EXPECT_TRUE(std::filesystem::is_regular_file(folder / "fifo"));
}

TEST(File, AMoveLeavesTheSourceClosed)
{
    const test::TemporaryFolder folder;
    File first(folder / "a", File::Mode::create_new);
    const int descriptor = first.descriptor();
    File second(std::move(first));
    EXPECT_FALSE(first.is_open());  // NOLINT: what it is after a move is tested
    EXPECT_EQ(second.descriptor(), descriptor);
    File third(folder / "b", File::Mode::create_new);
    third = std::move(second);
    EXPECT_EQ(third.descriptor(), descriptor);
    EXPECT_EQ(third.path(), folder / "a");
    third.close();
    EXPECT_FALSE(third.is_open());
    EXPECT_NO_THROW(third.close());
    EXPECT_EQ(code_of([&] { third.size(); }), ErrorCode::io);
}

TEST(File, ThreadsReadAndWriteAtOnce)
{
    const test::TemporaryFolder folder;
    File file(folder / "f", File::Mode::create_new);
    constexpr std::size_t threads = 4, records = 500;
    std::vector<std::thread> all;
    for (std::size_t t = 0; t < threads; ++t)
        all.emplace_back([&, t] {
            for (std::size_t i = 0; i < records; ++i) {
                const std::uint64_t offset = (i * threads + t) * sizeof(std::uint64_t), value = offset * 31 + 7;
                file.write_at(&value, sizeof value, offset);
                std::uint64_t back = 0;
                file.read_at(&back, sizeof back, offset);
                EXPECT_EQ(back, value);
            }
        });
    for (std::thread& thread : all) thread.join();
    for (std::size_t i = 0; i < threads * records; ++i) {
        std::uint64_t value = 0;
        file.read_at(&value, sizeof value, i * sizeof value);
        ASSERT_EQ(value, i * sizeof value * 31 + 7);
    }
}

}  // namespace
