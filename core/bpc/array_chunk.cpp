#include "pcm/bpc/array_chunk.h"

#include "pcm/bpc/batch_chunk.h"
#include "pcm/bpc/checksum.h"
#include "pcm/bpc/column_codec.h"
#include "pcm/system/error.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <string>

namespace pcm::array {
namespace {

constexpr std::size_t axes = 3;

// The offset of a column in the place of a chunk.
std::uint64_t offset_of(const std::vector<Attribute>& shape, std::size_t column, std::size_t capacity)
{
    std::uint64_t offset = 0;
    for (std::size_t k = 0; k < column; ++k) offset += shape[k].bytes() * capacity;
    return offset;
}

void take_from_base(const ChunkSource& source, const std::vector<Attribute>& shape, const ColumnFlags& wanted,
                    Columns& columns)
{
    ColumnSet set;
    set.positions = std::any_of(wanted.begin(), wanted.begin() + axes, [](std::uint8_t w) { return w != 0; });
    for (std::size_t k = axes; k < shape.size(); ++k) set.attributes.set(k - axes, wanted[k]);
    DecodedChunk decoded = source.base->read(*source.place, set);
    const std::size_t points = decoded.header.points;
    for (std::size_t a = 0; set.positions && a < axes; ++a) {
        if (!wanted[a]) continue;
        columns[a] = std::make_shared<Column>(shape[a]);
        columns[a]->resize(std::max(points, source.capacity));
        if (shape[a].type == ScalarType::i32)
            positions_to(decoded.header, *decoded.chunk.positions, a, 0, points, columns[a]->as<std::int32_t>());
        else
            positions_to(decoded.header, *decoded.chunk.positions, a, 0, points, columns[a]->as<double>());
    }
    for (std::size_t k = axes; k < shape.size(); ++k)
        if (wanted[k]) {
            // Decoded for this call: it is not shared.
            columns[k] = std::const_pointer_cast<Column>(decoded.chunk.attributes[k - axes]);
            if (columns[k]->size() != source.capacity) columns[k]->resize(source.capacity);
        }
}

}  // namespace

std::vector<Attribute> columns_of(const BpcCloud& cloud)
{
    std::vector<Attribute> shape;
    for (const char* axis : {"x", "y", "z"})
        shape.push_back({axis, cloud.grid ? ScalarType::i32 : ScalarType::f64, 1, 1, 0, ""});
    shape.insert(shape.end(), cloud.schema.begin(), cloud.schema.end());
    return shape;
}

Columns load_columns(const ChunkSource& source, const std::vector<Attribute>& shape, const ColumnFlags& wanted)
{
    Columns columns(shape.size());
    ColumnFlags from_base = wanted;
    for (std::size_t k = 0; k < shape.size(); ++k) {
        if (!wanted[k]) continue;
        const bool spilled = source.spilled && source.spilled->has[k];
        if (!spilled && source.place) continue;
        from_base[k] = 0;
        columns[k] = std::make_shared<Column>(shape[k]);
        columns[k]->resize(source.capacity);
        if (!spilled) continue;
        const std::size_t bytes = source.spilled->points * shape[k].bytes();
        source.scratch->read_at(columns[k]->data(), bytes,
                                source.spilled->offset + offset_of(shape, k, source.capacity));
        if (checksum(columns[k]->data(), bytes) != source.spilled->checksums[k])
            throw Error(
                ErrorCode::corrupt, source.scratch->path(),
                "the scratch file does not have the bytes that were written to it: column '" + shape[k].name + "'");
    }
    if (std::any_of(from_base.begin(), from_base.end(), [](std::uint8_t w) { return w != 0; }))
        take_from_base(source, shape, from_base, columns);
    return columns;
}

ScratchFile::ScratchFile(const std::filesystem::path& cloud, const std::filesystem::path& folder)
    : cloud_(cloud), folder_(folder)
{
}

Spilled ScratchFile::slot(const std::vector<Attribute>& shape, std::size_t capacity)
{
    if (!file_.is_open()) {
        static std::atomic<unsigned> count{0};
        std::filesystem::path path = cloud_;
        if (!folder_.empty()) path = folder_ / cloud_.filename();
        path += ".scratch-" + std::to_string(::getpid()) + "-" + std::to_string(count++);
        file_ = File(path, File::Mode::create_new);
        // The open file stays usable; without a name nothing stays on disk when the process ends.
        if (::unlink(path.c_str()) != 0) throw Error::from_errno(errno, path, "removing the scratch file's name");
    }
    Spilled slot;
    slot.offset = end_;
    slot.has.resize(shape.size());
    slot.checksums.resize(shape.size());
    end_ += offset_of(shape, shape.size(), capacity);
    return slot;
}

void ScratchFile::write(Spilled& slot, const std::vector<Attribute>& shape, std::size_t capacity, std::size_t column,
                        const Column& values, std::size_t points)
{
    const std::size_t bytes = points * shape[column].bytes();
    file_.write_at(values.data(), bytes, slot.offset + offset_of(shape, column, capacity));
    slot.has[column] = 1;
    slot.points = points;
    slot.checksums[column] = checksum(values.data(), bytes);
}

void ScratchFile::clear()
{
    file_ = File();
    end_ = 0;
}

std::size_t coding_bytes(const std::vector<Attribute>& shape, std::size_t points)
{
    // The codec pads blocks and adds a few bytes to each; the payload grows by doubling and is copied once, after its
    // header.
    const std::size_t filled = (points + codec_block - 1) / codec_block * codec_block;
    std::size_t encoded = 0, headers = 0;
    for (const Attribute& column : shape) {
        encoded += filled * column.bytes() * 17 / 16 + std::size_t{64} * column.components;
        headers += 128 + column.name.size() + column.description.size();
    }
    // The integers of the positions, twice, and the words of a column.
    return points * (24 + 24 + 16) + 4 * encoded + 8 * headers + (std::size_t{64} << 10);
}

}  // namespace pcm::array
