#include "pcm/bpc/bpc_array.h"

#include "pcm/bpc/array_state.h"
#include "pcm/bpc/bpc_file_writer.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>

namespace pcm {

using array::ColumnFlags;
using array::Columns;

BpcArray::BpcArray(const std::filesystem::path& path, const BpcArrayOptions& options)
    : state_(std::make_unique<State>(path, options))
{
    State& s = *state_;
    s.base = std::make_unique<BpcFile>(path);
    cloud_ = s.base->cloud();
    size_ = cloud_.points;
    const ChunkIndex& index = s.base->index();
    if (!index.knows_every_chunk())
        throw Error(ErrorCode::unsupported, path,
                    std::to_string(index.end().number) + " chunks; an array can have " +
                        std::to_string(ChunkIndex::most_places),
                    "write the cloud again, which makes larger chunks");
    s.first.reserve(static_cast<std::size_t>(index.end().number) + 1);
    for (std::uint64_t c = 1; c <= index.end().number; ++c) s.first.push_back(index.at(c)->first_point);
    s.set_up(cloud_);
}

BpcArray::BpcArray(const std::filesystem::path& path, const BpcCloud& cloud, const BpcArrayOptions& options)
    : cloud_(cloud), state_(std::make_unique<State>(path, options))
{
    cloud_.points = cloud_.chunks = 0;
    cloud_.box.reset();
    encode_cloud_block(cloud_, 0);  // throws now what would prevent writing later
    state_->set_up(cloud_);
}

BpcArray::~BpcArray() = default;

void BpcArray::open_window(std::uint64_t index)
{
    State& s = *state_;
    if (index >= size_)
        throw Error(ErrorCode::invalid_argument, s.path,
                    "point " + std::to_string(index) + " of an array of " + std::to_string(size_));
    const std::uint64_t chunk = s.chunk_of(index);
    State::Place& place = s.where[static_cast<std::size_t>(chunk)];
    if (place != s.residents.end()) {
        s.residents.splice(s.residents.begin(), s.residents, place);
    } else {
        // This window probably needs the same columns as the last one.
        if (count_)
            for (std::size_t k = 0; k < s.shape.size(); ++k) s.expected[k] = s.residents.front().data[k] != nullptr;
        count_ = 0;  // until the window is open
        std::optional<Columns> ahead;
        if (s.ahead.valid() && s.ahead_chunk == chunk) ahead = s.ahead.get();
        s.add_resident(chunk);
        place = s.residents.begin();
        if (ahead) {
            std::size_t bytes = 0;
            for (const auto& column : *ahead) bytes += column ? column->bytes() : 0;
            s.make_room(bytes, statistics_);
            s.install(*place, std::move(*ahead), statistics_);
            ++statistics_.chunks_read_ahead;
        } else {
            s.load_missing(s.expected, statistics_);
        }
        if (chunk == s.last_opened + 1) s.read_ahead_of(chunk + 1);
    }
    s.last_opened = chunk;
    first_ = s.first[chunk];
    count_ = s.count(chunk);
    window_data_ = place->data.data();
    window_changed_ = place->changed.data();
}

std::byte* BpcArray::load(std::size_t column)
{
    // The three axes are one column in the file.
    ColumnFlags wanted(state_->shape.size());
    wanted[column] = 1;
    if (column < positions_) std::fill_n(wanted.begin(), positions_, std::uint8_t{1});
    state_->load_missing(wanted, statistics_);
    Resident& window = state_->residents.front();
    for (std::size_t k = 0; k < wanted.size(); ++k)
        if (wanted[k]) window.data[k] = window.columns[k]->data();
    return window.data[column];
}

std::size_t BpcArray::find(std::string_view name, ScalarType type) const
{
    const auto found = schema().find(name);
    if (!found) {
        std::string known;
        for (const Attribute& attribute : schema()) known += (known.empty() ? "" : ", ") + attribute.name;
        throw Error(ErrorCode::invalid_argument, state_->path, "no attribute '" + std::string(name) + "'",
                    known.empty() ? "the points have no attributes" : "its attributes are " + known);
    }
    if (schema()[*found].type != type)
        throw Error(ErrorCode::invalid_argument, state_->path,
                    "attribute '" + std::string(name) + "' is of type " + std::string(name_of(schema()[*found].type)) +
                        ", not " + std::string(name_of(type)));
    return *found;
}

void BpcArray::set_position(std::uint64_t index, const Vec3d& position)
{
    if (cloud_.grid) {
        std::array<std::int32_t, 3> grid;
        for (std::size_t a = 0; a < 3; ++a) {
            const double steps = std::nearbyint((position[a] - cloud_.grid->offset[a]) / cloud_.grid->scale[a]);
            if (!(steps >= std::numeric_limits<std::int32_t>::min() &&
                  steps <= std::numeric_limits<std::int32_t>::max()))
                throw Error(ErrorCode::invalid_argument, state_->path,
                            "the coordinate " + std::to_string(position[a]) + " has no place on the cloud's grid");
            grid[a] = static_cast<std::int32_t>(steps);
        }
        return set_grid_position(index, grid);
    }
    for (std::size_t a = 0; a < 3; ++a) {
        std::byte* data = at_for_change(index, a);
        reinterpret_cast<double*>(data)[index - first_] = position[a];
    }
}

std::array<std::int32_t, 3> BpcArray::grid_position(std::uint64_t index)
{
    if (!cloud_.grid)
        throw Error(ErrorCode::invalid_argument, state_->path, "the positions are doubles, not on a grid");
    std::array<std::int32_t, 3> position;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::byte* data = at(index, a);
        position[a] = reinterpret_cast<const std::int32_t*>(data)[index - first_];
    }
    return position;
}

