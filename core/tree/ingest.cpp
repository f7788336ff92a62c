#include "tree/ingest.h"

#include "cloud/error.h"

#include <algorithm>
#include <cmath>

namespace pcm {

InputCloud::InputCloud(const std::vector<std::filesystem::path>& inputs) : paths_(expand_inputs(inputs))
{
    if (paths_.empty()) throw Error(ErrorCode::invalid_argument, {}, "no input files were given");
    for (const auto& path : paths_) {
        const auto reader = open_reader(path);
        infos_.push_back(reader->info());
        seekable_ = seekable_ && reader->seekable();
    }

    shares_grid_ = true;
    position_type_ = infos_[0].position_type;
    for (std::size_t r = 0; r < infos_.size(); ++r) {
        const FileInfo& info = infos_[r];
        promised_points_ += info.points;
        if (!info.grid || !(*info.grid == *infos_[0].grid)) shares_grid_ = false;
        if (info.position_type != position_type_) position_type_ = ScalarType::f64;
        for (const std::string& note : info.notes) notes_.push_back(paths_[r].filename().string() + ": " + note);
        std::vector<std::size_t> slots;
        for (Attribute attribute : info.schema) {
            auto slot = schema_.find(attribute.name);
            if (slot && !(schema_[*slot] == attribute)) {
                const std::string apart = attribute.name + "_" + std::string(name_of(attribute.type));
                notes_.push_back(paths_[r].filename().string() + ": attribute '" + attribute.name +
                                 "' differs from that of the other files and is kept as '" + apart + "'");
                attribute.name = apart;
                slot = schema_.find(apart);
                if (slot && !(schema_[*slot] == attribute))
                    throw Error(ErrorCode::unsupported, paths_[r],
                                "attribute '" + attribute.name + "' is of a third kind; import this file by itself");
            }
            if (!slot) {
                schema_.add(attribute);
                slot = schema_.size() - 1;
                if (r > 0)
                    notes_.push_back("attribute '" + attribute.name + "' is not in all files and is zero elsewhere");
            }
            slots.push_back(*slot);
        }
        slots_.push_back(std::move(slots));
    }
    if (shares_grid_) grid_ = *infos_[0].grid;
}

std::vector<std::string> InputCloud::source_names() const
{
    std::vector<std::string> names;
    for (const auto& path : paths_) names.push_back(path.filename().string());
    return names;
}

std::vector<Metadata> InputCloud::metadata() const
{
    std::vector<Metadata> all;
    for (const FileInfo& info : infos_)
        for (const Metadata& block : info.metadata)
            if (std::find(all.begin(), all.end(), block) == all.end()) all.push_back(block);
    return all;
}

std::optional<Grid> InputCloud::common_grid(const Vec3d& largest) const
{
    const Grid* first = grid_of(0);
    if (!first) return std::nullopt;
    for (std::size_t r = 1; r < infos_.size(); ++r) {
        const Grid* grid = grid_of(r);
        if (!grid || grid->scale != first->scale) return std::nullopt;
        for (std::size_t a = 0; a < 3; ++a) {
            const double steps = (grid->offset[a] - first->offset[a]) / first->scale[a];
            if (std::fabs(steps - std::round(steps)) > 1e-6) return std::nullopt;
        }
    }
    // Every coordinate must have a place on the grid that a double can tell from its neighbours.
    for (std::size_t a = 0; a < 3; ++a)
        if ((largest[a] + std::fabs(first->offset[a])) / std::fabs(first->scale[a]) > std::ldexp(1.0, 50)) return std::nullopt;
    return *first;
}

PointReader& InputCloud::open(std::size_t reader)
{
    if (!open_ || open_index_ != reader) {
        open_.reset();
        open_ = open_reader(paths_[reader]);
        open_index_ = reader;
        const FileInfo &now = open_->info(), &before = infos_[reader];
        if (now.points != before.points || !(now.schema == before.schema) || now.grid.has_value() != before.grid.has_value() ||
            (now.grid && !(*now.grid == *before.grid)))
            throw Error(ErrorCode::io, paths_[reader], "the file has changed while it was being read", "build again");
    }
    return *open_;
}

bool InputCloud::read(PointBatch& batch, std::size_t max_points)
{
    for (; current_ < infos_.size(); ++current_)
        if (open(current_).read(batch, max_points)) return true;
    current_ = infos_.size() - 1;
    return false;
}

double InputCloud::fraction_read() const
{
    double points = 0;
    for (std::size_t r = 0; r < current_; ++r) points += static_cast<double>(infos_[r].points);
    if (open_ && open_index_ == current_) points += static_cast<double>(infos_[current_].points) * open_->fraction_read();
    return promised_points_ ? std::min(1.0, points / static_cast<double>(promised_points_)) : 1.0;
}

std::vector<Vec3i> InputCloud::sample(std::size_t count)
{
    // Runs of neighbours cost one read; a run holds few points, so that all parts of the file are seen.
    constexpr std::uint64_t run = 512;
    const std::uint64_t runs = std::max<std::uint64_t>(1, count / run);
    const std::uint64_t stride = std::max(run, promised_points_ / runs);
    std::vector<Vec3i> points;
    points.reserve(count + run);
    PointBatch batch;
    std::uint64_t next = 0, start = 0;
    for (std::size_t r = 0; r < infos_.size(); ++r) {
        const std::uint64_t end = start + infos_[r].points;
        for (; next < end; next += stride) {
            open(r).seek(next - start);
            if (!open(r).read(batch, static_cast<std::size_t>(std::min(run, end - next)))) break;
            for (std::size_t i = 0; i < batch.size; ++i)
                points.push_back({batch.grid_xyz[0][i], batch.grid_xyz[1][i], batch.grid_xyz[2][i]});
        }
        start = end;
    }
    open_.reset();  // read() begins at the beginning
    return points;
}

namespace {

// A column's values to their places in the rows; sizes that occur often get a copy the compiler can see through.
template <std::size_t Size>
void scatter(const std::byte* from, std::size_t count, std::byte* to, std::size_t stride)
{
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * stride, from + i * Size, Size);
}

}  // namespace

