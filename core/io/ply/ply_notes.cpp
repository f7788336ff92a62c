#include "pcm/io/ply/ply_notes.h"

#include "pcm/io/file_text.h"
#include "pcm/system/text.h"

namespace pcm {
namespace {

std::string promise(const PlyHeader& header, std::size_t vertex_element)
{
    return "the header promises " + grouped(header.elements[vertex_element].count) + " vertices";
}

}  // namespace

std::string format_name(const PlyHeader& header)
{
    return header.encoding == PlyHeader::Encoding::ascii           ? "PLY ascii"
           : header.encoding == PlyHeader::Encoding::little_endian ? "PLY binary little endian"
                                                                   : "PLY binary big endian";
}

std::vector<std::string> other_elements(const PlyHeader& header, std::size_t vertex_element)
{
    std::vector<std::string> notes;
    for (std::size_t i = 0; i < header.elements.size() && notes.size() < 100; ++i) {
        const PlyElement& element = header.elements[i];
        if (i == vertex_element || element.count == 0) continue;
        const std::string count = std::to_string(element.count);
        const std::string what = element.name == "face" ? (element.count == 1 ? count + " face" : count + " faces")
                                                        : count + " of element '" + printable_name(element.name) + "'";
        notes.push_back(what + " ignored: only the points are read");
    }
    return notes;
}

std::optional<std::string> surplus_bytes(const PlyHeader& header, std::size_t vertex_element, std::uint64_t left)
{
    for (std::size_t i = vertex_element + 1; i < header.elements.size(); ++i) {
        const PlyElement& element = header.elements[i];
        if (element.count == 0) continue;
        const std::uint64_t bytes = element.least_bytes();
        // Truncated elements do not affect the points.
        if (element.has_lists() || (bytes && element.count > left / bytes)) return std::nullopt;
        left -= element.count * bytes;
    }
    if (left == 0) return std::nullopt;
    const std::uint64_t record = header.elements[vertex_element].least_bytes();
    return grouped(left) + " bytes after the last point are ignored: " + promise(header, vertex_element) +
           (record && left % record == 0 ? ", and as many bytes as " + grouped(left / record) + " more take follow"
                                         : "");
}

std::optional<std::string> surplus_lines(const PlyHeader& header, std::size_t vertex_element, LineStream& lines)
{
    std::string_view line;
    for (std::size_t e = vertex_element + 1; e < header.elements.size(); ++e) {
        const PlyElement& element = header.elements[e];
        for (std::uint64_t i = 0; !element.properties.empty() && i < element.count; ++i)
            if (!lines.next(line)) return std::nullopt;
    }
    const std::optional<std::string> rest = describe_rest(lines);
    if (!rest) return std::nullopt;
    return *rest + ": " + promise(header, vertex_element);
}

}  // namespace pcm
