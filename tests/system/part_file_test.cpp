// Working names, and small things of outputs: renamed errors, waits, fields, extensions, names of list entries, pages.
#include "pcm/system/part_file.h"

#include "pcm/lists/undo_list.h"
#include "pcm/system/error.h"
#include "pcm/system/new_output.h"
#include "pcm/system/page_allocator.h"
#include "pcm/system/renamed_error.h"
#include "pcm/system/seconds.h"
#include "tests/support.h"

#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

std::string refusal(const std::function<void()>& call)
{
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(PartFile, NamesAreDistinctAndRecognised)
{
    std::set<std::filesystem::path> names;
    for (int i = 0; i < 50; ++i) {
        const auto name = new_part_name("/tmp/folder/a.b");
        EXPECT_EQ(name.parent_path(), "/tmp/folder");
        EXPECT_TRUE(is_part_name(name.filename().string(), "a.b"));
        EXPECT_FALSE(is_part_name(name.filename().string(), "a"));
        EXPECT_FALSE(is_part_name(name.filename().string(), ""));
        EXPECT_NE(name.string().find(".part-" + std::to_string(::getpid()) + "-"), std::string::npos);
        names.insert(name);
    }
    EXPECT_EQ(names.size(), 50u);
    EXPECT_TRUE(is_part_name("x.part-1-2", "x"));
    EXPECT_TRUE(is_part_name("x.part-0123456789-9876543210", "x"));
    for (const char* other :
         {"x", "x.part", "x.part-", "x.part--", "x.part-1", "x.part-1-", "x.part--1", "x.part-1-2-3", "x.part-1-2a",
          "x.part-a-2", "x.part-1a-2", "y.part-1-2", "xx.part-1-2", "x.part-1-2 "})
        EXPECT_FALSE(is_part_name(other, "x")) << other;
}

TEST(PartFile, OnlyAbandonedPartsAreRemoved)
{
    TemporaryFolder folder;
    const auto out = folder / "out.las";
    const auto write = [&](const std::string& name) { std::ofstream(folder / name) << "x"; };
    write("out.las.part-1-1");
    write("out.las.part-1-22");
    write("out.las.part-1");
    write("other.las.part-1-1");
    write("out.las");
    std::filesystem::create_directory(folder / "out.las.part-3-3");
    std::filesystem::create_symlink(folder / "out.las", folder / "out.las.part-4-4");
    std::optional<File> mine = make_part(out);
    const auto held = mine->path();
    EXPECT_TRUE(is_part_name(held.filename().string(), "out.las"));
    remove_abandoned_parts(out);
    const auto there = [&](const std::string& name) { return std::filesystem::exists(folder / name); };
    EXPECT_FALSE(there("out.las.part-1-1"));
    EXPECT_FALSE(there("out.las.part-1-22"));
    EXPECT_TRUE(there("out.las.part-1"));
    EXPECT_TRUE(there("other.las.part-1-1"));
    EXPECT_TRUE(there("out.las"));
    EXPECT_TRUE(there("out.las.part-3-3")) << "a folder";
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "out.las.part-4-4"));
    EXPECT_TRUE(std::filesystem::exists(held)) << "locked by this process";
    mine.reset();
    remove_abandoned_parts(out);
    EXPECT_FALSE(std::filesystem::exists(held));
    EXPECT_NO_THROW(remove_abandoned_parts(folder / "none" / "out.las"));
}

TEST(PartFile, AFileWithoutANameGetsOne)
{
    TemporaryFolder folder;
    File file = File::without_name(folder.path());
    std::string text(3000000, 'a');
    for (std::size_t i = 0; i < text.size(); i += 7) text[i] = static_cast<char>('b' + i % 20);
    file.write_at(text.data(), text.size(), 0);
    file.sync();
    const auto name = name_part(file, folder / "out");
    EXPECT_TRUE(is_part_name(name.filename().string(), "out"));
    std::ifstream in(name, std::ios::binary);
    EXPECT_TRUE(std::string(std::istreambuf_iterator<char>(in), {}) == text);
}

