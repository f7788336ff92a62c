#include "pcm/io/writer.h"

#include "pcm/system/error.h"
#include "pcm/io/bpc/bpc_writer.h"
#include "pcm/io/las/las_writer.h"
#include "pcm/io/names.h"
#include "pcm/io/pcd/pcd_writer.h"
#include "pcm/io/ply/ply_writer.h"
#include "pcm/io/text/pts_writer.h"
#include "pcm/io/text/xyz_writer.h"

#include <string_view>

namespace pcm {
namespace {

struct Format {
    std::string_view extension;
    std::unique_ptr<PointWriter> (*create)(const std::filesystem::path& path, const FileInfo& cloud,
                                           const WriteOptions& options);
};

// The registry: a format is added here and nowhere else.
constexpr Format formats[] = {
    {"bpc", create_bpc}, {"las", create_las}, {"laz", create_las}, {"pts", create_pts}, {"xyz", create_xyz},
    {"txt", create_xyz}, {"asc", create_xyz}, {"csv", create_xyz}, {"pcd", create_pcd}, {"ply", create_ply},
};

}  // namespace

std::unique_ptr<PointWriter> create_writer(const std::filesystem::path& path, const FileInfo& cloud,
                                           const WriteOptions& options)
{
    const std::string extension = extension_of(path);
    for (const Format& format : formats)
        if (extension == format.extension) return format.create(path, cloud, options);
    std::string known;
    for (const Format& format : formats) known += (known.empty() ? "." : ", .") + std::string(format.extension);
    throw Error(ErrorCode::unsupported, path,
                extension.empty() ? "the name has no extension that tells the format"
                                  : "no writer for the extension '." + extension + "'",
                "writable are " + known);
}

std::vector<std::string> writable_extensions()
{
    std::vector<std::string> extensions;
    for (const Format& format : formats) extensions.emplace_back(format.extension);
    return extensions;
}

}  // namespace pcm
