#include "pcm/io/pipe/transformed_reader.h"

#include "tests/memory_reader.h"
#include "tests/support.h"

#include <cmath>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

MemoryCloud cloud_at(const Vec3d& centre, bool gridded, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    MemoryCloud cloud;
    cloud.info.points = 500;
    cloud.info.schema.add({"normal", ScalarType::f64, 3});
    cloud.info.schema.add({"radius", ScalarType::f32});
    cloud.info.schema.add({"tag", ScalarType::u16});
    if (gridded) cloud.info.grid = Grid{{0.001, 0.002, 0.5}, centre};
    cloud.points.reset(cloud.info.schema, gridded, 500);
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < 500; ++i) {
        for (std::size_t a = 0; a < 3; ++a) {
            if (gridded)
                cloud.points.grid_xyz[a][i] = static_cast<std::int32_t>(random() % 2000000) - 1000000;
            else
                cloud.points.xyz[a][i] = centre[a] + 50 * normal(random);
            cloud.points.attributes[0].as<double>()[i * 3 + a] = normal(random);
        }
        cloud.points.attributes[1].as<float>()[i] = static_cast<float>(i) / 7;
        cloud.points.attributes[2].as<std::uint16_t>()[i] = static_cast<std::uint16_t>(i);
    }
    return cloud;
}

Vec3d position(const MemoryCloud& cloud, std::size_t i)
{
    Vec3d p;
    for (std::size_t a = 0; a < 3; ++a)
        p[a] =
            cloud.points.gridded ? cloud.info.grid->to_source(cloud.points.grid_xyz[a][i], a) : cloud.points.xyz[a][i];
    return p;
}

// A whole transformed cloud, read in pieces.
MemoryCloud transformed(const MemoryCloud& cloud, const Affine& map)
{
    TransformedReader reader(std::make_unique<MemoryReader>(cloud), map);
    MemoryCloud all;
    all.info = reader.info();
    all.points.reset(all.info.schema, all.info.grid.has_value(), 500);
    PointBatch batch;
    std::size_t at = 0;
    while (reader.read(batch, 77)) {
        EXPECT_EQ(batch.gridded, all.points.gridded);
        for (std::size_t i = 0; i < batch.size; ++i, ++at) {
            for (std::size_t a = 0; a < 3; ++a) {
                if (batch.gridded)
                    all.points.grid_xyz[a][at] = batch.grid_xyz[a][i];
                else
                    all.points.xyz[a][at] = batch.xyz[a][i];
                all.points.attributes[0].as<double>()[at * 3 + a] = batch.attributes[0].as<double>()[i * 3 + a];
            }
            all.points.attributes[1].as<float>()[at] = batch.attributes[1].as<float>()[i];
            all.points.attributes[2].as<std::uint16_t>()[at] = batch.attributes[2].as<std::uint16_t>()[i];
        }
    }
    EXPECT_EQ(at, 500u);
    return all;
}

