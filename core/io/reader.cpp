#include "pcm/io/reader.h"

#include "pcm/io/file_text.h"
#include "pcm/io/formats.h"
#include "pcm/io/pipe/limited_reader.h"
#include "pcm/io/record_batch.h"
#include "pcm/system/work_done.h"

#include <string_view>
#include <utility>

namespace pcm {
namespace {

// The format of a file without magic: by the structure of its lines, else by its extension. Null when it is neither.
// Lines of points alone prove little: where the extension is a format's, that format is taken.
const Format* format_of_text(const std::filesystem::path& path, const Format* named)
{
    if (named && !named->is_text()) return named;
    const auto matches = [&](const Format& format) { return format.looks_like && format.looks_like(path); };
    for (const Format& format : formats())
        if (format.has(unique_structure) && matches(format)) return &format;
    if (named) return named;
    for (const Format& format : formats())
        if (matches(format)) return &format;
    return nullptr;
}

std::filesystem::file_status status_of(const std::filesystem::path& path)
{
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(path, error);
    if (status.type() == std::filesystem::file_type::not_found)
        throw Error(ErrorCode::not_found, path, "no such file or folder");
    if (error) throw Error::from_errno(error.value(), path, "looking at it");
    return status;
}

std::unique_ptr<PointReader> open_all_points(const std::filesystem::path& path, const ReadOptions& options)
{
    // Checked before opening: opening a pipe would wait for its other end.
    const std::filesystem::file_status status = status_of(path);
    if (std::filesystem::is_directory(status))
        throw Error(ErrorCode::unsupported, path, "this is a folder; a point cloud file was expected");
    if (!std::filesystem::is_regular_file(status))
        throw Error(ErrorCode::unsupported, path,
                    std::string("this is ") +
                        (std::filesystem::is_fifo(status)     ? "a FIFO"
                         : std::filesystem::is_socket(status) ? "a socket"
                                                              : "a device") +
                        "; a regular file was expected");

    const std::string start = first_bytes_of(path);
    if (const Format* format = format_of_magic(start)) return format->open(path, options);
    if (start.empty()) throw Error(ErrorCode::bad_format, path, "the file is empty", readable_hint());
    if (const ForeignFormat* other = foreign_format_of_magic(start))
        throw Error(ErrorCode::unsupported, path,
                    "this is " + std::string(other->name) + ": at byte 0 it has " + quote_bytes(other->magic),
                    readable_hint());

    const std::string extension = extension_of(path);
    // A format without its magic: opening it reports what was expected.
    if (const Format* format = format_of_text(path, format_of_extension(extension))) return format->open(path, options);
    if (const ForeignFormat* other = foreign_format_of_extension(extension))
        throw Error(ErrorCode::unsupported, path, "this is " + std::string(other->name), readable_hint());
    throw Error(ErrorCode::bad_format, path, "no known point cloud format: the file begins with " + quote_bytes(start),
                readable_hint());
}

// Points count as read when they are decoded (system/work_done.h), those that are left out among them.
class CountingReader final : public PointReader {
public:
    explicit CountingReader(std::unique_ptr<PointReader> file) : file_(std::move(file)) {}

    const FileInfo& info() const override { return file_->info(); }
    bool read(PointBatch& batch, std::size_t max_points) override
    {
        const bool more = file_->read(batch, max_points);
        count_points_read(batch.size);
        return more;
    }
    bool has_records() const override { return file_->has_records(); }
    bool read_records(RecordBatch& batch, std::size_t max_points) override
    {
        const bool more = file_->read_records(batch, max_points);
        count_points_read(batch.size);
        return more;
    }
    bool seekable() const override { return file_->seekable(); }
    void seek(std::uint64_t index) override { file_->seek(index); }
    double fraction_read() const override { return file_->fraction_read(); }

private:
    const std::unique_ptr<PointReader> file_;
};

}  // namespace

bool PointReader::read_records(RecordBatch&, std::size_t)
{
    throw Error(ErrorCode::unsupported, {}, "this reader has no records");
}

void PointReader::seek(std::uint64_t)
{
    throw Error(ErrorCode::unsupported, {}, "points of this format can only be read in order");
}

std::unique_ptr<PointReader> open_reader(const std::filesystem::path& path, const ReadOptions& options)
{
    std::unique_ptr<PointReader> reader = std::make_unique<CountingReader>(open_all_points(path, options));
    if (!options.largest_coordinate) return reader;
    return std::make_unique<LimitedReader>(std::move(reader), *options.largest_coordinate);
}

std::vector<std::string> readable_extensions()
{
    std::vector<std::string> all;
    for (const Format& format : formats())
        for (const std::string_view extension : format.extensions)
            if (!extension.empty()) all.emplace_back(extension);
    return all;
}

}  // namespace pcm