TEST(RenamedErrors, NameTheOtherPathEverywhere)
{
    EXPECT_EQ(renamed(std::string("/a/x is in /a, not in /a/x/y"), "/a/x", "/b"), "/b is in /a, not in /b/y");
    EXPECT_EQ(renamed(std::string("aa aaa"), "a", "aa"), "aaaa aaaaaa") << "what was put in is not replaced again";
    EXPECT_EQ(renamed(std::string("text"), "", "/b"), "text");
    const Error error(ErrorCode::truncated, "/a/x/f", "the file /a/x/g is short", "see /a/x");
    const Error other = renamed(error, "/a/x", "/tree");
    EXPECT_EQ(other.code(), ErrorCode::truncated);
    EXPECT_EQ(other.path(), "/tree/f");
    EXPECT_EQ(std::string(other.what()).find("/a/x"), std::string::npos) << other.what();
    EXPECT_EQ(std::string(other.what()).find("/tree/f: the file /tree/g is short"), 0u) << other.what();
    EXPECT_NE(std::string(other.what()).find("see /tree"), std::string::npos) << other.what();
    EXPECT_EQ(other.hint(), "see /tree");
    EXPECT_EQ(text_alone(other), "the file /tree/g is short");
    EXPECT_EQ(std::string(renamed(Error(ErrorCode::io, {}, "no path"), "/a", "/b").what()), "no path");
}

TEST(Waits, NoneIsNotTheSooner)
{
    EXPECT_EQ(sooner(2, 3), 2);
    EXPECT_EQ(sooner(3, 2), 2);
    EXPECT_EQ(sooner(0, 3), 3);
    EXPECT_EQ(sooner(3, 0), 3);
    EXPECT_EQ(sooner(0, 0), 0);
}

TEST(NewOutputs, ExistingFilesAreReplacedOnlyWhenAsked)
{
    TemporaryFolder folder;
    std::ofstream(folder / "there") << "x";
    EXPECT_NO_THROW(check_output(folder / "new", false));
    EXPECT_NO_THROW(check_output(folder / "there", true));
    const std::string text = refusal([&] { check_output(folder / "there", false); });
    EXPECT_NE(text.find((folder / "there").string() + ": the output exists already"), std::string::npos) << text;
    EXPECT_NE(text.find("choose another name, or overwrite it"), std::string::npos) << text;
    EXPECT_EQ(lower_extension("/a.B/name.LaZ"), ".laz");
    EXPECT_EQ(lower_extension("/a.B/name"), "");
    EXPECT_EQ(csv_field("plain text; 'quoted'"), "plain text; 'quoted'");
    EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
    EXPECT_EQ(csv_field("a\nb"), "\"a\nb\"");
    EXPECT_EQ(csv_field("a\rb"), "\"a\rb\"");
    EXPECT_EQ(csv_field("say \"a\""), "\"say \"\"a\"\"\"");
    EXPECT_EQ(csv_field(""), "");
}

TEST(ListNames, AreShortTextsWithoutControlCharacters)
{
    const auto refused = [](const std::string& name) { return refusal([&] { check_list_name(name, "plane"); }); };
    EXPECT_EQ(refused("roof \xc3\xa4 ~"), "");
    EXPECT_EQ(refused(std::string(1000, 'a')), "");
    EXPECT_EQ(refused(std::string(1001, 'a')), "the name of a plane is longer than 1000 bytes");
    EXPECT_EQ(refused(""), "the name of a plane is empty");
    for (const char c : {'\0', '\n', '\x1f', '\x7f'})
        EXPECT_EQ(refused(std::string("a") + c), "the name of a plane has control characters") << int(c);
    EXPECT_EQ(refused(" "), "");
    EXPECT_EQ(refusal([] { refuse_index("plane", 4, 4); }), "there is no plane number 5; the list has 4");
}

TEST(Pages, BlocksAreWholeAndDistinctAndCounted)
{
    const std::size_t before = pages_in_use();
    std::vector<std::pair<unsigned char*, std::size_t>> blocks;
    for (int round = 0; round < 3; ++round) {
        for (std::size_t i = 0; i < 40; ++i) {
            const std::size_t bytes = page_block_bytes + i * 4999 % 300000;
            auto* block = static_cast<unsigned char*>(take_pages(bytes));
            EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block) % 16, 0u);
            std::memset(block, static_cast<int>(i), bytes);
            blocks.emplace_back(block, bytes);
        }
        for (std::size_t i = 0; i < blocks.size(); ++i)
            for (std::size_t k = 0; k < blocks[i].second; k += 997) ASSERT_EQ(blocks[i].first[k], i % 40);
        for (const auto& [block, bytes] : blocks) give_pages(block, bytes);
        blocks.clear();
        EXPECT_EQ(pages_in_use(), before);
    }
    {
        PageVector<double> large(page_block_bytes / sizeof(double)), small(page_block_bytes / sizeof(double) - 1);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
        EXPECT_GE(pages_in_use(), before + page_block_bytes);
        EXPECT_LT(pages_in_use(), before + 2 * page_block_bytes) << "small ones are the C library's";
#endif
    }
    EXPECT_EQ(pages_in_use(), before);
    EXPECT_THROW(PageAllocator<double>().allocate(static_cast<std::size_t>(-1) / 16 + 1), std::bad_alloc);
}

}  // namespace