TEST(Transformed, AnyMapAgainstLongDoubles)
{
    std::mt19937_64 random(4);
    std::normal_distribution<double> normal;
    for (int round = 0; round < 40; ++round) {
        const Vec3d centre = round % 2 ? Vec3d{5e6, -4e6, 100} : Vec3d{1, 2, 3};
        const MemoryCloud cloud = cloud_at(centre, round % 4 < 2, static_cast<std::uint64_t>(round));
        std::array<Vec3d, 3> linear;
        for (Vec3d& row : linear)
            for (double& v : row) v = normal(random);
        const Vec3d shift{1000 * normal(random), 1000 * normal(random), 1000 * normal(random)};
        const Affine map = Affine::about(linear, shift, centre);
        const MemoryCloud found = transformed(cloud, map);
        EXPECT_FALSE(found.info.grid);
        for (std::size_t i = 0; i < 500; ++i) {
            const Vec3d p = position(cloud, i);
            for (std::size_t a = 0; a < 3; ++a) {
                long double expected = shift[a], size = std::fabs(shift[a]);
                for (std::size_t b = 0; b < 3; ++b) {
                    expected += static_cast<long double>(linear[a][b]) * p[b];
                    size += std::fabs(linear[a][b] * p[b]);
                }
                EXPECT_NEAR(found.points.xyz[a][i], static_cast<double>(expected), static_cast<double>(size) * 1e-15);
            }
            EXPECT_EQ(found.points.attributes[2].as<std::uint16_t>()[i], i);
            EXPECT_NEAR(found.points.attributes[1].as<float>()[i],
                        static_cast<double>(i) / 7 * std::cbrt(std::fabs(map.determinant())),
                        1e-5 * static_cast<double>(i + 1) * (1 + std::cbrt(std::fabs(map.determinant()))));
            // Vectors perpendicular to the normal stay so, and its length stays the same.
            const double* before = cloud.points.attributes[0].as<double>() + 3 * i;
            const double* now = found.points.attributes[0].as<double>() + 3 * i;
            const Vec3d along{before[1], -before[0], 0};
            double dot = 0, along_length = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                const double moved = linear[a][0] * along[0] + linear[a][1] * along[1];
                dot += moved * now[a];
                along_length += moved * moved;
            }
            const double length = std::hypot(before[0], before[1], before[2]);
            EXPECT_NEAR(dot, 0, 1e-9 * length * (1 + std::sqrt(along_length)) * 100);
            EXPECT_NEAR(std::hypot(now[0], now[1], now[2]), length, 1e-12 * length);
        }
    }
}

TEST(Transformed, GriddedPointsKeepTheirIntegers)
{
    const MemoryCloud cloud = cloud_at({5e5, 4.8e6, 100}, true, 9);
    Affine map = Affine::translation({10, -20, 0.5});
    for (const double stretch : {1.0, 0.25, 3.0}) {
        for (std::size_t a = 0; a < 3; ++a) map.linear[a][a] = stretch;
        const MemoryCloud found = transformed(cloud, map);
        ASSERT_TRUE(found.info.grid);
        EXPECT_EQ(found.points.grid_xyz, cloud.points.grid_xyz);
        for (std::size_t i = 0; i < 500; ++i)
            for (std::size_t a = 0; a < 3; ++a)
                EXPECT_NEAR(position(found, i)[a], map(position(cloud, i))[a], 4e-9 * stretch);
    }
    map.linear[0][0] = -1;  // a grid's steps are positive
    EXPECT_FALSE(transformed(cloud, map).info.grid);
}

TEST(Transformed, TurningAtMapCoordinatesAndBack)
{
    const MemoryCloud cloud = cloud_at({5e6, 4.8e6, 300}, false, 11);
    for (const double angle : {1e-9, 0.1, 3.14159265358979, 100.0}) {
        const Affine there = Affine::rotation({1, 2, -0.5}, angle, {5e6, 4.8e6, 300}, 2),
                     back = Affine::rotation({1, 2, -0.5}, -angle, {5e6, 4.8e6, 300}, 0.5);
        const MemoryCloud found = transformed(transformed(cloud, there), back);
        for (std::size_t i = 0; i < 500; ++i)
            for (std::size_t a = 0; a < 3; ++a)
                EXPECT_NEAR(found.points.xyz[a][i], cloud.points.xyz[a][i], 3e-9);  // a few last bits of 5e6
    }
    const Affine quarter = Affine::rotation({0, 0, 7}, std::acos(0.0), {1, 1, 0});
    const Vec3d p = quarter({3, 1, 5});
    EXPECT_NEAR(p[0], 1, 1e-15);
    EXPECT_NEAR(p[1], 3, 1e-15);
    EXPECT_EQ(p[2], 5);
}

