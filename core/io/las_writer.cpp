#include "io/las_writer.h"

#include "cloud/error.h"
#include "cloud/file.h"
#include "io/las_layout.h"

#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

namespace pcm {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;
constexpr std::uint8_t point_format = 2;
constexpr std::size_t record_length = las::record_bytes[point_format];
constexpr std::uint64_t most_points = std::numeric_limits<std::uint32_t>::max();

void store_record(std::byte* to, const LasPoint& point)
{
    constexpr std::uint8_t only_return = 1 | 1 << 3;  // return 1 of 1
    las::store(to, point.x);
    las::store(to + 4, point.y);
    las::store(to + 8, point.z);
    las::store(to + 12, point.intensity);
    las::store(to + 14, only_return);
    las::store(to + 15, static_cast<std::uint8_t>(point.classification & 31u));
    las::store(to + 16, std::uint16_t{0});  // scan angle rank, user data
    las::store(to + 18, point.source_id);
    las::store(to + 20, point.red);
    las::store(to + 22, point.green);
    las::store(to + 24, point.blue);
}

}  // namespace

struct LasWriter::Impl {
    std::filesystem::path path;
    std::filesystem::path part;
    Grid grid;
    File file;
    std::vector<std::byte> buffer;
    std::uint64_t written = 0;  // bytes in the file
    std::uint64_t points = 0;
    Box3i box;
    bool finished = false;

    void flush()
    {
        if (buffer.empty()) return;
        file.write_at(buffer.data(), buffer.size(), written);
        written += buffer.size();
        buffer.clear();
    }

    std::vector<std::byte> header() const;
};

std::vector<std::byte> LasWriter::Impl::header() const
{
    namespace at = las::header;
    std::vector<std::byte> bytes(at::size_1_0);
    std::byte* to = bytes.data();
    std::memcpy(to, "LASF", 4);
    las::store(to + at::version_major, std::uint8_t{1});
    las::store(to + at::version_minor, std::uint8_t{2});
    std::memcpy(to + at::system_identifier, "OTHER", 5);
    std::memcpy(to + at::generating_software, "pcm", 3);
    // A fixed date: the same points give the same bytes on any day.
    las::store(to + at::creation_day, std::uint16_t{1});
    las::store(to + at::creation_year, std::uint16_t{2025});
    las::store(to + at::header_size, static_cast<std::uint16_t>(at::size_1_0));
    las::store(to + at::point_offset, static_cast<std::uint32_t>(at::size_1_0));
    las::store(to + at::point_format, point_format);
    las::store(to + at::record_length, static_cast<std::uint16_t>(record_length));
    las::store(to + at::point_count_32, static_cast<std::uint32_t>(points));
    las::store(to + at::return_counts_32, static_cast<std::uint32_t>(points));
    const Box3d bounds = points ? grid.to_source(box) : Box3d{{0, 0, 0}, {0, 0, 0}};
    for (std::size_t a = 0; a < 3; ++a) {
        las::store(to + at::scale + 8 * a, grid.scale[a]);
        las::store(to + at::offset + 8 * a, grid.offset[a]);
        las::store(to + at::box + 16 * a, bounds.max[a]);
        las::store(to + at::box + 16 * a + 8, bounds.min[a]);
    }
    return bytes;
}

LasWriter::LasWriter(const std::filesystem::path& path, const Grid& grid)
{
    for (std::size_t a = 0; a < 3; ++a)
        if (!(grid.scale[a] > 0) || !std::isfinite(grid.scale[a]) || !std::isfinite(grid.offset[a]))
            throw Error(ErrorCode::invalid_argument, path,
                        "a LAS grid needs positive scales and finite offsets, found scale " +
                            std::to_string(grid.scale[a]) + " and offset " + std::to_string(grid.offset[a]));
    impl_ = std::make_unique<Impl>();
    impl_->path = path;
    impl_->part = path;
    impl_->part += ".part-" + std::to_string(::getpid());
    impl_->grid = grid;
    impl_->file = File(impl_->part, File::Mode::create_or_truncate);
    impl_->buffer.reserve(buffer_bytes);
    impl_->buffer.resize(las::header::size_1_0);  // the place of the header, which is known at the end
}

LasWriter::~LasWriter()
{
    if (!impl_ || impl_->finished) return;
    std::error_code ignored;
    std::filesystem::remove(impl_->part, ignored);
}

void LasWriter::write(const LasPoint* points, std::size_t count)
{
    Impl& self = *impl_;
    if (self.finished) throw Error(ErrorCode::invalid_argument, self.path, "points written after finish()");
    if (count > most_points - self.points)
        throw Error(ErrorCode::invalid_argument, self.path,
                    "LAS 1.2 counts points in 32 bits and cannot hold more than 4294967295; " +
                        std::to_string(self.points) + " are written and " + std::to_string(count) +
                        " more were asked for",
                    "write several files");
    while (count) {
        const std::size_t room = (buffer_bytes - self.buffer.size()) / record_length;
        if (room == 0) {
            self.flush();
            continue;
        }
        const std::size_t now = std::min(room, count);
        const std::size_t start = self.buffer.size();
        self.buffer.resize(start + now * record_length);
        std::byte* to = self.buffer.data() + start;
        for (std::size_t i = 0; i < now; ++i, to += record_length) {
            store_record(to, points[i]);
            self.box.extend(Vec3i{points[i].x, points[i].y, points[i].z});
        }
        points += now;
        count -= now;
        self.points += now;
    }
}

void LasWriter::finish()
{
    Impl& self = *impl_;
    if (self.finished) throw Error(ErrorCode::invalid_argument, self.path, "finish() called twice");
    self.flush();
    const std::vector<std::byte> header = self.header();
    self.file.write_at(header.data(), header.size(), 0);
    self.file.close();
    if (std::rename(self.part.c_str(), self.path.c_str()) != 0)
        throw Error::from_errno(errno, self.path, "putting the finished file in place");
    self.finished = true;
}

}  // namespace pcm
