// Simple scans, and what the tests of the E57 reader share.
#pragma once

#include "pcm/io/e57/e57_reader.h"
#include "tests/io/e57/e57_file.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace pcm::test {

// Coordinates 0 1 2 ..., 100 101 ..., -1 -2 ... in doubles.
inline std::vector<E57TestField> simple_positions(std::size_t count)
{
    std::vector<double> x, y, z;
    for (std::size_t i = 0; i < count; ++i) {
        x.push_back(static_cast<double>(i));
        y.push_back(100 + static_cast<double>(i));
        z.push_back(-1 - static_cast<double>(i));
    }
    return {E57TestField::f64("cartesianX", x), E57TestField::f64("cartesianY", y), E57TestField::f64("cartesianZ", z)};
}

inline E57TestScan simple_scan(std::size_t count, std::vector<E57TestField> more = {}, const std::string& xml = "")
{
    E57TestScan scan{simple_positions(count), xml, {}};
    for (E57TestField& field : more) scan.fields.push_back(std::move(field));
    return scan;
}

// Without the decoders in the build, a file is refused with advice on how to get them.
inline bool decoders_are_missing()
{
    TemporaryFolder folder;
    try {
        open_reader(write_file(folder / "a.e57", e57_file({})));
        return false;
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::unsupported) << error.what();
        EXPECT_TRUE(mentions(error.what(), "cargo")) << error.what();
        return true;
    }
}

class E57 : public ::testing::Test {
protected:
    void SetUp() override
    {
        if (decoders_are_missing()) GTEST_SKIP() << "built without the decoders of LAZ and E57";
    }
    Whole read(const std::vector<E57TestScan>& scans, std::uint64_t seed = 1, const std::string& root = "")
    {
        return read_whole(write_file(folder_ / "a.e57", e57_file(scans, seed, root)), 1000);
    }
    Error refusal(const std::string& bytes)
    {
        const auto path = write_file(folder_ / "a.e57", bytes);
        const Error error = error_of([&] { read_whole(*open_reader(path)); });
        EXPECT_TRUE(mentions(error.what(), path.string())) << error.what();
        return error;
    }

    TemporaryFolder folder_;
};

inline std::vector<E57TestField> colours(std::int64_t max, std::vector<std::int64_t> values)
{
    return {E57TestField::integer("colorRed", 0, max, values), E57TestField::integer("colorGreen", 0, max, values),
            E57TestField::integer("colorBlue", 0, max, values)};
}

}  // namespace pcm::test
