// Shared by the tests of writers: random clouds, comparison of clouds, files copied through the library.
#pragma once

#include "pcm/io/writer.h"
#include "tests/io/bytes.h"

#include <limits>

namespace pcm::test {

// Whether this build can read and write LAZ.
inline bool have_laz()
{
    static const bool have = [] {
        TemporaryFolder folder;
        FileInfo cloud;
        cloud.grid = Grid{};
        cloud.position_type = ScalarType::i32;
        try {
            create_writer(folder / "a.laz", cloud);
            return true;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::unsupported) << error.what();
            EXPECT_TRUE(mentions(error.what(), "cargo")) << error.what();
            return false;
        }
    }();
    return have;
}
inline std::vector<std::string> las_extensions()
{
    return have_laz() ? std::vector<std::string>{"las", "laz"} : std::vector<std::string>{"las"};
}

#define PCM_REQUIRE_LAZ() \
    if (!pcm::test::have_laz()) GTEST_SKIP() << "this build leaves LAZ out"

// Random bits, including NaN and infinities.
template <class Random>
void randomize(PointBatch& batch, Random& random)
{
    for (std::size_t a = 0; a < 3; ++a) {
        for (auto& q : batch.grid_xyz[a]) q = static_cast<std::int32_t>(random());
        for (auto& v : batch.xyz[a]) v = static_cast<double>(random() % 2000001) * 0.001 - 1000;
    }
    for (Column& column : batch.attributes)
        for (std::size_t i = 0; i < column.bytes(); ++i) column.data()[i] = static_cast<std::byte>(random());
}

struct Written {
    std::vector<std::string> notes;
    double position_error = 0;
};

// In batches of uneven sizes.
inline Written write_cloud(const std::filesystem::path& path, const Whole& cloud, const WriteOptions& options = {},
                           std::size_t most_points = 7001)
{
    const auto writer = create_writer(path, cloud.info, options);
    PointBatch batch;
    std::size_t size = 1;
    for (std::size_t done = 0; done < cloud.points.size;) {
        const std::size_t now = std::min(size, cloud.points.size - done);
        batch.reset(cloud.info.schema, cloud.points.gridded, now);
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t i = 0; i < now; ++i) {
                if (batch.gridded)
                    batch.grid_xyz[a][i] = cloud.points.grid_xyz[a][done + i];
                else
                    batch.xyz[a][i] = cloud.points.xyz[a][done + i];
            }
        for (std::size_t c = 0; c < batch.attributes.size(); ++c)
            std::memcpy(batch.attributes[c].data(),
                        cloud.points.attributes[c].data() + done * batch.attributes[c].point_bytes(),
                        batch.attributes[c].bytes());
        writer->write(batch);
        done += now;
        size = size * 3 % most_points + 1;
    }
    writer->finish();
    return {writer->notes(), writer->position_error()};
}

inline void expect_same_values(const Whole& a, const Whole& b)
{
    ASSERT_EQ(a.points.size, b.points.size);
    ASSERT_EQ(a.points.gridded, b.points.gridded);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(a.points.grid_xyz[axis], b.points.grid_xyz[axis]);
        EXPECT_EQ(a.points.xyz[axis], b.points.xyz[axis]);
    }
    ASSERT_EQ(a.points.attributes.size(), b.points.attributes.size());
    for (std::size_t i = 0; i < a.points.attributes.size(); ++i) {
        const Column &x = a.points.attributes[i], &y = b.points.attributes[i];
        ASSERT_EQ(x.bytes(), y.bytes()) << a.info.schema[i].name;
        if (x.bytes()) EXPECT_EQ(std::memcmp(x.data(), y.data(), x.bytes()), 0) << a.info.schema[i].name;
    }
}

inline void expect_same_cloud(const Whole& a, const Whole& b)
{
    EXPECT_EQ(a.info.grid, b.info.grid);
    ASSERT_EQ(a.info.schema, b.info.schema);
    expect_same_values(a, b);
}

// Metadata without the header, which holds the version and counts of the file itself.
inline std::vector<Metadata> without_header(const FileInfo& info)
{
    std::vector<Metadata> rest;
    for (const Metadata& block : info.metadata)
        if (block.key != "las.header") rest.push_back(block);
    return rest;
}

inline std::size_t files_in(const std::filesystem::path& folder)
{
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

}  // namespace pcm::test
