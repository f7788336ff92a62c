// Trees in whose folder something else has the name of a file: links, FIFOs, devices, folders, files far too long.

#include "pcm/system/error.h"
#include "pcm/tree/about.h"
#include "pcm/tree/parse_beginning.h"
#include "pcm/tree/tree_lock.h"
#include "pcm/tree/verify.h"
#include "tests/tree/small_tree.h"

#include <sys/resource.h>
#include <sys/stat.h>

#include <fstream>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class ForeignFiles : public SmallTree {
protected:
    void expect_refused(ErrorCode code, const std::string& word) const
    {
        try {
            Tree::open(tree());
            ADD_FAILURE() << "opened where '" << word << "' was expected";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), code) << error.what();
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
        }
    }
    static void put_fifo(const fs::path& path)
    {
        fs::remove(path);
        ASSERT_EQ(mkfifo(path.c_str(), 0666), 0);
    }
    static long peak_kb()
    {
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        return usage.ru_maxrss;
    }
};

TEST_F(ForeignFiles, AnyFileOfATreeOpensIt)
{
    build();
    {
        const TreeLock lock(tree());
    }
    for (const char* name : {"index.pct", "about.pct", "chunks-000.bpc", "lock"})
        EXPECT_EQ(Tree::open(tree() / name)->info().points, 20000u) << name;
    const fs::path before = fs::current_path();
    fs::current_path(tree());
    EXPECT_EQ(Tree::open("chunks-000.bpc")->info().points, 20000u);
    fs::current_path(before);
    fs::create_symlink("out.pct/chunks-000.bpc", folder_ / "short.bpc");
    EXPECT_EQ(Tree::open(folder_ / "short.bpc")->info().points, 20000u);
    // On its own it is a cloud, not a tree.
    fs::copy_file(tree() / "chunks-000.bpc", folder_ / "chunks-000.bpc");
    EXPECT_THROW(Tree::open(folder_ / "chunks-000.bpc"), Error);
}

TEST_F(ForeignFiles, ATreeCalledIndexOpens)
{
    build();
    fs::create_directory(folder_ / "project");
    fs::rename(tree(), folder_ / "project/index.pct");
    EXPECT_EQ(Tree::open(folder_ / "project/index.pct")->info().points, 20000u);
    EXPECT_TRUE(is_tree(folder_ / "project/index.pct"));
    EXPECT_FALSE(is_tree(folder_ / "project"));
}

TEST_F(ForeignFiles, AFifoIsNotWaitedFor)
{
    build();
    for (const char* name : {"index.pct", "chunks-000.bpc"}) {
        const std::vector<std::byte> bytes = read_file(tree() / name);
        put_fifo(tree() / name);
        expect_refused(ErrorCode::unsupported, "this is a FIFO");
        write_file(tree() / name, bytes);
    }
    put_fifo(tree() / about_file_name);
    EXPECT_THROW(read_about(tree()), Error);
    EXPECT_EQ(verify_tree(tree(), 1).around.size(), 1u);
    put_fifo(tree() / lock_file_name);
    EXPECT_THROW(TreeLock{tree()}, Error);
}

TEST_F(ForeignFiles, ADamagedIndexNamesTheCommandThatRepairsIt)
{
    build();
    const std::vector<std::byte> index = read_file(index_path());
    const std::string command = "in a terminal: pcmlab repair " + tree().string() + ")";
    std::vector<std::byte> changed = index;
    changed[changed.size() / 2] ^= std::byte{1};
    write_file(index_path(), changed);
    expect_refused(ErrorCode::corrupt, command);
    write_file(index_path(), std::vector<std::byte>(index.begin(), index.begin() + 5));
    expect_refused(ErrorCode::not_a_tree, command);
    write_file(index_path(), std::vector<std::byte>(index.begin(), index.begin() + 100));
    expect_refused(ErrorCode::corrupt, command);
    fs::remove(index_path());
    expect_refused(ErrorCode::not_a_tree, command);
    write_file(index_path(), index);
    const fs::path with_blank = folder_ / "a b.pct";
    fs::rename(tree(), with_blank);
    write_file(with_blank / index_file_name, changed);
    try {
        Tree::open(with_blank);
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("repair '" + with_blank.string() + "'"), std::string::npos)
            << error.what();
        EXPECT_EQ(std::string(error.what()).find(error.path().string()), 0u);
        EXPECT_EQ(std::string(error.what()).find(error.path().string(), 1), std::string::npos) << "the path twice";
    }
}