TEST(Transformed, MapsThatMakeNoSense)
{
    const MemoryCloud cloud = cloud_at({0, 0, 0}, false, 1);
    const auto refused = [&](const Affine& map) {
        try {
            TransformedReader(std::make_unique<MemoryReader>(cloud), map);
        } catch (const Error& error) {
            return error.code() == ErrorCode::invalid_argument;
        }
        return false;
    };
    Affine map;
    EXPECT_FALSE(refused(map));
    map.linear[2] = {1, 1, 0};
    EXPECT_TRUE(refused(map));
    map = Affine();
    map.target[1] = std::nan("");
    EXPECT_TRUE(refused(map));
    // Determinants that are not doubles are neither 0 nor infinite.
    for (const double scale : {1e200, 1e-200}) {
        map = Affine();
        for (std::size_t axis = 0; axis < 3; ++axis) map.linear[axis][axis] = scale;
        EXPECT_FALSE(refused(map)) << scale;
        map.linear[2][2] = 0;
        EXPECT_TRUE(refused(map)) << scale;
    }
}

TEST(TransformedReader, ACoordinateSystemThatStaysIsNoted)
{
    MemoryCloud cloud = cloud_at({0, 0, 0}, true, 1);
    const auto notes = [&] {
        Affine map;
        map.linear[0][0] = map.linear[1][1] = map.linear[2][2] = 0.3048;
        return TransformedReader(std::make_unique<MemoryReader>(cloud), map).info().notes;
    };
    EXPECT_TRUE(notes().empty());
    const std::string text = "EPSG:32632";
    const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
    cloud.info.metadata = {{"crs", {bytes, bytes + text.size()}}};
    ASSERT_EQ(notes().size(), 1u);
    EXPECT_NE(notes()[0].find(text), std::string::npos) << notes()[0];
}

// Lengths, areas and numbers per length by their descriptions: floats are multiplied, integers and what has an offset
// get another scale and keep their raw values.
TEST(Transformed, WhatHasAUnitOfLengthGrows)
{
    MemoryCloud cloud;
    cloud.info.points = 3;
    cloud.info.schema.add({"gap", ScalarType::f32, 2, 1, 0, "to the wall, source units"});
    cloud.info.schema.add({"steps", ScalarType::i16, 1, 0.5, 10, "source units"});
    cloud.info.schema.add({"area", ScalarType::f64, 1, 1, 0, "source units^2"});
    cloud.info.schema.add({"bend", ScalarType::f64, 1, 1, 1, "source units^-1"});
    cloud.info.schema.add({"mean_distance", ScalarType::f32});
    cloud.info.schema.add({"plain", ScalarType::f32, 1, 1, 0, "source units of others"});
    cloud.points.reset(cloud.info.schema, false, 3);
    std::mt19937_64 random(4);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t a = 0; a < 3; ++a) cloud.points.xyz[a][i] = static_cast<double>(random() % 100);
        for (std::size_t c = 0; c < 2; ++c)
            cloud.points.attributes[0].as<float>()[2 * i + c] = static_cast<float>(i + c);
        cloud.points.attributes[1].as<std::int16_t>()[i] = static_cast<std::int16_t>(i);
        cloud.points.attributes[2].as<double>()[i] = static_cast<double>(i);
        cloud.points.attributes[3].as<double>()[i] = static_cast<double>(i);
        cloud.points.attributes[4].as<float>()[i] = static_cast<float>(i);
        cloud.points.attributes[5].as<float>()[i] = static_cast<float>(i);
    }
    Affine map;
    for (std::size_t a = 0; a < 3; ++a) map.linear[a][a] = 4;
    TransformedReader reader(std::make_unique<MemoryReader>(cloud), map);
    const Schema schema = reader.info().schema;
    PointBatch batch;
    ASSERT_TRUE(reader.read(batch, 3));
    const double factors[] = {4, 4, 16, 0.25, 4, 1};
    for (std::size_t k = 0; k < schema.size(); ++k)
        for (std::size_t i = 0; i < 3; ++i)
            for (std::uint32_t c = 0; c < schema[k].components; ++c) {
                const auto shown = [&](const Schema& s, const Column& column) {
                    return column.value(i, c) * s[k].scale + s[k].offset;
                };
                EXPECT_DOUBLE_EQ(shown(schema, batch.attributes[k]),
                                 factors[k] * shown(cloud.info.schema, cloud.points.attributes[k]))
                    << schema[k].name;
            }
    EXPECT_EQ(batch.attributes[1].as<std::int16_t>()[2], 2);
}

}  // namespace
