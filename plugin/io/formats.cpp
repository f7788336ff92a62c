#include "plugin/io/formats.h"

#include "pcm/system/error.h"
#include "pcm/system/file.h"
#include "pcm/io/names.h"
#include "pcm/io/ply/ply_header.h"
#include "pcm/io/reader.h"
#include "pcm/io/writer.h"
#include "pcm/tree/tree.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace pcm::host {

namespace {

struct Description {
    std::string_view extension;
    const char* words;
};
constexpr Description descriptions[] = {
    {"las", "LAS point cloud"},
    {"laz", "LAZ point cloud, compressed LAS"},
    {"e57", "E57 scans"},
    {"pts", "PTS point cloud (Leica)"},
    {"ptx", "PTX scans (Leica)"},
    {"pcd", "PCD point cloud (PCL)"},
    {"bpc", "BPC binary point cloud"},
    {"ply", "PLY point cloud"},
    {"xyz", "XYZ points as text"},
    {"txt", "TXT points as text"},
    {"asc", "ASC points as text"},
    {"csv", "CSV points as text"},
    {"pwn", "PWN points with normals as text"},
};

QList<MeshIOInterface::Format> described(const std::vector<std::string>& extensions)
{
    QList<MeshIOInterface::Format> formats;
    for (const std::string& extension : extensions) {
        const auto found = std::find_if(std::begin(descriptions), std::end(descriptions),
                                        [&](const Description& d) { return d.extension == extension; });
        const QString upper = QString::fromStdString(extension).toUpper();
        formats << MeshIOInterface::Format(found == std::end(descriptions) ? upper + " point cloud" : found->words,
                                           upper);
    }
    return formats;
}

bool has_only_vertices(const File& file)
{
    const PlyHeader header = read_ply_header(file);
    return std::all_of(header.elements.begin(), header.elements.end(),
                       [](const PlyElement& e) { return e.name == "vertex" || e.count == 0; });
}

}  // namespace

QList<MeshIOInterface::Format> import_formats()
{
    QList<MeshIOInterface::Format> formats = described(readable_extensions());
    formats.push_front(MeshIOInterface::Format("Point cloud tree", QString(tree_extension).toUpper()));
    return formats;
}

QList<MeshIOInterface::Format> export_formats() { return described(writable_extensions()); }

bool has_text_layout(const std::string& extension)
{
    return extension == "xyz" || extension == "txt" || extension == "asc" || extension == "csv";
}

bool is_cloud(const std::filesystem::path& path)
{
    constexpr std::string_view expe = "[Expe/PointSet";
    const std::string extension = extension_of(path);
    if (extension != "ply" && extension != "pts") return true;
    try {
        const File file(path, File::Mode::read);
        if (extension == "ply") return has_only_vertices(file);
        std::array<char, expe.size()> start{};
        const std::size_t got = file.read_some_at(start.data(), start.size(), 0);
        return std::string_view(start.data(), got) != expe;
    } catch (const Error&) {
        return true;
    }
}

}  // namespace pcm::host
