// LAS files of every version and point format, written from the tables of the specification, not with the library.
#pragma once

#include "tests/io/bytes.h"

#include <array>
#include <optional>
#include <utility>

namespace pcm::test {
inline namespace las_file {  // tests/clouds.h has a simpler LasRecord

struct LasRecord {
    std::int32_t x = 0, y = 0, z = 0;
    std::uint16_t intensity = 0;
    unsigned return_number = 0, number_of_returns = 0, scan_direction = 0, edge = 0;
    unsigned classification = 0, synthetic = 0, key_point = 0, withheld = 0, overlap = 0, channel = 0;
    std::int8_t angle_rank = 0;
    std::int16_t angle = 0;
    std::uint8_t user_data = 0;
    std::uint16_t source_id = 0;
    double gps_time = 0;
    std::array<std::uint16_t, 3> rgb{};
    std::uint16_t nir = 0;
    std::uint8_t wave_descriptor = 0;
    std::uint64_t wave_offset = 0;
    std::uint32_t wave_size = 0;
    float wave_location = 0;
    std::array<float, 3> wave_direction{};
    std::string extra;
};

inline bool has_gps_time(int format) { return format != 0 && format != 2; }
inline bool has_rgb(int format)
{
    return format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
}
inline bool has_nir(int format) { return format == 8 || format == 10; }
inline bool has_wave(int format) { return format == 4 || format == 5 || format == 9 || format == 10; }

template <class Random>
LasRecord random_record(Random& random, int format, std::size_t extra_bytes = 0)
{
    const bool wide = format >= 6;
    const auto below = [&](unsigned end) { return static_cast<unsigned>(random() % end); };
    LasRecord p;
    p.x = static_cast<std::int32_t>(random());
    p.y = static_cast<std::int32_t>(random());
    p.z = static_cast<std::int32_t>(random());
    p.intensity = static_cast<std::uint16_t>(random());
    p.return_number = below(wide ? 16 : 8);
    p.number_of_returns = below(wide ? 16 : 8);
    p.scan_direction = below(2);
    p.edge = below(2);
    p.classification = below(wide ? 256 : 32);
    p.synthetic = below(2);
    p.key_point = below(2);
    p.withheld = below(2);
    p.overlap = below(2);
    p.channel = below(4);
    p.angle_rank = static_cast<std::int8_t>(random());
    p.angle = static_cast<std::int16_t>(random());
    p.user_data = static_cast<std::uint8_t>(random());
    p.source_id = static_cast<std::uint16_t>(random());
    p.gps_time = static_cast<double>(random()) * 1e-5 - 7e8;
    for (auto& c : p.rgb) c = static_cast<std::uint16_t>(random());
    p.nir = static_cast<std::uint16_t>(random());
    p.wave_descriptor = static_cast<std::uint8_t>(random());
    p.wave_offset = random();
    p.wave_size = static_cast<std::uint32_t>(random());
    p.wave_location = static_cast<float>(random() % 1000000) * 0.01f;
    for (auto& d : p.wave_direction) d = static_cast<float>(random() % 2000) * 0.001f - 1.0f;
    for (std::size_t i = 0; i < extra_bytes; ++i) p.extra.push_back(static_cast<char>(random()));
    return p;
}

inline void put_record(Bytes& to, const LasRecord& p, int format)
{
    const auto byte = [](unsigned value) { return static_cast<std::uint8_t>(value); };
    to.put(p.x).put(p.y).put(p.z).put(p.intensity);
    if (format <= 5) {
        to.put(byte(p.return_number | p.number_of_returns << 3 | p.scan_direction << 6 | p.edge << 7));
        to.put(byte(p.classification | p.synthetic << 5 | p.key_point << 6 | p.withheld << 7));
        to.put(p.angle_rank).put(p.user_data).put(p.source_id);
    } else {
        to.put(byte(p.return_number | p.number_of_returns << 4));
        to.put(byte(p.synthetic | p.key_point << 1 | p.withheld << 2 | p.overlap << 3 | p.channel << 4 |
                    p.scan_direction << 6 | p.edge << 7));
        to.put(byte(p.classification)).put(p.user_data).put(p.angle).put(p.source_id);
    }
    if (has_gps_time(format)) to.put(p.gps_time);
    if (has_rgb(format)) to.put(p.rgb[0]).put(p.rgb[1]).put(p.rgb[2]);
    if (has_nir(format)) to.put(p.nir);
    if (has_wave(format)) {
        to.put(p.wave_descriptor).put(p.wave_offset).put(p.wave_size).put(p.wave_location);
        to.put(p.wave_direction[0]).put(p.wave_direction[1]).put(p.wave_direction[2]);
    }
    to.raw(p.extra);
}

struct LasVlr {
    std::string user_id;
    std::uint16_t id = 0;
    std::string payload;
};

struct LasFile {
    int version = 2;
    int format = 2;
    std::array<double, 3> scale{0.001, 0.01, 0.25};
    std::array<double, 3> offset{500000, -4800000, 12.5};
    std::size_t extra_bytes = 0;
    std::vector<LasVlr> vlrs, evlrs;
    std::vector<LasRecord> records;
    bool legacy_count = true;  // otherwise 0 in 1.4 files
    std::uint16_t encoding = 0;
    // LAS 1.5.
    double most_time = 0, least_time = 0;
    std::uint16_t time_offset = 0;

    std::size_t header_size() const { return version >= 5 ? 393 : version == 4 ? 375 : version == 3 ? 235 : 227; }
    std::size_t record_length() const
    {
        Bytes one;
        put_record(one, {}, format);
        return one.data.size() + extra_bytes;
    }

    std::string bytes() const
    {
        std::size_t point_offset = header_size();
        for (const LasVlr& vlr : vlrs) point_offset += 54 + vlr.payload.size();
        const std::size_t evlr_start = point_offset + records.size() * record_length();
        const auto count = static_cast<std::uint32_t>(records.size());

        Bytes to;
        to.raw("LASF").put(std::uint16_t{7}).put(encoding).text("", 16);
        to.put(std::uint8_t{1}).put(static_cast<std::uint8_t>(version)).text("test", 32).text("by hand", 32);
        to.put(std::uint16_t{59}).put(std::uint16_t{2020}).put(static_cast<std::uint16_t>(header_size()));
        to.put(static_cast<std::uint32_t>(point_offset)).put(static_cast<std::uint32_t>(vlrs.size()));
        to.put(static_cast<std::uint8_t>(format)).put(static_cast<std::uint16_t>(record_length()));
        to.put(version < 4 || legacy_count ? count : 0u);
        for (int i = 0; i < 5; ++i) to.put(std::uint32_t{0});
        for (const double s : scale) to.put(s);
        for (const double o : offset) to.put(o);
        for (int axis = 0; axis < 3; ++axis) to.put(10.0 + axis).put(-10.0 - axis);
        if (version >= 3) to.put(std::uint64_t{0});
        if (version >= 4) {
            to.put(static_cast<std::uint64_t>(evlrs.empty() ? 0 : evlr_start))
                .put(static_cast<std::uint32_t>(evlrs.size()));
            to.put(static_cast<std::uint64_t>(count));
            for (int i = 0; i < 15; ++i) to.put(std::uint64_t{0});
        }
        if (version >= 5) to.put(most_time).put(least_time).put(time_offset);
        EXPECT_EQ(to.data.size(), header_size());
        for (const LasVlr& vlr : vlrs)
            to.put(std::uint16_t{0})
                .text(vlr.user_id, 16)
                .put(vlr.id)
                .put(static_cast<std::uint16_t>(vlr.payload.size()))
                .text("described", 32)
                .raw(vlr.payload);
        for (const LasRecord& record : records) put_record(to, record, format);
        for (const LasVlr& vlr : evlrs)
            to.put(std::uint16_t{0})
                .text(vlr.user_id, 16)
                .put(vlr.id)
                .put(static_cast<std::uint64_t>(vlr.payload.size()))
                .text("described", 32)
                .raw(vlr.payload);
        return to.data;
    }
};

template <class Random>
LasFile random_las(Random& random, int version, int format, std::size_t points, std::size_t extra_bytes = 0)
{
    LasFile file;
    file.version = version;
    file.format = format;
    file.extra_bytes = extra_bytes;
    for (std::size_t i = 0; i < points; ++i) file.records.push_back(random_record(random, format, extra_bytes));
    return file;
}

// One entry of the Extra Bytes VLR.
inline std::string extra_descriptor(int type, int options, const std::string& name,
                                    std::array<double, 3> scale = {0, 0, 0}, std::array<double, 3> offset = {0, 0, 0})
{
    Bytes to;
    to.put(std::uint16_t{0}).put(static_cast<std::uint8_t>(type)).put(static_cast<std::uint8_t>(options));
    to.text(name, 32).text("", 4).text("", 24).text("", 24).text("", 24);
    for (const double s : scale) to.put(s);
    for (const double o : offset) to.put(o);
    to.text("about " + name, 32);
    return to.data;
}

}  // namespace las_file
}  // namespace pcm::test