void put_attributes(const PointBatch& batch, const RowLayout& layout, const std::vector<std::size_t>& slots,
                    std::byte* rows)
{
    if (slots.size() < layout.offsets.size()) {
        const std::size_t first = 3 * layout.coordinate_bytes;
        for (std::size_t i = 0; i < batch.size; ++i)
            std::memset(rows + i * layout.bytes + first, 0, layout.bytes - first);
    }
    for (std::size_t k = 0; k < slots.size(); ++k) {
        const std::byte* from = batch.attributes[k].data();
        const std::size_t size = layout.sizes[slots[k]];
        std::byte* to = rows + layout.offsets[slots[k]];
        switch (size) {
        case 1: scatter<1>(from, batch.size, to, layout.bytes); break;
        case 2: scatter<2>(from, batch.size, to, layout.bytes); break;
        case 3: scatter<3>(from, batch.size, to, layout.bytes); break;
        case 4: scatter<4>(from, batch.size, to, layout.bytes); break;
        case 6: scatter<6>(from, batch.size, to, layout.bytes); break;
        case 8: scatter<8>(from, batch.size, to, layout.bytes); break;
        case 12: scatter<12>(from, batch.size, to, layout.bytes); break;
        default:
            for (std::size_t i = 0; i < batch.size; ++i) std::memcpy(to + i * layout.bytes, from + i * size, size);
        }
    }
}

double power_of_two_step(double largest_magnitude)
{
    int exponent = 0;
    if (largest_magnitude > 0) std::frexp(largest_magnitude, &exponent);  // magnitude < 2^exponent
    // Steps below the smallest normal double would not be doubles themselves.
    return std::ldexp(1.0, std::max(exponent, -900) - 61);
}

std::int64_t to_grid_position(double value, double scale, double offset)
{
    return static_cast<std::int64_t>(std::llrint((value - offset) / scale));
}

}  // namespace pcm
