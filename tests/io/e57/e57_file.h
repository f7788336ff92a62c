// E57 files made byte by byte: byte streams of any width, split into random packets, and pages with checksums.
#pragma once

#include "tests/io/bytes.h"

#include <algorithm>
#include <optional>

namespace pcm::test {

// Bit by bit, directly from the polynomial.
inline std::uint32_t slow_crc32c(const std::string& bytes)
{
    std::uint32_t crc = 0xFFFFFFFFu;
    for (const char c : bytes) {
        crc ^= static_cast<unsigned char>(c);
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1u ? 0x82F63B78u : 0u);
    }
    return ~crc;
}

inline std::uint64_t e57_physical(std::uint64_t logical) { return logical / 1020 * 1024 + logical % 1020; }

// Content as pages.
inline std::string e57_pages(std::string content)
{
    content.resize((content.size() + 1019) / 1020 * 1020);
    std::string file;
    for (std::size_t at = 0; at < content.size(); at += 1020) {
        const std::string page = content.substr(at, 1020);
        Bytes crc;
        crc.put_big_endian(slow_crc32c(page));
        file += page + crc.data;
    }
    return file;
}

// Corrects the checksums after bytes of the content were changed.
inline std::string e57_with_right_checksums(const std::string& file)
{
    std::string content;
    for (std::size_t at = 0; at < file.size(); at += 1024)
        content += file.substr(at, std::min<std::size_t>(1020, file.size() - at));
    return e57_pages(content);
}

struct E57TestField {
    std::string xml;  // element of the prototype
    unsigned bits = 0;
    std::vector<std::uint64_t> values;  // their lowest bits

    static E57TestField f32(const std::string& name, const std::vector<float>& values)
    {
        E57TestField field{"<" + name + " type=\"Float\" precision=\"single\"/>", 32, {}};
        for (const float value : values) {
            std::uint32_t bits;
            std::memcpy(&bits, &value, 4);
            field.values.push_back(bits);
        }
        return field;
    }
    static E57TestField f64(const std::string& name, const std::vector<double>& values)
    {
        E57TestField field{"<" + name + " type=\"Float\"/>", 64, {}};
        for (const double value : values) {
            std::uint64_t bits;
            std::memcpy(&bits, &value, 8);
            field.values.push_back(bits);
        }
        return field;
    }
    // `scaling` like "scale=\"0.5\" offset=\"3\"" makes scaled integers.
    static E57TestField integer(const std::string& name, std::int64_t min, std::int64_t max,
                                const std::vector<std::int64_t>& values, const std::string& scaling = "")
    {
        E57TestField field;
        field.xml = "<" + name + " type=\"" + (scaling.empty() ? "Integer" : "ScaledInteger") + "\" minimum=\"" +
                    std::to_string(min) + "\" maximum=\"" + std::to_string(max) + "\" " + scaling + "/>";
        for (auto range = static_cast<std::uint64_t>(max) - static_cast<std::uint64_t>(min); range; range /= 2)
            ++field.bits;
        for (const std::int64_t value : values)
            field.values.push_back(static_cast<std::uint64_t>(value) - static_cast<std::uint64_t>(min));
        return field;
    }
};

struct E57TestScan {
    std::vector<E57TestField> fields;
    std::string xml;                        // pose, limits, name, ...
    std::optional<std::uint64_t> promised;  // stated number of records, if not the true one

    static std::string pose(double w, double x, double y, double z, const Vec3d& t)
    {
        const auto number = [](const char* tag, double value) {
            char text[64];
            std::snprintf(text, sizeof text, "%.17g", value);
            return "<" + std::string(tag) + " type=\"Float\">" + text + "</" + tag + ">";
        };
        return "<pose type=\"Structure\"><rotation type=\"Structure\">" + number("w", w) + number("x", x) +
               number("y", y) + number("z", z) + "</rotation><translation type=\"Structure\">" + number("x", t[0]) +
               number("y", t[1]) + number("z", t[2]) + "</translation></pose>";
    }
};

