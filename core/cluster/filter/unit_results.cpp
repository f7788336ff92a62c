#include "pcm/cluster/filter/unit_results.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/system/error.h"

#include <cstring>
#include <string>
#include <utility>

namespace pcm {
namespace {

constexpr const char* units_stage = "units";
// Chosen: records are some hundred bytes, and a node's neighbours in the order of the tree ask for the same ones.
constexpr std::size_t most_records = 1024;

std::vector<Box3d> in_doubles(const std::vector<Box3i>& boxes)
{
    std::vector<Box3d> all;
    for (const Box3i& box : boxes) {
        Box3d in_double;
        for (const Vec3i& corner : {box.min, box.max})
            in_double.extend(
                Vec3d{static_cast<double>(corner[0]), static_cast<double>(corner[1]), static_cast<double>(corner[2])});
        all.push_back(in_double);
    }
    return all;
}

}  // namespace

UnitResults::UnitResults(const JobFolder& jobs, const Tree& tree, const std::vector<Box3i>& units,
                         std::vector<std::size_t> widths, std::size_t head_bytes)
    : jobs_(jobs),
      tree_(tree),
      units_(units.size()),
      widths_(std::move(widths)),
      head_bytes_(head_bytes),
      boxes_(in_doubles(units))
{
    jobs.begin(units_stage);
}

std::size_t UnitResults::point_bytes() const
{
    std::size_t sum = sizeof(std::uint32_t);
    for (const std::size_t width : widths_) sum += width;
    return sum;
}

bool UnitResults::is_done(std::size_t unit) const { return jobs_.is_done({units_stage, unit}); }

void UnitResults::write(const NeighbourhoodUnit& unit, const std::vector<const void*>& columns,
                        const std::vector<std::byte>& head, const std::vector<std::byte>& more) const
{
    ByteWriter data, record;
    data.bytes().reserve(unit.points * point_bytes() + more.size());
    for (const NeighbourhoodUnit::Part& part : unit.parts) {
        data.put_bytes(part.indices.data(), part.indices.size() * sizeof(std::uint32_t));
        for (std::size_t c = 0; c < widths_.size(); ++c)
            data.put_bytes(static_cast<const std::byte*>(columns[c]) + part.first * widths_[c],
                           part.indices.size() * widths_[c]);
    }
    data.put_bytes(more.data(), more.size());
    record.put_bytes(head.data(), head.size());
    record.put(static_cast<std::uint64_t>(more.size()));
    for (const NeighbourhoodUnit::Part& part : unit.parts) {
        record.put(part.node);
        record.put(static_cast<std::uint32_t>(part.indices.size()));
    }
    jobs_.write({units_stage, unit.unit}, data.bytes(), record.bytes());
}

void UnitResults::write_empty(std::size_t unit) const
{
    NeighbourhoodUnit none;
    none.unit = unit;
    write(none, std::vector<const void*>(widths_.size(), nullptr), std::vector<std::byte>(head_bytes_), {});
}

std::shared_ptr<const UnitResults::Record> UnitResults::record(std::size_t unit) const
{
    {
        const std::lock_guard lock(mutex_);
        const auto found = records_.find(unit);
        if (found != records_.end()) return found->second;
    }
    const std::vector<std::byte> bytes = jobs_.record({units_stage, unit});
    const std::filesystem::path path = jobs_.file({units_stage, unit});
    ByteReader in(bytes.data(), bytes.size(), path);
    auto record = std::make_shared<Record>();
    const std::byte* const head = in.get_bytes(head_bytes_);
    record->head.assign(head, head + head_bytes_);
    record->more_bytes = in.get<std::uint64_t>();
    while (in.left()) {
        const auto node = in.get<NodeId>();
        const auto points = in.get<std::uint32_t>();
        record->places.push_back({node, points, record->more_at});
        record->more_at += points * point_bytes();
    }
    const std::lock_guard lock(mutex_);
    if (records_.size() >= most_records) records_.clear();
    return records_[unit] = record;
}

UnitResults::Part UnitResults::read(const File& file, std::size_t unit, const Place& place) const
{
    std::vector<std::byte> bytes(place.points * point_bytes());
    file.read_at(bytes.data(), bytes.size(), place.offset);
    Part part;
    part.unit = unit;
    part.node = place.node;
    part.indices.resize(place.points);
    std::memcpy(part.indices.data(), bytes.data(), place.points * sizeof(std::uint32_t));
    const std::byte* at = bytes.data() + place.points * sizeof(std::uint32_t);
    for (const std::size_t width : widths_) {
        part.columns.emplace_back(at, at + place.points * width);
        at += place.points * width;
    }
    const std::uint32_t points = place.node < tree_.nodes().size() ? tree_.node(place.node).points : 0;
    for (const std::uint32_t index : part.indices)
        if (index >= points)
            throw Error(ErrorCode::corrupt, file.path(), "it is about points that the tree has not",
                        "remove the folder of the job files, and start again");
    return part;
}

void UnitResults::for_each_of_unit(std::size_t unit, const See& see) const
{
    const auto known = record(unit);
    const File file(jobs_.file({units_stage, unit}), File::Mode::read);
    for (const Place& place : known->places) see(read(file, unit, place));
}

void UnitResults::for_each_of_node(NodeId node, const See& see) const
{
    for (const std::uint32_t unit : boxes_.touching(in_doubles({tree_.node(node).box})[0])) {
        const auto known = record(unit);
        for (const Place& place : known->places)
            if (place.node == node) see(read(File(jobs_.file({units_stage, unit}), File::Mode::read), unit, place));
    }
}

std::vector<std::byte> UnitResults::head(std::size_t unit) const { return record(unit)->head; }

std::vector<std::byte> UnitResults::more(std::size_t unit) const
{
    const auto known = record(unit);
    std::vector<std::byte> bytes(known->more_bytes);
    if (!bytes.empty())
        File(jobs_.file({units_stage, unit}), File::Mode::read).read_at(bytes.data(), bytes.size(), known->more_at);
    return bytes;
}

Column UnitResults::column(NodeId node, std::size_t number, const Attribute& attribute) const
{
    Column column(attribute);
    column.resize(tree_.node(node).points);
    const std::size_t width = widths_[number];
    std::size_t points = 0;
    for_each_of_node(node, [&](const Part& part) {
        for (std::size_t i = 0; i < part.indices.size(); ++i)
            std::memcpy(column.data() + part.indices[i] * width, part.columns[number].data() + i * width, width);
        points += part.indices.size();
    });
    if (points != column.size())
        throw Error(ErrorCode::corrupt, tree_.folder(),
                    std::to_string(points) + " values were computed for " + std::to_string(column.size()) +
                        " points of node " + std::to_string(node));
    return column;
}

}  // namespace pcm
