// A small tree in a temporary folder, and its files as bytes.
#pragma once

#include "pcm/build/builder.h"
#include "pcm/point_cloud.h"
#include "pcm/system/file.h"
#include "pcm/tree/tree.h"
#include "pcm/tree/tree_index.h"
#include "tests/clouds.h"
#include "tests/support.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace pcm::test {

inline std::vector<std::byte> read_file(const std::filesystem::path& path)
{
    const File file(path, File::Mode::read);
    std::vector<std::byte> bytes(file.size());
    file.read_at(bytes.data(), bytes.size(), 0);
    return bytes;
}

inline void write_file(const std::filesystem::path& path, const std::vector<std::byte>& bytes)
{
    std::filesystem::remove(path);
    File(path, File::Mode::create_new).write_at(bytes.data(), bytes.size(), 0);
}

// Pages of an index with this number of nodes each.
inline std::vector<std::uint32_t> pages_of(std::uint32_t nodes_a_page, std::size_t nodes)
{
    std::vector<std::uint32_t> pages;
    for (std::size_t first = 0; first < nodes; first += nodes_a_page)
        pages.push_back(static_cast<std::uint32_t>(std::min<std::size_t>(nodes_a_page, nodes - first)));
    return pages;
}

// Writes the index of a tree again, with few nodes in a page.
inline void write_in_pages(const std::filesystem::path& folder, std::uint32_t nodes_a_page)
{
    TreeIndex index = decode_index(read_file(folder / index_file_name), "index");
    index.pages = pages_of(nodes_a_page, index.nodes.size());
    write_file(folder / index_file_name, encode_index(index));
}

// Opens a tree of which few nodes have been read.
inline void read_again_in_pages(const std::filesystem::path& folder, std::shared_ptr<PointCloud>& cloud)
{
    cloud.reset();
    write_in_pages(folder, 5);
    cloud = PointCloud::open(folder);
}

inline std::size_t open_descriptors()
{
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) ++count;
    return count - 1;  // without the one that reads the folder
}

// Lets the process have at most `more` more files open.
class LimitedDescriptors {
public:
    explicit LimitedDescriptors(std::size_t more)
    {
        rlimit low{};
        EXPECT_EQ(getrlimit(RLIMIT_NOFILE, &old_), 0);
        low = old_;
        low.rlim_cur = open_descriptors() + more;
        EXPECT_EQ(setrlimit(RLIMIT_NOFILE, &low), 0);
    }
    ~LimitedDescriptors() { setrlimit(RLIMIT_NOFILE, &old_); }
    LimitedDescriptors(const LimitedDescriptors&) = delete;
    LimitedDescriptors& operator=(const LimitedDescriptors&) = delete;

private:
    rlimit old_{};
};

class SmallTree : public testing::Test {
protected:
    void build(std::size_t points = 20000, std::uint32_t chunk_points = 2000) const
    {
        write_las(folder_ / "in.las", records(Shape::surface, points, 3), {{0.01, 0.01, 0.01}, {500000, 4800000, 0}});
        BuildOptions options;
        options.chunk_points = chunk_points;
        build_tree({folder_ / "in.las"}, tree(), options);
    }
    std::filesystem::path tree() const { return folder_ / "out.pct"; }
    std::filesystem::path index_path() const { return tree() / index_file_name; }
    TreeIndex index() const { return decode_index(read_file(index_path()), "index"); }
    void write_index(const TreeIndex& index) const { write_file(index_path(), encode_index(index)); }

    TemporaryFolder folder_;
};

}  // namespace pcm::test
