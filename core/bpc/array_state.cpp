#include "pcm/bpc/array_state.h"

#include "pcm/bpc/batch_chunk.h"
#include "pcm/bpc/bpc_file_writer.h"
#include "pcm/system/error.h"

#include <string>

namespace pcm {

using array::ColumnFlags;
using array::Columns;

void BpcArray::State::set_up(const BpcCloud& cloud)
{
    shape = array::columns_of(cloud);
    for (const Attribute& column : shape) row_bytes += column.bytes();
    for (const Metadata& block : cloud.metadata) metadata_bytes += block.key.size() + block.value.size() + 64;
    chunk_points = options.chunk_points ? options.chunk_points : default_cloud_chunk_points(cloud.schema);
    expected.resize(shape.size());
    for (std::uint64_t c = 0; c < chunks(); ++c) largest_chunk = std::max(largest_chunk, capacity(c));
    largest_chunk = std::max(largest_chunk, chunk_points);
    if (chunks() > 0) chunks_a_point = 1 / static_cast<double>(first[1]);
    where.assign(static_cast<std::size_t>(chunks()), residents.end());
    check_memory();
}

void BpcArray::State::check_memory() const
{
    const std::size_t least = overhead(false) + 2 * largest_chunk * row_bytes;
    if (options.memory_bytes < least)
        throw Error(ErrorCode::invalid_argument, path,
                    "an array of " + std::to_string(chunks()) + " chunks of up to " + std::to_string(largest_chunk) +
                        " points needs at least " + std::to_string(least) + " bytes of memory; " +
                        std::to_string(options.memory_bytes) + " were given");
}

array::ChunkSource BpcArray::State::source(std::uint64_t chunk) const
{
    array::ChunkSource source;
    if (base && chunk < base->index().end().number) {
        source.base = base.get();
        source.place = base->index().at(chunk);
    }
    source.count = count(chunk);
    source.capacity = capacity(chunk);
    if (const auto found = spilled.find(chunk); found != spilled.end()) {
        source.scratch = &scratch.file();
        source.spilled = found->second;
    }
    return source;
}

std::uint64_t BpcArray::State::chunk_of(std::uint64_t index) const
{
    // In most clouds all chunks have the same size.
    const auto guess = static_cast<std::uint64_t>(static_cast<double>(index) * chunks_a_point);
    if (guess < chunks() && first[guess] <= index && index < first[guess + 1]) return guess;
    return static_cast<std::uint64_t>(std::upper_bound(first.begin(), first.end(), index) - first.begin()) - 1;
}

void BpcArray::State::spill(Resident& resident, Statistics& statistics)
{
    if (std::none_of(resident.changed.begin(), resident.changed.end(), [](std::uint8_t c) { return c != 0; })) return;
    auto found = spilled.find(resident.chunk);
    if (found == spilled.end()) found = spilled.emplace(resident.chunk, scratch.slot(shape, resident.capacity)).first;
    for (std::size_t k = 0; k < shape.size(); ++k)
        if (resident.changed[k]) {
            scratch.write(found->second, shape, resident.capacity, k, *resident.columns[k], count(resident.chunk));
            ++statistics.columns_spilled;
        }
}

// Adds a resident without columns, as the most recently used.
void BpcArray::State::add_resident(std::uint64_t chunk)
{
    Resident resident;
    resident.chunk = chunk;
    resident.capacity = capacity(chunk);
    resident.columns.resize(shape.size());
    resident.data.resize(shape.size());
    resident.changed.resize(shape.size());
    residents.push_front(std::move(resident));
}

// Evicts residents until `bytes` more fit; the first resident stays.
void BpcArray::State::make_room(std::size_t bytes, Statistics& statistics)
{
    const std::size_t limit = resident_limit();
    while (resident_bytes + bytes > limit && residents.size() > 1) {
        Resident& last = residents.back();
        spill(last, statistics);
        resident_bytes -= last.bytes;
        where[static_cast<std::size_t>(last.chunk)] = residents.end();
        residents.pop_back();
        ++statistics.chunks_evicted;
    }
}

void BpcArray::State::install(Resident& resident, Columns columns, Statistics& statistics)
{
    for (std::size_t k = 0; k < columns.size(); ++k)
        if (columns[k]) {
            resident.bytes += columns[k]->bytes();
            resident_bytes += columns[k]->bytes();
            resident.columns[k] = std::move(columns[k]);
        }
    ++statistics.chunks_decoded;
    statistics.most_resident_bytes = std::max(statistics.most_resident_bytes, resident_bytes);
}

// Loads the wanted columns that the first resident lacks.
void BpcArray::State::load_missing(ColumnFlags wanted, Statistics& statistics)
{
    Resident& window = residents.front();
    std::size_t bytes = 0;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        if (window.columns[k]) wanted[k] = 0;
        if (wanted[k]) bytes += window.capacity * shape[k].bytes();
    }
    if (bytes == 0) return;
    make_room(bytes, statistics);
    install(window, array::load_columns(source(window.chunk), shape, wanted), statistics);
}

void BpcArray::State::read_ahead_of(std::uint64_t chunk)
{
    if (chunk >= chunks() || where[static_cast<std::size_t>(chunk)] != residents.end() || !reads_ahead()) return;
    if (ahead.valid()) {
        if (ahead_chunk == chunk || !ahead.done()) return;
        drop_ahead();
    }
    if (std::none_of(expected.begin(), expected.end(), [](std::uint8_t e) { return e != 0; })) return;
    ahead_chunk = chunk;
    ahead = Pending<Columns>(pool, 1, [this, source = source(chunk), wanted = expected] {
        return array::load_columns(source, shape, wanted);
    });
}

void BpcArray::State::drop_ahead() { ahead = {}; }

bool BpcArray::State::is_changed(std::uint64_t chunk) const
{
    if (!base || chunk >= base->index().end().number || spilled.count(chunk)) return true;
    const auto place = where[static_cast<std::size_t>(chunk)];
    if (place == std::list<Resident>::const_iterator(residents.end())) return false;
    return std::any_of(place->changed.begin(), place->changed.end(), [](std::uint8_t c) { return c != 0; });
}

std::vector<std::byte> BpcArray::State::encoded(Resident& resident, const BpcCloud& cloud) const
{
    const std::size_t points = count(resident.chunk);
    for (const auto& column : resident.columns) column->resize(points);  // its memory stays
    PointColumns columns;
    columns.size = points;
    columns.gridded = cloud.grid.has_value();
    for (std::size_t a = 0; a < 3; ++a) {
        if (columns.gridded)
            columns.grid_xyz[a] = resident.columns[a]->as<std::int32_t>();
        else
            columns.xyz[a] = resident.columns[a]->as<double>();
    }
    for (std::size_t k = 3; k < shape.size(); ++k) columns.attributes.push_back(resident.columns[k].get());
    std::vector<std::byte> bytes = encode_points(columns, cloud.schema, cloud.grid);
    for (const auto& column : resident.columns) column->resize(resident.capacity);
    return bytes;
}

}  // namespace pcm
