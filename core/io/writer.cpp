#include "pcm/io/writer.h"

#include "pcm/io/file_text.h"
#include "pcm/io/formats.h"
#include "pcm/system/error.h"

#include <string_view>

namespace pcm {

std::unique_ptr<PointWriter> create_writer(const std::filesystem::path& path, const FileInfo& cloud,
                                           const WriteOptions& options)
{
    const std::string extension = extension_of(path);
    const Format* const format = format_of_extension(extension);
    if (format && format->create) return format->create(path, cloud, options);
    std::string known;
    for (const std::string& writable : writable_extensions()) known += (known.empty() ? "." : ", .") + writable;
    throw Error(ErrorCode::unsupported, path,
                extension.empty() ? "the name has no extension, which would choose the format"
                                  : "no writer for the extension '." + extension + "'",
                "writable are " + known);
}

std::vector<std::string> writable_extensions()
{
    std::vector<std::string> all;
    for (const Format& format : formats())
        for (const std::string_view extension : format.extensions)
            if (format.create && !extension.empty()) all.emplace_back(extension);
    return all;
}

}  // namespace pcm
