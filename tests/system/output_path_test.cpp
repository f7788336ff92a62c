#include "pcm/system/output_path.h"

#include "pcm/system/error.h"
#include "pcm/system/output_file.h"
#include "pcm/system/tree_folder.h"
#include "tests/support.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>

namespace {

using namespace pcm;
namespace fs = std::filesystem;

class OutputPath : public testing::Test {
protected:
    OutputPath()
    {
        fs::create_directory(tree_);
        write(tree_ / index_file_name, "PCMTREE\nand more");
        write(tree_ / "chunks-000.bpc", "chunks");
        fs::create_directory(folder_ / "plain");
        write(folder_ / "file", "old");
    }
    static void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }
    static std::string contents(const fs::path& path)
    {
        std::ifstream file(path);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    static void expect_refused(const std::function<void()>& f, ErrorCode code, const std::string& word)
    {
        try {
            f();
            ADD_FAILURE() << "accepted where '" << word << "' was expected";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), code) << error.what();
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
        }
    }
    void no_file(const fs::path& path, ErrorCode code, const std::string& word) const
    {
        SCOPED_TRACE(path);
        expect_refused([&] { output_file(path); }, code, word);
        expect_refused([&] { OutputFile{path}; }, code, word);
    }
    void no_tree(const fs::path& path, ErrorCode code, const std::string& word) const
    {
        SCOPED_TRACE(path);
        expect_refused([&] { output_tree(path); }, code, word);
    }

    const test::TemporaryFolder folder_;
    const fs::path tree_ = folder_ / "t.pct";
};

TEST_F(OutputPath, OrdinaryNamesAreTaken)
{
    for (const fs::path& path : {folder_ / "new.las", folder_ / "file", folder_ / "plain/new",
                                 folder_ / "no/such/place", tree_ / "../next.las", fs::path("bare")})
        EXPECT_EQ(output_file(path), path);
    EXPECT_EQ(output_tree(folder_ / "new.pct"), folder_ / "new.pct");
    EXPECT_EQ(output_tree(folder_ / "new.pct/"), folder_ / "new.pct");
    EXPECT_EQ(output_tree(tree_), tree_);
    EXPECT_EQ(output_tree(tree_ / "."), fs::canonical(tree_));
    EXPECT_EQ(output_tree(folder_ / "plain/index.pct"), folder_ / "plain/index.pct");  // a tree of an index.las
}

TEST_F(OutputPath, NothingIsPutIntoATree)
{
    for (const char* name : {"index.pct", "chunks-000.bpc", "about.pct"}) {
        no_file(tree_ / name, ErrorCode::invalid_argument, "of the point cloud tree");
        no_tree(tree_ / name, ErrorCode::invalid_argument, "of the point cloud tree");
    }
    no_tree(tree_ / "index.pct", ErrorCode::invalid_argument,
            "did you mean the tree? Its name is that of the folder, t.pct");
    no_file(tree_ / "new.las", ErrorCode::invalid_argument, "inside the folder");
    no_tree(tree_ / "new.pct", ErrorCode::invalid_argument, "inside the folder");
    no_file(tree_ / "no/such/folder/new.las", ErrorCode::invalid_argument, "inside the folder");
    // However it is spelled.
    fs::create_directory_symlink("t.pct", folder_ / "link");
    no_file(folder_ / "link/new.las", ErrorCode::invalid_argument, "inside the folder");
    no_tree(folder_ / "plain/../link/index.pct", ErrorCode::invalid_argument, "did you mean");
    fs::create_symlink("t.pct/new.las", folder_ / "into.las");
    no_file(folder_ / "into.las", ErrorCode::invalid_argument, "inside the folder");
    fs::create_symlink("t.pct/index.pct", folder_ / "into.pct");
    no_tree(folder_ / "into.pct", ErrorCode::invalid_argument, "did you mean");
    EXPECT_EQ(contents(tree_ / index_file_name), "PCMTREE\nand more");
}

TEST_F(OutputPath, OnlyARegularFileIsReplacedByAFile)
{
    no_file(tree_, ErrorCode::exists, "this is a folder");
    no_file(folder_ / "plain", ErrorCode::exists, "this is a folder");
    ASSERT_EQ(mkfifo((folder_ / "fifo").c_str(), 0666), 0);
    no_file(folder_ / "fifo", ErrorCode::exists, "this is a FIFO");
    // For the system's own files only the name is checked: a test that fails must not replace them.
    expect_refused([] { output_file("/dev/null"); }, ErrorCode::exists, "this is a device");
    for (const char* stream : {"/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"})
        expect_refused([&] { output_file(stream); }, ErrorCode::unsupported, "an open stream");
    no_tree("/dev/stdout", ErrorCode::unsupported, "an open stream");
    no_file("", ErrorCode::invalid_argument, "needs a name");
    no_tree("", ErrorCode::invalid_argument, "needs a name");
    no_tree("/", ErrorCode::invalid_argument, "root");
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    std::strncpy(name.sun_path, (folder_ / "socket").c_str(), sizeof name.sun_path - 1);
    const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
    ASSERT_EQ(bind(socket, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
    no_file(folder_ / "socket", ErrorCode::exists, "this is a socket");
    close(socket);
}

TEST_F(OutputPath, ALinkStaysAndItsTargetIsWritten)
{
    fs::create_symlink("file", folder_ / "link");
    fs::create_symlink("link", folder_ / "link of a link");
    fs::create_symlink("plain/new", folder_ / "link to nothing");
    for (const char* name : {"link", "link of a link", "link to nothing"}) {
        OutputFile out(folder_ / name);
        out.append(name);
        out.finish();
        EXPECT_TRUE(fs::is_symlink(folder_ / name)) << name;
        EXPECT_EQ(contents(folder_ / name), name);
    }
    EXPECT_EQ(contents(folder_ / "file"), "link of a link");
    EXPECT_EQ(contents(folder_ / "plain/new"), "link to nothing");
    fs::create_symlink("round", folder_ / "round");
    EXPECT_THROW(output_file(folder_ / "round"), Error);

    fs::create_directory_symlink("t.pct", folder_ / "tree link");
    EXPECT_EQ(output_tree(folder_ / "tree link"), tree_);
    fs::create_directory_symlink("nowhere.pct", folder_ / "dangling");
    no_tree(folder_ / "dangling", ErrorCode::not_found, "does not exist");
}

TEST_F(OutputPath, OnlyATreeAndNothingElseIsReplaced)
{
    check_replaceable_tree(tree_);
    write(tree_ / ".hidden", "a file manager's");
    fs::create_directory(tree_ / update_scratch_name);
    check_replaceable_tree(tree_);
    write(tree_ / "notes.txt", "a user's");
    expect_refused([&] { check_replaceable_tree(tree_); }, ErrorCode::exists, "notes.txt");
    fs::remove(tree_ / "notes.txt");
    fs::create_directory(tree_ / ".git");
    expect_refused([&] { check_replaceable_tree(tree_); }, ErrorCode::exists, ".git");
    expect_refused([&] { check_replaceable_tree(folder_ / "plain"); }, ErrorCode::exists, "not a point cloud tree");
    expect_refused([&] { check_replaceable_tree(folder_ / "file"); }, ErrorCode::exists, "this is a file");
    write(folder_ / "plain" / index_file_name, "a Macintosh picture");
    expect_refused([&] { check_replaceable_tree(folder_ / "plain"); }, ErrorCode::exists, "not a point cloud tree");
}

}  // namespace