// The streams of a scan in packets with unbalanced streams, with index and empty packets among them.
inline std::string e57_packets(const E57TestScan& scan, std::mt19937_64& random)
{
    std::vector<std::string> streams;
    for (const E57TestField& field : scan.fields) {
        std::string stream((field.bits * field.values.size() + 7) / 8, '\0');
        std::size_t at = 0;
        for (const std::uint64_t value : field.values)
            for (unsigned bit = 0; bit < field.bits; ++bit, ++at)
                if (value >> bit & 1) stream[at / 8] = static_cast<char>(stream[at / 8] | 1 << at % 8);
        streams.push_back(stream);
    }
    Bytes packets;
    while (std::any_of(streams.begin(), streams.end(), [](const std::string& s) { return !s.empty(); })) {
        if (random() % 4 == 0)
            packets.put(std::uint8_t{2}).put(std::uint8_t{0}).put(std::uint16_t{7}).raw(std::string(4, 'x'));
        if (random() % 4 == 0)
            packets.put(std::uint8_t{0}).put(std::uint8_t{0}).put(std::uint16_t{15}).raw(std::string(12, '\0'));
        Bytes sizes;
        std::string data;
        for (std::string& stream : streams) {
            const std::size_t most = 30000 / streams.size(),
                              now = std::min<std::size_t>(stream.size(), random() % most);
            sizes.put(static_cast<std::uint16_t>(now));
            data += stream.substr(0, now);
            stream.erase(0, now);
        }
        std::string packet = sizes.data + data;
        packet.resize((packet.size() + 6 + 3) / 4 * 4 - 6);
        packets.put(std::uint8_t{1}).put(std::uint8_t{0}).put(static_cast<std::uint16_t>(packet.size() + 6 - 1));
        packets.put(static_cast<std::uint16_t>(streams.size())).raw(packet);
    }
    return packets.data;
}

// `root` is inserted in the XML section before the scans.
inline std::string e57_file(const std::vector<E57TestScan>& scans, std::uint64_t seed = 1, const std::string& root = "")
{
    std::mt19937_64 random(seed);
    std::string content(48, '\0'), xml;
    xml =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\" "
        "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\" "
        "xmlns:nor=\"http://www.libe57.org/E57_NOR_surface_normals.txt\" "
        "xmlns:las=\"http://www.libe57.org/E57_LAS_v1.0.txt\">\n<formatName type=\"String\">ASTM E57 3D Imaging Data "
        "File</formatName><guid type=\"String\">root</guid><versionMajor type=\"Integer\">1</versionMajor>"
        "<versionMinor type=\"Integer\">0</versionMinor>" +
        root + "<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">\n";
    for (const E57TestScan& scan : scans) {
        const std::string packets = e57_packets(scan, random);
        const std::size_t begin = content.size();
        const std::size_t count = scan.fields.empty() ? 0 : scan.fields[0].values.size();
        Bytes header;
        header.put(std::uint8_t{1}).raw(std::string(7, '\0')).put(std::uint64_t{32 + packets.size()});
        header.put(e57_physical(begin + 32)).put(std::uint64_t{0});
        content += header.data + packets;
        xml += "<vectorChild type=\"Structure\">" + scan.xml + "<points type=\"CompressedVector\" fileOffset=\"" +
               std::to_string(e57_physical(begin)) + "\" recordCount=\"" +
               std::to_string(scan.promised.value_or(count)) + "\"><prototype type=\"Structure\">";
        for (const E57TestField& field : scan.fields) xml += field.xml;
        xml += "</prototype></points></vectorChild>\n";
    }
    xml += "</data3D></e57Root>\n";
    Bytes header;
    header.raw("ASTM-E57").put(1u).put(0u);
    const std::size_t xml_begin = content.size();
    content += xml;
    header.put(std::uint64_t{(content.size() + 1019) / 1020 * 1024}).put(e57_physical(xml_begin));
    header.put(std::uint64_t{xml.size()}).put(std::uint64_t{1024});
    content.replace(0, 48, header.data);
    return e57_pages(content);
}

}  // namespace pcm::test
