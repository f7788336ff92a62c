#include "pcm/detect/unit_parts.h"

#include "pcm/detect/point_labels.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace pcm {
namespace {

constexpr std::size_t border_cells = std::size_t(1) << 19;  // in memory at once
constexpr std::uint32_t no_place = AssignedPoints::no_part;

// A part as it is in the file; then as many points as `some` says.
struct Record {
    std::uint32_t number = 0, hypothesis = 0;
    std::uint64_t points = 0, sampled = 0, edge = 0, continued = 0, mixed = 0, some = 0;
    double squares = 0, smooth_squares = 0;
    Vec3d low{}, high{};
};

void append(std::vector<char>& bytes, const void* from, std::size_t size)
{
    const std::size_t place = bytes.size();
    bytes.resize(place + size);
    if (size > 0) std::memcpy(bytes.data() + place, from, size);
}

void append(std::vector<char>& bytes, const UnitPart& one)
{
    const SurfacePart& part = one.part;
    Record record;
    record.number = one.number;
    record.hypothesis = part.hypothesis;
    record.points = part.points;
    record.sampled = part.sampled;
    record.edge = part.edge;
    record.continued = part.continued;
    record.mixed = part.mixed;
    record.some = part.some.size();
    record.squares = part.squares;
    record.smooth_squares = part.smooth_squares;
    record.low = part.box.min;
    record.high = part.box.max;
    append(bytes, &record, sizeof(record));
    append(bytes, part.some.data(), part.some.size() * sizeof(Vec3d));
}

UnitPart take_part(const std::vector<char>& bytes, std::size_t& place)
{
    Record record;
    std::memcpy(&record, bytes.data() + place, sizeof(record));
    place += sizeof(record);
    UnitPart one;
    one.number = record.number;
    SurfacePart& part = one.part;
    part.hypothesis = record.hypothesis;
    part.points = record.points;
    part.sampled = record.sampled;
    part.edge = record.edge;
    part.continued = record.continued;
    part.mixed = record.mixed;
    part.squares = record.squares;
    part.smooth_squares = record.smooth_squares;
    part.box = {record.low, record.high};
    part.some.resize(static_cast<std::size_t>(record.some));
    if (record.some > 0) std::memcpy(part.some.data(), bytes.data() + place, part.some.size() * sizeof(Vec3d));
    place += part.some.size() * sizeof(Vec3d);
    return one;
}

}  // namespace

void add_to(SurfacePart& whole, const SurfacePart& part, std::size_t most_some)
{
    whole.hypothesis = part.hypothesis;
    whole.points += part.points;
    whole.sampled += part.sampled;
    whole.edge += part.edge;
    whole.squares += part.squares;
    whole.smooth_squares += part.smooth_squares;
    whole.continued += part.continued;
    whole.mixed += part.mixed;
    whole.box.extend(part.box);
    whole.some.insert(whole.some.end(), part.some.begin(), part.some.end());
    if (whole.some.size() <= most_some) return;
    std::vector<Vec3d> half;
    for (std::size_t i = 0; i < whole.some.size(); i += 2) half.push_back(whole.some[i]);
    whole.some = std::move(half);
}

std::uint32_t PartNumbers::take(std::size_t count)
{
    const std::uint64_t first = next_.fetch_add(count);
    if (first + count >= interior_label)
        throw Error(ErrorCode::unsupported, {},
                    "the cloud's points lie in more than " + grouped(interior_label - 1) +
                        " connected parts of surfaces, which labels have no room for",
                    "detect in a part of the cloud, or give a larger threshold");
    return static_cast<std::uint32_t>(first);
}

std::uint32_t AssignedPoints::part_of(std::uint32_t label) const
{
    const std::uint32_t number = label - 1;
    const auto found = std::lower_bound(numbers.begin(), numbers.end(), number,
                                        [](const auto& entry, std::uint32_t n) { return entry.first < n; });
    return found == numbers.end() || found->first != number ? no_part : found->second;
}

UnitParts::UnitParts(std::size_t units) : file_(scratch_file("pcm-parts")), units_(units) {}

void UnitParts::add(std::size_t unit, const std::vector<UnitPart>& parts, const NumberPairs& joined)
{
    std::vector<char> bytes;
    for (const UnitPart& one : parts) append(bytes, one);
    Run run{0, bytes.size()};
    {
        const std::lock_guard lock(mutex_);
        run.place = bytes_;
        bytes_ += run.bytes;
        for (const UnitPart& one : parts) numbers_.push_back(one.number);
    }
    if (run.bytes > 0) {
        file_.write_at(bytes.data(), bytes.size(), run.place);
        units_[unit].runs.push_back(run);
    }
    units_[unit].joined.insert(units_[unit].joined.end(), joined.begin(), joined.end());
}

template <class Use>
void UnitParts::for_each(const Use& use) const
{
    std::vector<char> bytes;
    for (const Unit& unit : units_)
        for (const Run& run : unit.runs) {
            bytes.resize(static_cast<std::size_t>(run.bytes));
            file_.read_at(bytes.data(), bytes.size(), run.place);
            for (std::size_t place = 0; place < bytes.size();) use(take_part(bytes, place));
        }
}

AssignedPoints UnitParts::together(const BorderCells& border, std::uint64_t least_points, std::uint64_t least_sampled,
                                   std::size_t most_some)
{
    std::sort(numbers_.begin(), numbers_.end());
    const auto index = [&](std::uint32_t number) {
        return static_cast<std::uint32_t>(std::lower_bound(numbers_.begin(), numbers_.end(), number) -
                                          numbers_.begin());
    };
    JoinedLabels joined(numbers_.size());
    border.join([&](std::uint32_t a, std::uint32_t b) { joined.join(index(a), index(b)); }, border_cells);
    for (Unit& unit : units_) {
        for (const auto& [a, b] : unit.joined) joined.join(index(a), index(b));
        NumberPairs().swap(unit.joined);
    }
    struct Count {
        std::uint64_t points = 0, sampled = 0;
    };
    std::vector<Count> counts(numbers_.size());
    for_each([&](const UnitPart& one) {
        Count& count = counts[joined.root(index(one.number))];
        count.points += one.part.points;
        count.sampled += one.part.sampled;
    });
    const auto wanted = [&](std::uint32_t root) {
        return counts[root].points >= least_points && counts[root].sampled >= least_sampled;
    };
    AssignedPoints assigned;
    std::vector<std::uint32_t> place(numbers_.size(), no_place);
    for_each([&](const UnitPart& one) {
        const std::uint32_t root = joined.root(index(one.number));
        if (!wanted(root)) return;
        if (place[root] == no_place) {
            place[root] = static_cast<std::uint32_t>(assigned.parts.size());
            assigned.parts.emplace_back();
        }
        add_to(assigned.parts[place[root]], one.part, most_some);
    });
    for (std::uint32_t i = 0; i < numbers_.size(); ++i)
        if (place[joined.root(i)] != no_place) assigned.numbers.push_back({numbers_[i], place[joined.root(i)]});
    return assigned;
}

}  // namespace pcm
