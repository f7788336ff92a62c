#include "pcm/io/e57/e57_reader.h"

#include "pcm/cloud/vector.h"
#include "pcm/io/e57/e57_fields.h"
#include "pcm/io/e57/e57_file.h"
#include "pcm/io/e57/e57_packets.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace pcm {
namespace {

// Few enough that the numbers of all fields stay in the cache, many enough to amortise the work per packet.
constexpr std::size_t piece_points = 4096;
constexpr std::size_t most_fields = 1000;
constexpr std::size_t most_metadata_bytes = std::size_t{4} << 20;
constexpr std::size_t most_described_scans = 10000;

// The rotation matrix of a unit quaternion w x y z, and the translation.
struct Pose {
    std::array<Vec3d, 3> rows{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
    Vec3d translation{0, 0, 0};
    bool turns = false, moves = false;

    Vec3d operator()(const Vec3d& p) const
    {
        Vec3d q = p;
        if (turns)
            for (std::size_t a = 0; a < 3; ++a) q[a] = dot(rows[a], p);
        if (moves)
            for (std::size_t a = 0; a < 3; ++a) q[a] += translation[a];
        return q;
    }
};

class E57Reader final : public PointReader {
public:
    explicit E57Reader(const std::filesystem::path& path);

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    double fraction_read() const override
    {
        return records_ ? static_cast<double>(records_read_) / static_cast<double>(records_) : 1.0;
    }

private:
    // The raw numbers of one field for the current points.
    struct Numbers {
        std::vector<std::int64_t> integers;
        std::vector<double> floats;
    };

    void describe();
    void keep_metadata();
    Pose pose_of(std::size_t scan) const;
    void check_promises();
    void begin_scan();
    // Reads up to `most` records; stores the valid ones in the batch from `first` on. Returns their number.
    std::size_t read_piece(PointBatch& batch, std::size_t first, std::size_t most);
    double value(std::size_t field, std::size_t point) const;
    void find_valid(std::size_t count);
    void store(const E57Target& target, PointBatch& batch, std::size_t first);
    void note_what_was_dropped();

    E57Pages pages_;
    E57Description description_;
    E57Plan plan_;
    FileInfo info_;
    std::uint64_t records_ = 0, records_read_ = 0;
    std::size_t batch_points_;