void BpcArray::set_grid_position(std::uint64_t index, const std::array<std::int32_t, 3>& position)
{
    if (!cloud_.grid)
        throw Error(ErrorCode::invalid_argument, state_->path, "the positions are doubles, not on a grid");
    for (std::size_t a = 0; a < 3; ++a) {
        std::byte* data = at_for_change(index, a);
        reinterpret_cast<std::int32_t*>(data)[index - first_] = position[a];
    }
}

double BpcArray::value(std::uint64_t index, std::size_t attribute, std::uint32_t component)
{
    at(index, positions_ + attribute);
    return state_->residents.front().columns[positions_ + attribute]->value(static_cast<std::size_t>(index - first_),
                                                                            component);
}

// Appends up to `points` points, 0 in every column, to the last chunk or a new one, which becomes the window. Returns
// how many fitted.
std::size_t BpcArray::grow(std::size_t points)
{
    State& s = *state_;
    if (s.chunks() == 0 || s.count(s.chunks() - 1) >= s.capacity(s.chunks() - 1)) {
        if (s.chunks() == ChunkIndex::most_places)
            throw Error(ErrorCode::unsupported, s.path, "an array can have " + std::to_string(s.chunks()) + " chunks");
        // Whatever can fail comes first. Next to the first resident, which stays, there is always room for a second.
        s.make_room(s.chunk_points * s.row_bytes, statistics_);
        s.first.push_back(size_);
        s.where.push_back(s.residents.end());
        try {
            s.check_memory();
            s.add_resident(s.chunks() - 1);
        } catch (...) {
            s.first.pop_back();
            s.where.pop_back();
            throw;
        }
        if (!s.reads_ahead()) s.drop_ahead();
        s.where.back() = s.residents.begin();
        s.last_opened = s.chunks() - 1;
        count_ = 0;
        first_ = size_;
        window_data_ = s.residents.front().data.data();
        window_changed_ = s.residents.front().changed.data();
    } else if (first_ + count_ != size_ || count_ == 0) {
        open_window(size_ - 1);
    }
    Resident& last = s.residents.front();
    if (!last.grows) {
        s.load_missing(ColumnFlags(s.shape.size(), 1), statistics_);
        for (std::size_t k = 0; k < s.shape.size(); ++k) {
            last.data[k] = last.columns[k]->data();
            last.changed[k] = 1;
        }
        last.grows = true;
    }
    if (last.chunk == 0) s.chunks_a_point = 1 / static_cast<double>(last.capacity);
    points = std::min(points, last.capacity - s.count(last.chunk));
    size_ += points;
    s.first.back() = size_;
    count_ = s.count(last.chunk);
    return points;
}

BpcArray::Point BpcArray::push_back()
{
    grow(1);
    return {*this, size_ - 1};
}

void BpcArray::append(const PointBatch& batch)
{
    State& s = *state_;
    bool same = batch.gridded == cloud_.grid.has_value() && batch.attributes.size() == schema().size();
    for (std::size_t i = 0; same && i < schema().size(); ++i)
        same = batch.attributes[i].type() == schema()[i].type &&
               batch.attributes[i].components() == schema()[i].components;
    if (!same) throw Error(ErrorCode::invalid_argument, s.path, "a batch of another shape than the array's points");
    for (std::size_t done = 0; done < batch.size;) {
        const std::size_t now = grow(batch.size - done);
        const auto at = static_cast<std::size_t>(size_ - first_) - now;
        for (std::size_t k = 0; k < s.shape.size(); ++k) {
            const std::size_t bytes = s.shape[k].bytes();
            const auto* from = k >= positions_ ? batch.attributes[k - positions_].data()
                               : batch.gridded ? reinterpret_cast<const std::byte*>(batch.grid_xyz[k].data())
                                               : reinterpret_cast<const std::byte*>(batch.xyz[k].data());
            std::memcpy(window_data_[k] + at * bytes, from + done * bytes, now * bytes);
        }
        done += now;
    }
}

void BpcArray::save_as(const std::filesystem::path& path)
{
    State& s = *state_;
    s.drop_ahead();
    BpcFileWriter writer(path, cloud_);
    std::vector<std::byte> bytes;
    for (std::uint64_t chunk = 0; chunk < s.chunks(); ++chunk) {
        if (s.is_changed(chunk)) {
            open_window(s.first[chunk]);
            s.load_missing(ColumnFlags(s.shape.size(), 1), statistics_);
            bytes = s.encoded(s.residents.front(), cloud_);
        } else {
            const ChunkPlace place = *s.base->index().at(chunk);
            bytes.resize(static_cast<std::size_t>(s.base->header(place).total_bytes));
            s.base->file().read_at(bytes.data(), bytes.size(), place.offset);
        }
        writer.append(bytes);
        bytes = {};
    }
    s.drop_ahead();
    writer.finish();
}

void BpcArray::flush()
{
    State& s = *state_;
    std::optional<Error> not_durable;
    try {
        save_as(s.path);
    } catch (const Error& error) {
        if (!error.is_done()) throw;
        not_durable = error;
    }
    auto base = std::make_unique<BpcFile>(s.path);
    if (base->index().end().number != s.chunks() || base->index().end().first_point != size_)
        throw Error(ErrorCode::io, s.path, "another process changed the file while it was being written");
    s.base = std::move(base);
    s.spilled.clear();
    s.scratch.clear();
    for (Resident& resident : s.residents) {
        std::fill(resident.changed.begin(), resident.changed.end(), std::uint8_t{0});
        resident.grows = false;
    }
    if (not_durable) throw *not_durable;
}

}  // namespace pcm