TEST_F(ForeignFiles, ADamagedDataFileNamesTheCommandThatRepairsTheTree)
{
    build();
    const std::vector<std::byte> good = read_file(tree() / "chunks-000.bpc");
    const std::string command = "in a terminal: pcmlab repair " + tree().string() + ")";
    write_file(tree() / "chunks-000.bpc", std::vector<std::byte>(good.begin(), good.end() - 1));
    expect_refused(ErrorCode::truncated, command);
    put_fifo(tree() / "chunks-000.bpc");
    expect_refused(ErrorCode::unsupported, command);
    fs::remove(tree() / "chunks-000.bpc");
    expect_refused(ErrorCode::not_found, command);
    std::vector<std::byte> changed = good;
    for (std::size_t at = 300; at < changed.size(); at += 500) changed[at] ^= std::byte{1};
    write_file(tree() / "chunks-000.bpc", changed);
    const auto opened = Tree::open(tree());
    int refused = 0;
    for (NodeId id = 0; id < opened->nodes().size(); ++id)
        for (const bool part : {false, true}) try {
                if (part)
                    opened->read_chunk_part(id, ColumnSet::whole(opened->info().schema),
                                            [](const Box3i&, std::uint16_t) { return true; });
                else
                    opened->read_chunk(id, ColumnSet::whole(opened->info().schema));
            } catch (const Error& error) {
                ++refused;
                EXPECT_NE(std::string(error.what()).find(command), std::string::npos) << error.what();
            }
    EXPECT_GT(refused, 2);
    // In a list of faults the command stands below them, not behind each.
    for (const std::string& fault : verify_tree(tree(), 1).faults)
        EXPECT_EQ(fault.find("pcmlab repair"), std::string::npos) << fault;
}

TEST_F(ForeignFiles, DevicesAndFoldersAreRefused)
{
    build();
    const std::vector<std::byte> chunks = read_file(tree() / "chunks-000.bpc");
    fs::remove(tree() / "chunks-000.bpc");
    fs::create_symlink("/dev/zero", tree() / "chunks-000.bpc");
    expect_refused(ErrorCode::unsupported, "this is a device");
    write_file(tree() / "chunks-000.bpc", chunks);
    fs::remove(index_path());
    fs::create_directory(index_path());
    expect_refused(ErrorCode::unsupported, "this is a folder");
    expect_refused(ErrorCode::unsupported, "in a terminal: pcmlab repair " + tree().string() + ")");
}

TEST_F(ForeignFiles, ADataFileMayLieElsewhere)
{
    build();
    fs::create_directory(folder_ / "disk");
    fs::rename(tree() / "chunks-000.bpc", folder_ / "disk/chunks-000.bpc");
    fs::create_symlink("../disk/chunks-000.bpc", tree() / "chunks-000.bpc");
    EXPECT_TRUE(verify_tree(tree(), 1).faults.empty());
}

TEST_F(ForeignFiles, TheLockIsNotMadeOrEmptiedElsewhere)
{
    build();
    std::ofstream(folder_ / "other") << "precious";
    fs::create_symlink("../other", tree() / lock_file_name);
    EXPECT_THROW(TreeLock{tree()}, Error);
    EXPECT_EQ(fs::file_size(folder_ / "other"), 8u);
    fs::remove(tree() / lock_file_name);
    fs::create_symlink("../made", tree() / lock_file_name);
    EXPECT_THROW(TreeLock{tree()}, Error);
    EXPECT_FALSE(fs::exists(folder_ / "made"));
    fs::remove(tree() / lock_file_name);
    fs::create_hard_link(folder_ / "other", tree() / lock_file_name);
    {
        const TreeLock lock(tree());
    }
    EXPECT_EQ(fs::file_size(folder_ / "other"), 8u);
}

TEST_F(ForeignFiles, AnIndexOrAboutFarTooLongTakesNoMemory)
{
    build();
    constexpr std::uint64_t long_bytes = std::uint64_t(3) << 30;
    const long before = peak_kb();
    fs::resize_file(index_path(), long_bytes);  // zeros after the index
    expect_refused(ErrorCode::corrupt, "the index has 3221225472 bytes; with the pages that it states");
    write_file(index_path(), {});
    fs::resize_file(index_path(), long_bytes);  // nothing but zeros
    expect_refused(ErrorCode::not_a_tree, "this is not the index");
    fs::resize_file(tree() / about_file_name, long_bytes);
    try {
        read_about(tree());
        ADD_FAILURE() << "read";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::corrupt);
        EXPECT_NE(std::string(error.what()).find("its contents take"), std::string::npos) << error.what();
    }
    EXPECT_LT(peak_kb() - before, 64 << 10);
}

TEST_F(ForeignFiles, ALongIndexIsReadWhole)
{
    build();
    TreeIndex written = index();
    // More than the part that is looked at first, so that the second look finds what the first has cut off.
    written.info.metadata.push_back({"long", std::vector<std::byte>(first_beginning_bytes * 3, std::byte(7))});
    write_index(written);
    EXPECT_EQ(Tree::open(tree())->info().metadata.back().value.size(), first_beginning_bytes * 3);
    write_about(tree(), written.info);
    EXPECT_TRUE(same_info(read_about(tree()), written.info));
    // One byte more, and one node less.
    fs::resize_file(index_path(), fs::file_size(index_path()) + 1);
    expect_refused(ErrorCode::corrupt, "");
    fs::resize_file(index_path(), fs::file_size(index_path()) - 113);
    expect_refused(ErrorCode::corrupt, "");
    fs::resize_file(tree() / about_file_name, fs::file_size(tree() / about_file_name) - 1);
    EXPECT_THROW(read_about(tree()), Error);
}

}  // namespace