    std::size_t scan_ = 0;  // the current one
    std::uint64_t scan_read_ = 0;
    std::optional<E57Packets> packets_;
    std::vector<std::size_t> missing_;  // attributes without a field in it
    std::vector<Pose> poses_;           // poses of all scans
    std::vector<Numbers> numbers_;
    std::vector<std::uint32_t> valid_;     // indices of the current points with a position
    std::vector<std::uint8_t> spherical_;  // for each of these, whether the position is spherical
    std::uint64_t dropped_ = 0, clamped_ = 0;
    bool noted_ = false;
};

E57Reader::E57Reader(const std::filesystem::path& path)
    : pages_(path), description_(describe_e57(pages_)), plan_(plan_e57(path, description_.scans))
{
    describe();
    keep_metadata();
    check_promises();
    batch_points_ = points_that_fit_a_batch(info_.schema);
}

void E57Reader::describe()
{
    const std::size_t scans = description_.scans.size();
    info_.format = "E57 1.0, " + std::to_string(scans) + (scans == 1 ? " scan" : " scans");
    info_.schema = plan_.schema;
    info_.notes = plan_.notes;
    bool all_f32 = true, all_boxes = true;
    std::size_t null_rotations = 0;
    Box3d box;
    for (std::size_t i = 0; i < scans; ++i) {
        const E57Scan& scan = description_.scans[i];
        const E57ScanPlan& plan = plan_.scans[i];
        if (scan.fields.size() > most_fields)
            throw Error(ErrorCode::unsupported, pages_.file().path(),
                        scan.called(i) + " has " + std::to_string(scan.fields.size()) + " fields, at most " +
                            std::to_string(most_fields) + " can be read");
        if (scan.records > std::numeric_limits<std::uint64_t>::max() - records_)
            throw Error(ErrorCode::bad_format, pages_.file().path(), "the scans promise more than 2^64 points");
        records_ += scan.records;
        poses_.push_back(pose_of(i));
        const Pose& pose = poses_.back();
        null_rotations += scan.has_pose && scan.rotation == std::array<double, 4>{0, 0, 0, 0};
        if (scan.records == 0) continue;
        if (plan.cartesian_state || plan.spherical_state) info_.points_known = false;
        const bool moved = pose.turns || pose.moves || !plan.cartesian || plan.spherical;
        for (std::size_t k = 0; !moved && k < 3; ++k)
            all_f32 = all_f32 && scan.fields[(*plan.cartesian)[k]].kind == E57Field::Kind::f32;
        all_f32 = all_f32 && !moved;
        all_boxes = all_boxes && !pose.turns && !pose.moves && scan.box && !scan.box->empty();
        if (all_boxes) box.extend(*scan.box);
    }
    if (null_rotations)
        info_.notes.push_back("the quaternion of " + grouped(null_rotations) +
                              (null_rotations == 1 ? " scan" : " scans") + " is 0 0 0 0: read as no rotation");
    info_.points = records_;
    info_.position_type = all_f32 && records_ ? ScalarType::f32 : ScalarType::f64;
    if (all_boxes && records_) info_.promised_box = box;
    if (description_.images)
        info_.notes.push_back(grouped(description_.images) + (description_.images == 1 ? " picture" : " pictures") +
                              " ignored: only the points are read");
}

namespace {

std::string text_of_pose(const E57Scan& scan)
{
    std::string text;
    for (const double v : scan.translation) text += exact(v) + " ";
    for (const double v : scan.rotation) text += exact(v) + " ";
    text.pop_back();
    return text;
}

}  // namespace

void E57Reader::keep_metadata()
{
    const auto keep = [&](const std::string& key, const std::string& text) {
        if (text.empty()) return;
        const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
        info_.metadata.push_back({key, {bytes, bytes + text.size()}});
    };
    if (description_.xml.size() <= most_metadata_bytes)
        keep("e57.xml", description_.xml);
    else
        info_.notes.push_back("the XML section of " + bytes_text(description_.xml.size()) +
                              " is not kept as metadata: it is larger than " + bytes_text(most_metadata_bytes));
    std::string().swap(description_.xml);
    if (description_.coordinate_metadata.size() <= most_metadata_bytes)
        keep("e57.coordinateMetadata", description_.coordinate_metadata);
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < std::min(description_.scans.size(), most_described_scans); ++i) {
        const E57Scan& scan = description_.scans[i];
        bytes += scan.name.size() + scan.guid.size();
        if (bytes > most_metadata_bytes) break;
        keep("e57.scan/" + std::to_string(i + 1) + "/name", scan.name);
        keep("e57.scan/" + std::to_string(i + 1) + "/guid", scan.guid);
        if (scan.has_pose) keep("e57.scan/" + std::to_string(i + 1) + "/pose", text_of_pose(scan));
    }
}

Pose E57Reader::pose_of(std::size_t index) const
{
    const E57Scan& scan = description_.scans[index];
    Pose pose;
    if (!scan.has_pose) return pose;
    for (const double number : scan.rotation)
        if (!std::isfinite(number))
            throw Error(ErrorCode::bad_format, pages_.file().path(),
                        scan.called(index) + ": its pose has a rotation that is not finite");
    for (const double number : scan.translation)
        if (!std::isfinite(number))
            throw Error(ErrorCode::bad_format, pages_.file().path(),
                        scan.called(index) + ": its pose has a translation that is not finite");
    pose.translation = scan.translation;
    pose.moves = scan.translation != Vec3d{0, 0, 0};

    // Divided by the largest first: squares of tiny and huge numbers would underflow or overflow.
    double largest = 0;
    for (const double number : scan.rotation) largest = std::max(largest, std::abs(number));
    if (largest == 0) return pose;  // 0 0 0 0 is read as no rotation; describe() notes it
    std::array<double, 4> q = scan.rotation;
    double squares = 0;
    for (double& number : q) {
        number /= largest;
        squares += number * number;
    }
    for (double& number : q) number /= std::sqrt(squares);
    const auto [w, x, y, z] = q;
    pose.turns = x != 0 || y != 0 || z != 0;
    pose.rows = {Vec3d{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                 Vec3d{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                 Vec3d{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    return pose;
}

// Checks all scans before the first is read: together they must fit in the file, so no two may share their points.
void E57Reader::check_promises()
{
    double bytes = 0;
    for (scan_ = 0; scan_ < description_.scans.size(); ++scan_) {
        begin_scan();
        double bits = 0;
        for (const E57Field& field : description_.scans[scan_].fields) bits += field.bits();
        bytes += static_cast<double>(description_.scans[scan_].records) * (bits > 0 ? bits / 8 : 1);
        if (bytes > static_cast<double>(pages_.physical_size()))
            throw Error(ErrorCode::bad_format, pages_.file().path(),
                        "the scans up to " + description_.scans[scan_].called(scan_) + " promise points of " +
                            exact(std::ceil(bytes)) + " bytes, the file has " + std::to_string(pages_.physical_size()));
    }
    scan_ = 0;
    packets_.reset();
}

void E57Reader::begin_scan()
{
    packets_.emplace(pages_, description_.scans[scan_], description_.scans[scan_].called(scan_));
    scan_read_ = 0;
    std::vector<bool> has(info_.schema.size());
    for (const E57Target& target : plan_.scans[scan_].targets) has[target.attribute] = true;
    missing_.clear();
    for (std::size_t i = 0; i < has.size(); ++i)
        if (!has[i] && i != plan_.scan_number) missing_.push_back(i);
}

double E57Reader::value(std::size_t field, std::size_t point) const
{
    const E57Field& f = description_.scans[scan_].fields[field];
    if (f.kind != E57Field::Kind::integer) return numbers_[field].floats[point];
    return static_cast<double>(numbers_[field].integers[point]) * f.scale + f.offset;
}

void E57Reader::find_valid(std::size_t count)
{
    const E57ScanPlan& plan = plan_.scans[scan_];
    valid_.clear();
    spherical_.clear();
    for (std::size_t i = 0; i < count; ++i) {
        const bool cartesian = plan.cartesian && (!plan.cartesian_state || value(*plan.cartesian_state, i) == 0);
        if (!cartesian && !(plan.spherical && (!plan.spherical_state || value(*plan.spherical_state, i) == 0)))
            continue;
        valid_.push_back(static_cast<std::uint32_t>(i));
        spherical_.push_back(!cartesian);
    }
    dropped_ += count - valid_.size();
}

template <class T>
T limited(std::int64_t value, bool& inside)
{
    constexpr auto low = std::numeric_limits<T>::min(), high = std::numeric_limits<T>::max();
    inside = value >= static_cast<std::int64_t>(low) && value <= static_cast<std::int64_t>(high);
    return inside ? static_cast<T>(value) : value < 0 ? low : high;
}

void E57Reader::store(const E57Target& target, PointBatch& batch, std::size_t first)
{
    Column& column = batch.attributes[target.attribute];
    const std::size_t components = column.components();
    const auto put_integers = [&](auto example) {
        using T = decltype(example);
        T* to = column.as<T>() + first * components + target.component;
        const std::int64_t* from = numbers_[target.field].integers.data();
        for (const std::uint32_t i : valid_) {
            bool inside = true;
            *to = target.widened ? static_cast<T>(limited<std::uint8_t>(from[i], inside) * 257)
                                 : limited<T>(from[i], inside);
            clamped_ += !inside;
            to += components;
        }
    };
    const auto put_floats = [&](auto example) {
        using T = decltype(example);
        T* to = column.as<T>() + first * components + target.component;
        for (const std::uint32_t i : valid_) {
            *to = static_cast<T>(value(target.field, i) * target.factor);
            to += components;
        }
    };
    switch (column.type()) {
        case ScalarType::i8:
            return put_integers(std::int8_t{});
        case ScalarType::u8:
            return put_integers(std::uint8_t{});
        case ScalarType::i16:
            return put_integers(std::int16_t{});
        case ScalarType::u16:
            return put_integers(std::uint16_t{});
        case ScalarType::i32:
            return put_integers(std::int32_t{});
        case ScalarType::u32:
            return put_integers(std::uint32_t{});
        case ScalarType::i64:
            return put_integers(std::int64_t{});
        case ScalarType::f32:
            return put_floats(float{});
        default:
            return put_floats(double{});
    }
}

std::size_t E57Reader::read_piece(PointBatch& batch, std::size_t first, std::size_t most)
{
    const E57Scan& scan = description_.scans[scan_];
    const E57ScanPlan& plan = plan_.scans[scan_];
    const auto count =
        static_cast<std::size_t>(std::min<std::uint64_t>({most, piece_points, scan.records - scan_read_}));
    packets_->prepare(count);
    numbers_.resize(std::max(numbers_.size(), scan.fields.size()));
    for (std::size_t f = 0; f < scan.fields.size(); ++f) {
        Numbers& numbers = numbers_[f];
        if (scan.fields[f].kind == E57Field::Kind::integer) {
            numbers.integers.resize(count);
            packets_->integers(f, numbers.integers.data());
        } else {
            numbers.floats.resize(count);
            packets_->floats(f, numbers.floats.data());
        }
    }
    scan_read_ += count;
    records_read_ += count;

    find_valid(count);
    for (std::size_t k = 0; k < valid_.size(); ++k) {
        const std::size_t i = valid_[k];
        Vec3d p;
        if (spherical_[k]) {
            const double range = value((*plan.spherical)[0], i), azimuth = value((*plan.spherical)[1], i);
            const double elevation = value((*plan.spherical)[2], i), flat = range * std::cos(elevation);
            p = {flat * std::cos(azimuth), flat * std::sin(azimuth), range * std::sin(elevation)};
        } else {
            for (std::size_t a = 0; a < 3; ++a) p[a] = value((*plan.cartesian)[a], i);
        }
        p = poses_[scan_](p);
        for (std::size_t a = 0; a < 3; ++a) batch.xyz[a][first + k] = p[a];
    }
    for (const E57Target& target : plan.targets) store(target, batch, first);
    for (const std::size_t attribute : missing_) {
        Column& column = batch.attributes[attribute];
        std::memset(column.data() + first * column.point_bytes(), 0, valid_.size() * column.point_bytes());
    }
    if (plan_.scan_number) {
        auto* const to = batch.attributes[*plan_.scan_number].as<std::uint32_t>() + first;
        std::fill(to, to + valid_.size(), static_cast<std::uint32_t>(scan_ + 1));
    }
    return valid_.size();
}

void E57Reader::note_what_was_dropped()
{
    if (noted_) return;
    noted_ = true;
    if (dropped_)
        info_.notes.push_back(grouped(dropped_) + " of " + grouped(records_) +
                              " points dropped: the file marks their positions as invalid");
    if (clamped_)
        info_.notes.push_back(grouped(clamped_) +
                              " colour values were outside the file's stated range and were clamped");
}

bool E57Reader::read(PointBatch& batch, std::size_t max_points)
{
    const auto most = static_cast<std::size_t>(std::min<std::uint64_t>(
        records_ - records_read_, std::min(std::max<std::size_t>(max_points, 1), batch_points_)));
    shape_batch(batch, info_.schema, false, most);
    std::size_t got = 0;
    while (got < most && records_read_ < records_) {
        if (packets_ && scan_read_ == description_.scans[scan_].records) {
            packets_.reset();
            ++scan_;
        }
        if (!packets_) begin_scan();
        if (description_.scans[scan_].records > scan_read_) got += read_piece(batch, got, most - got);
    }
    batch.resize(got);
    if (records_read_ == records_) note_what_was_dropped();
    return got > 0;
}

}  // namespace

std::unique_ptr<PointReader> open_e57(const std::filesystem::path& path, const ReadOptions&)
{
    return std::make_unique<E57Reader>(path);
}

}  // namespace pcm
