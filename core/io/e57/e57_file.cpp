#include "pcm/io/e57/e57_file.h"

#include "pcm/io/e57/load_value.h"
#include "pcm/io/file_text.h"
#include "pcm/system/error.h"

#ifdef PCM_HAVE_DECODERS
#include "pcm/decoders/decoders.h"
#endif

#include <algorithm>
#include <cstring>
#include <memory>
#include <string_view>

namespace pcm {
namespace {

constexpr std::size_t header_bytes = 48;
// The XML section becomes a tree in memory: these bound its nodes and attributes.
constexpr std::uint64_t most_xml_bytes = std::uint64_t{32} << 20;
constexpr std::size_t most_tags = 300000;        // '<'
constexpr std::size_t most_attributes = 300000;  // '='
// The parser compares names with each other: its time grows with the square of this.
constexpr std::size_t most_attributes_of_a_tag = 1000;
constexpr std::size_t most_namespaces = 200;

[[noreturn]] void fail(const E57Pages& pages, ErrorCode code, const std::string& what, const std::string& hint = {})
{
    throw Error(code, pages.file().path(), what, hint);
}

// Checks the header; returns the XML section.
std::string read_xml(E57Pages& pages)
{
    std::array<std::byte, header_bytes> header;
    pages.read(header.data(), header.size(), 0);
    if (std::memcmp(header.data(), "ASTM-E57", 8) != 0)
        fail(pages, ErrorCode::bad_format,
             "the file begins with " + quote_bytes({reinterpret_cast<const char*>(header.data()), 8}) +
                 ", expected 'ASTM-E57'");
    const auto major = load<std::uint32_t>(&header[8]), minor = load<std::uint32_t>(&header[12]);
    if (major != 1 || minor != 0)
        fail(pages, ErrorCode::unsupported,
             "the file is E57 version " + std::to_string(major) + "." + std::to_string(minor) + "; 1.0 can be read");
    const auto length = load<std::uint64_t>(&header[16]);
    if (length > pages.physical_size())
        fail(pages, ErrorCode::truncated,
             "the header states a length of " + std::to_string(length) + " bytes, the file has " +
                 std::to_string(pages.physical_size()));
    const auto page = load<std::uint64_t>(&header[40]);
    if (page != E57Pages::page_bytes)
        fail(pages, ErrorCode::unsupported, "the pages have " + std::to_string(page) + " bytes, expected 1024");

    const auto offset = load<std::uint64_t>(&header[24]), bytes = load<std::uint64_t>(&header[32]);
    const std::uint64_t begin = pages.to_logical(offset);
    if (begin < header_bytes || begin >= pages.logical_size() || bytes > pages.logical_size() - begin)
        fail(pages, ErrorCode::truncated,
             "the header promises " + std::to_string(bytes) + " bytes of XML from byte " + std::to_string(offset) +
                 "; the file has " + std::to_string(pages.physical_size()) + " bytes");
    if (bytes > most_xml_bytes)
        fail(pages, ErrorCode::unsupported,
             "the XML section has " + std::to_string(bytes) + " bytes, at most " + std::to_string(most_xml_bytes) +
                 " can be read");
    std::string xml(static_cast<std::size_t>(bytes), '\0');
    pages.read(xml.data(), xml.size(), begin);
    return xml;
}

// Refuses, before the parser starts, what would take it too much memory or time. Returns how much memory it may take.
std::size_t check_size_of(const std::string& xml, const E57Pages& pages)
{
    const auto refuse = [&](const std::string& found, std::size_t most) {
        fail(pages, ErrorCode::unsupported,
             "the XML section has more than " + std::to_string(most) + " " + found + ": too much to read");
    };
    std::size_t tags = 0, attributes = 0, of_the_tag = 0, namespaces = 0;
    for (std::size_t i = 0; i < xml.size(); ++i) {
        if (xml[i] == '<') {
            of_the_tag = 0;
            if (++tags > most_tags) refuse("tags", most_tags);
        } else if (xml[i] == '=') {
            if (++attributes > most_attributes) refuse("attributes", most_attributes);
            if (++of_the_tag > most_attributes_of_a_tag) refuse("attributes in one tag", most_attributes_of_a_tag);
        } else if (xml[i] == 'x' && xml.compare(i, 5, "xmlns") == 0) {
            if (++namespaces > most_namespaces) refuse("namespaces", most_namespaces);
        }
    }
    // The text several times, a node or a field for each tag, and vectors that grow in steps.
    return (std::size_t{4} << 20) + 16 * xml.size() + 1024 * tags + 256 * attributes;
}

#ifdef PCM_HAVE_DECODERS

struct Free {
    void operator()(pcm_e57_description* description) const { pcm_e57_free(description); }
};

std::string text_of(const pcm_e57_text& text) { return {text.data, text.bytes}; }

E57Scan scan_of(const pcm_e57_description* description, std::size_t index)
{
    pcm_e57_scan_info info{};
    pcm_e57_scan(description, index, &info);
    E57Scan scan;
    scan.name = text_of(info.name);
    scan.guid = text_of(info.guid);
    scan.file_offset = info.file_offset;
    scan.records = info.records;
    scan.has_pose = info.has_pose != 0;
    std::copy(std::begin(info.rotation), std::end(info.rotation), scan.rotation.begin());
    std::copy(std::begin(info.translation), std::end(info.translation), scan.translation.begin());
    if (info.has_box) {
        scan.box.emplace();
        std::copy(std::begin(info.box_min), std::end(info.box_min), scan.box->min.begin());
        std::copy(std::begin(info.box_max), std::end(info.box_max), scan.box->max.begin());
    }
    if (info.has_colour_limit) scan.colour_limit = info.colour_limit;
    for (std::size_t i = 0; i < info.fields; ++i) {
        pcm_e57_field_info from{};
        pcm_e57_field(description, index, i, &from);
        E57Field field;
        field.space = text_of(from.space);
        field.name = text_of(from.name);
        field.kind = from.kind == 0   ? E57Field::Kind::f32
                     : from.kind == 1 ? E57Field::Kind::f64
                                      : E57Field::Kind::integer;
        field.min = from.min;
        field.max = from.max;
        field.scale = from.scale;
        field.offset = from.offset;
        scan.fields.push_back(std::move(field));
    }
    return scan;
}

#endif

}  // namespace

unsigned E57Field::bits() const
{
    if (kind != Kind::integer) return kind == Kind::f32 ? 32 : 64;
    unsigned bits = 0;
    for (std::uint64_t range = static_cast<std::uint64_t>(max) - static_cast<std::uint64_t>(min); range; range >>= 1)
        ++bits;
    return bits;
}

std::optional<std::size_t> E57Scan::find(std::string_view field) const
{
    for (std::size_t i = 0; i < fields.size(); ++i)
        if (fields[i].space.empty() && fields[i].name == field) return i;
    return std::nullopt;
}

std::string E57Scan::called(std::size_t index) const
{
    const std::string printable = printable_name(name);
    return "scan " + std::to_string(index + 1) + (printable.empty() ? "" : " (" + quote_bytes(printable) + ")");
}

E57Description describe_e57(E57Pages& pages)
{
    [[maybe_unused]] const std::size_t memory = check_size_of(read_xml(pages), pages);
#ifdef PCM_HAVE_DECODERS
    std::array<char, 1024> message{};
    const std::unique_ptr<pcm_e57_description, Free> from(
        pcm_e57_describe(pages.file().descriptor(), memory, message.data(), message.size()));
    if (!from && message[0] == 0)
        fail(pages, ErrorCode::io, "the system has too little memory to read the XML section", "close other programs");
    if (!from) fail(pages, ErrorCode::bad_format, "the XML section: " + printable_name(message.data()));
    E57Description description;
    description.xml = text_of(pcm_e57_xml(from.get()));
    description.coordinate_metadata = text_of(pcm_e57_coordinate_metadata(from.get()));
    description.images = pcm_e57_images(from.get());
    const std::size_t scans = pcm_e57_scans(from.get());
    for (std::size_t i = 0; i < scans; ++i) description.scans.push_back(scan_of(from.get(), i));
    return description;
#else
    fail(pages, ErrorCode::unsupported, "this is an E57 file, which this build does not support",
         "install Rust's cargo, at least 1.87 (Debian: package cargo-web), and build again");
#endif
}

}  // namespace pcm
