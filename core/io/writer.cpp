#include "pcm/io/writer.h"

#include "pcm/io/file_text.h"
#include "pcm/io/formats.h"
#include "pcm/system/error.h"

#include <string_view>

namespace pcm {

std::unique_ptr<PointWriter> create_writer(const std::filesystem::path& path, const FileInfo& cloud,
                                           const WriteOptions& options)
{
    check_writable_name(path);
    return format_of_extension(extension_of(path))->create(path, cloud, options);
}

void check_writable_name(const std::filesystem::path& path)
{
    const std::string extension = extension_of(path);
    const Format* const format = format_of_extension(extension);
    if (format && format->create) {
        // LAZ in an order and with an index of its own: a plain LAZ of this name would deceive other programs.
        if (extension == "laz" && extension_of(path.stem()) == "copc")
            throw Error(ErrorCode::unsupported, path, "COPC is not written, and this name promises it",
                        "choose a name without .copc for a plain LAZ");
        return;
    }
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
