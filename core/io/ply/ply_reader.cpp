#include "pcm/io/ply/ply_reader.h"

#include "pcm/io/file_text.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/io/ply/byte_stream.h"
#include "pcm/io/ply/ply_header.h"
#include "pcm/io/ply/ply_notes.h"
#include "pcm/io/records/carried_comments.h"
#include "pcm/io/records/line_stream.h"
#include "pcm/io/records/line_words.h"
#include "pcm/io/records/scalars.h"
#include "pcm/io/unique_name.h"
#include "pcm/system/file.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

namespace pcm {
namespace {

// Names that mean three components.
bool means_three(std::string_view name) { return name == attribute_name::rgb || name == attribute_name::normal; }

constexpr auto no_group = static_cast<std::size_t>(-1);

// The destination of a scalar property.
struct Target {
    int axis = -1;              // 0, 1, 2: a coordinate
    std::size_t attribute = 0;  // otherwise: the attribute
    std::size_t byte = 0;       // first byte among the attribute's bytes of a point
    ScalarType type = ScalarType::f32;
    std::size_t offset = 0;  // in a record
};

class PlyReader final : public PointReader {
public:
    explicit PlyReader(const std::filesystem::path& path)
        : file_(path, File::Mode::read), file_size_(file_.size()), header_(read_ply_header(file_))
    {
        find_vertices();
        plan();
        check_bytes_hold_the_points();
        info_.format = format_name(header_);
        for (std::string& note : other_elements(header_, vertex_element_)) info_.notes.push_back(std::move(note));
        if (addressable_) note_surplus(file_size_ - vertex_offset_ - vertices().count * vertices().least_bytes());
        batch_points_ = points_that_fit_a_batch(info_.schema);
    }

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return addressable_; }
    void seek(std::uint64_t index) override;
    double fraction_read() const override;

private:
    [[noreturn]] void fail(ErrorCode code, const std::string& what) const { throw Error(code, file_.path(), what); }
    [[noreturn]] void fail_line(ErrorCode code, const std::string& what) const
    {
        fail(code, "line " + std::to_string(lines_->line_number()) + ": " + what);
    }
    [[noreturn]] void fail_header(const std::string& what) const
    {
        fail(ErrorCode::bad_format, "the header, lines 1 to " + std::to_string(header_.lines) + ", " + what);
    }
    bool ascii() const { return header_.encoding == PlyHeader::Encoding::ascii; }
    const PlyElement& vertices() const { return header_.elements[vertex_element_]; }

    void find_vertices();
    void find_axes();
    void plan();
    std::string name_of_single(const PlyProperty& property) const;
    bool plan_group(const std::array<const char*, 3>& members, std::string_view name);
    void plan_carried(const CarriedAttribute& carried);
    void add_attribute(Attribute attribute);
    void check_bytes_hold_the_points();
    void note_surplus(std::uint64_t bytes);

    void start();
    std::uint64_t take_list_length(const PlyProperty& list, const std::string& owner);
    void read_lists_of(const PlyElement& element, std::uint64_t instance, std::byte* record);
    void read_line(std::byte* record);
    void unpack(const std::byte* records, std::size_t count, PointBatch& batch, std::size_t first) const;
    template <bool Swap>
    void unpack(const std::byte* records, std::size_t count, PointBatch& batch, std::size_t first) const;

    File file_;
    std::uint64_t file_size_;
    PlyHeader header_;
    FileInfo info_;
    std::size_t vertex_element_ = 0;
    // Properties that together are one attribute: three of a colour, or as a comment describes.
    struct Group {
        Attribute attribute;
        std::size_t index = max_attributes;  // in the schema, once added
    };
    std::vector<Group> groups_;
    std::vector<std::size_t> group_of_;  // for each property; or no_group
    std::vector<Target> targets_;        // of the scalar properties of a vertex, in file order
    std::size_t record_bytes_ = 0;       // bytes of all targets
    bool addressable_ = false;           // binary, without lists in the vertices and before them
    std::uint64_t vertex_offset_ = 0;    // when addressable
    std::size_t batch_points_ = 1;

    std::uint64_t next_ = 0;
    bool started_ = false, surplus_noted_ = false;
    std::optional<ByteStream> bytes_;  // binary, not addressable
    std::optional<LineStream> lines_;  // ascii
    std::vector<std::byte> buffer_;
};

void PlyReader::find_vertices()
{
    const std::size_t none = header_.elements.size();
    vertex_element_ = none;
    for (std::size_t i = 0; i < none; ++i) {
        if (header_.elements[i].name != "vertex") continue;
        if (vertex_element_ != none) fail_header("has two elements 'vertex', one was expected");
        vertex_element_ = i;
    }
    if (vertex_element_ == none) {
        std::string found;
        for (std::size_t i = 0; i < std::min<std::size_t>(none, 8); ++i)
            found += (found.empty() ? "" : ", ") + quote_bytes(header_.elements[i].name);
        fail_header("has no element 'vertex', which holds the points; found " + (found.empty() ? "none" : found));
    }
}

// Marks the three properties as components of the attribute `name` if each exists once and all have the same type.
bool PlyReader::plan_group(const std::array<const char*, 3>& members, std::string_view name)
{
    const std::vector<PlyProperty>& properties = vertices().properties;
    std::array<std::size_t, 3> at{};
    for (std::size_t c = 0; c < 3; ++c) {
        std::size_t found = properties.size();
        for (std::size_t i = 0; i < properties.size(); ++i)
            if (!properties[i].is_list && group_of_[i] == no_group && lower_case(properties[i].name) == members[c]) {
                if (found != properties.size()) return false;
                found = i;
            }
        if (found == properties.size()) return false;
        at[c] = found;
    }
    const ScalarType type = properties[at[0]].type;
    if (type != properties[at[1]].type || type != properties[at[2]].type) return false;
    for (std::size_t c = 0; c < 3; ++c) {
        group_of_[at[c]] = groups_.size();
        targets_[at[c]].byte = c * size_of(type);
    }
    groups_.push_back({{std::string(name), type, 3, 1, 0, {}}});
    return true;
}

// Marks the properties that a comment joins to one attribute, if they agree with the comment.
void PlyReader::plan_carried(const CarriedAttribute& carried)
{
    const std::vector<PlyProperty>& properties = vertices().properties;
    const Attribute& attribute = carried.attribute;
    const bool halves = attribute.type == ScalarType::i64 || attribute.type == ScalarType::u64;
    const std::uint64_t count = std::uint64_t{attribute.components} * (halves ? 2 : 1);
    const auto begins = [&](const PlyProperty& p) { return !p.is_list && p.name == carried.field; };
    const auto first =
        static_cast<std::size_t>(std::find_if(properties.begin(), properties.end(), begins) - properties.begin());
    bool fits = count <= properties.size() - first;
    for (std::size_t k = 0; fits && k < count; ++k) {
        const PlyProperty& property = properties[first + k];
        const bool same = halves ? property.type == ScalarType::u32 || property.type == ScalarType::i32
                                 : property.type == attribute.type;
        fits = same && !property.is_list && targets_[first + k].axis < 0 && group_of_[first + k] == no_group;
    }
    if (!fits) {
        info_.notes.push_back("a comment about the attribute '" + attribute.name +
                              "' is ignored: the properties do not agree with it");
        return;
    }
    for (std::size_t k = 0; k < count; ++k) {
        group_of_[first + k] = groups_.size();
        targets_[first + k].byte = k * size_of(properties[first + k].type);
    }
    groups_.push_back({attribute});
}

void PlyReader::add_attribute(Attribute attribute)
{
    if (info_.schema.size() == max_attributes)
        fail(ErrorCode::unsupported, "the vertices have more than " + std::to_string(max_attributes) + " properties");
    attribute.name = unique_name(info_.schema, attribute.name);
    info_.schema.add(std::move(attribute));
}

void PlyReader::find_axes()
{
    const std::vector<PlyProperty>& properties = vertices().properties;
    std::array<bool, 3> have{};
    for (std::size_t i = 0; i < properties.size(); ++i) {
        const std::string name = lower_case(properties[i].name);
        if (properties[i].is_list || name.size() != 1 || name[0] < 'x' || name[0] > 'z') continue;
        const int axis = name[0] - 'x';
        if (std::exchange(have[static_cast<std::size_t>(axis)], true))
            fail_header("gives the vertices two properties '" + name + "'");
        targets_[i].axis = axis;
    }
    for (std::size_t a = 0; a < 3; ++a)
        if (!have[a]) fail_header("gives the vertices no property '" + std::string(1, "xyz"[a]) + "'");
}

// The attribute's name for a property that belongs to no group.
std::string PlyReader::name_of_single(const PlyProperty& property) const
{
    const auto has_scalar = [&](std::string_view name) {
        return std::any_of(vertices().properties.begin(), vertices().properties.end(),
                           [&](const PlyProperty& p) { return !p.is_list && p.name == name; });
    };
    std::string name = property.name;
    if (means_three(name)) name += "_scalar";
    if (name == "scalar_intensity" && !has_scalar(attribute_name::intensity)) name = attribute_name::intensity;
    // A name that a group will need later is not free.
    const auto needed = [&](const Group& group) { return group.attribute.name == name; };
    while (std::any_of(groups_.begin(), groups_.end(), needed)) name += "_scalar";
    return name;
}

void PlyReader::plan()
{
    const std::vector<PlyProperty>& properties = vertices().properties;
    targets_.assign(properties.size(), {});
    group_of_.assign(properties.size(), no_group);
    find_axes();

    const Carried carried = read_carried_comments(header_.comments, info_.notes);
    info_.metadata = carried.metadata;
    for (const CarriedAttribute& attribute : carried.attributes) plan_carried(attribute);

    using Names = std::array<const char*, 3>;
    for (const Names& members :
         {Names{"red", "green", "blue"}, Names{"diffuse_red", "diffuse_green", "diffuse_blue"}, Names{"r", "g", "b"}})
        if (plan_group(members, attribute_name::rgb)) break;
    for (const Names& members : {Names{"nx", "ny", "nz"}, Names{"normal_x", "normal_y", "normal_z"}})
        if (plan_group(members, attribute_name::normal)) break;

    bool all_f32 = true;
    std::vector<Target> scalars;
    for (std::size_t i = 0; i < properties.size(); ++i) {
        const PlyProperty& property = properties[i];
        if (property.is_list) {
            info_.notes.push_back("the list '" + property.name + "' of the vertices is ignored");
            continue;
        }
        Target target = targets_[i];
        target.type = property.type;
        target.offset = record_bytes_;
        record_bytes_ += size_of(property.type);
        if (target.axis >= 0) {
            all_f32 = all_f32 && property.type == ScalarType::f32;
        } else if (group_of_[i] != no_group) {
            Group& group = groups_[group_of_[i]];
            if (group.index == max_attributes) {
                group.index = info_.schema.size();
                if (means_three(group.attribute.name) && group.attribute.components != 3)
                    group.attribute.name += "_scalar";
                add_attribute(group.attribute);
            }
            target.attribute = group.index;
        } else {
            target.attribute = info_.schema.size();
            add_attribute({name_of_single(property), property.type, 1, 1, 0, {}});
        }
        scalars.push_back(target);
    }
    targets_ = std::move(scalars);
    info_.position_type = all_f32 ? ScalarType::f32 : ScalarType::f64;
    info_.points = vertices().count;
}

// Checks sizes as far as possible without reading lists and lines.
void PlyReader::check_bytes_hold_the_points()
{
    addressable_ = !ascii();
    std::uint64_t offset = header_.bytes;
    for (std::size_t i = 0; i <= vertex_element_; ++i) {
        const PlyElement& element = header_.elements[i];
        // In ascii a number takes a digit and a separator; the last one of the file may have none.
        const std::uint64_t least = ascii() ? 2 * element.properties.size() : element.least_bytes();
        const std::uint64_t left = file_size_ - std::min(offset, file_size_) + (ascii() ? 1 : 0);
        if (i == vertex_element_) vertex_offset_ = offset;
        if (least && element.count > left / least)
            fail(ErrorCode::truncated,
                 "the header promises " + std::to_string(element.count) + " instances of '" + element.name +
                     "' of at least " + std::to_string(least) + " bytes; from byte " + std::to_string(offset) +
                     " to the end of the file there are " + std::to_string(file_size_ - std::min(offset, file_size_)));
        offset += element.count * least;
        if (element.has_lists()) addressable_ = false;
    }
}

void PlyReader::note_surplus(std::uint64_t bytes)
{
    if (std::exchange(surplus_noted_, true)) return;
    const auto note =
        ascii() ? surplus_lines(header_, vertex_element_, *lines_) : surplus_bytes(header_, vertex_element_, bytes);
    if (note) info_.notes.push_back(*note);
}

// Skips the elements before the vertices.
void PlyReader::start()
{
    started_ = true;
    if (ascii()) {
        lines_.emplace(file_, header_.bytes, header_.lines, header_.ends_lines_with_cr ? '\r' : '\n');
        for (std::size_t e = 0; e < vertex_element_; ++e) {
            const PlyElement& element = header_.elements[e];
            std::string_view line;
            for (std::uint64_t i = 0; !element.properties.empty() && i < element.count; ++i)
                if (!lines_->next(line))
                    fail_line(ErrorCode::truncated, "the file ends after " + std::to_string(i) + " of " +
                                                        std::to_string(element.count) + " lines of '" + element.name +
                                                        "'");
        }
        return;
    }
    if (addressable_) return;
    bytes_.emplace(file_, header_.bytes, file_size_);
    for (std::size_t e = 0; e < vertex_element_; ++e) {
        const PlyElement& element = header_.elements[e];
        if (!element.has_lists())
            bytes_->skip(element.count * element.least_bytes());
        else
            for (std::uint64_t i = 0; i < element.count; ++i) read_lists_of(element, i, nullptr);
    }
}

std::uint64_t PlyReader::take_list_length(const PlyProperty& list, const std::string& owner)
{
    std::array<std::byte, 8> raw{};
    const std::uint64_t at = bytes_->position();
    bytes_->take(raw.data(), size_of(list.count_type));
    const bool swap = header_.encoding == PlyHeader::Encoding::big_endian;
    return with_type(list.count_type, [&](auto example) {
        using T = decltype(example);
        const T length = swap ? load_scalar<T, true>(raw.data()) : load_scalar<T, false>(raw.data());
        if (length < T{0})
            fail(ErrorCode::bad_format, "byte " + std::to_string(at) + ": the list '" + list.name + "' of " + owner +
                                            " has " + std::to_string(length) + " entries");
        return static_cast<std::uint64_t>(length);
    });
}

// Reads one binary instance; its scalars are stored consecutively in `record`, unless that is null.
void PlyReader::read_lists_of(const PlyElement& element, std::uint64_t instance, std::byte* record)
{
    for (const PlyProperty& property : element.properties) {
        const std::size_t bytes = size_of(property.type);
        if (property.is_list) {
            const std::uint64_t length = take_list_length(property, element.name + " " + std::to_string(instance));
            // An impossible length must not overflow to a possible one.
            bytes_->skip(length > bytes_->left() ? length : length * bytes);
        } else if (record) {
            bytes_->take(record, bytes);
            record += bytes;
        } else {
            bytes_->skip(bytes);
        }
    }
}

// Reads one ascii vertex; stores its scalars in `record` as in a little endian file.
void PlyReader::read_line(std::byte* record)
{
    std::string_view line;
    if (!lines_->next(line))
        fail_line(ErrorCode::truncated,
                  "the file ends after " + std::to_string(next_) + " of " + std::to_string(info_.points) + " vertices");
    LineWords words(line);
    std::string_view word;
    const auto ends_before = [&](const PlyProperty& property) {
        fail_line(ErrorCode::bad_format,
                  "found " + quote_bytes(line) + ", which ends before the property '" + property.name + "'");
    };
    for (const PlyProperty& property : vertices().properties) {
        if (property.is_list) {
            std::uint64_t length = 0;
            if (!words.next_number(ScalarType::u64, reinterpret_cast<std::byte*>(&length), word)) {
                if (word.empty()) ends_before(property);
                fail_line(ErrorCode::bad_format,
                          "found " + quote_bytes(word) + ", expected the length of the list '" + property.name + "'");
            }
            for (std::uint64_t i = 0; i < length; ++i)
                if (words.next().empty()) ends_before(property);
            continue;
        }
        if (!words.next_number(property.type, record, word)) {
            if (word.empty()) ends_before(property);
            fail_line(ErrorCode::bad_format, "found " + quote_bytes(word) + " for the property '" + property.name +
                                                 "', expected a number of type " + std::string(name_of(property.type)));
        }
        record += size_of(property.type);
    }
    if (const std::string_view more = words.next(); !more.empty())
        fail_line(ErrorCode::bad_format,
                  "found " + quote_bytes(more) + " after the last property, expected the end of the line");
}

template <bool Swap>
void PlyReader::unpack(const std::byte* records, std::size_t count, PointBatch& batch, std::size_t first) const
{
    for (const Target& target : targets_) {
        const std::byte* from = records + target.offset;
        if (target.axis >= 0) {
            double* to = batch.xyz[static_cast<std::size_t>(target.axis)].data() + first;
            with_type(target.type,
                      [&](auto example) { widen<decltype(example), Swap>(from, record_bytes_, count, to); });
            continue;
        }
        Column& column = batch.attributes[target.attribute];
        const std::size_t stride = column.point_bytes();
        std::byte* to = column.data() + first * stride + target.byte;
        copy_scalars<Swap>(size_of(target.type), from, record_bytes_, count, to, stride);
    }
}

void PlyReader::unpack(const std::byte* records, std::size_t count, PointBatch& batch, std::size_t first) const
{
    if (header_.encoding == PlyHeader::Encoding::big_endian)
        unpack<true>(records, count, batch, first);
    else
        unpack<false>(records, count, batch, first);
}

bool PlyReader::read(PointBatch& batch, std::size_t max_points)
{
    if (!started_) start();
    const auto count = static_cast<std::size_t>(
        std::min<std::uint64_t>(info_.points - next_, std::min(std::max<std::size_t>(max_points, 1), batch_points_)));
    shape_batch(batch, info_.schema, false, count);
    if (count == 0) {
        note_surplus(bytes_ ? bytes_->left() : 0);
        return false;
    }

    // Small enough to stay in the cache while its fields are decoded, unless it must be read from the file.
    const std::size_t buffer_bytes = std::size_t{1} << (addressable_ ? 18 : 14);
    const std::size_t buffer_points = std::max<std::size_t>(1, buffer_bytes / record_bytes_);
    buffer_.resize(buffer_points * record_bytes_);
    for (std::size_t done = 0; done < count;) {
        const std::size_t now = std::min(buffer_points, count - done);
        if (addressable_) {
            file_.read_at(buffer_.data(), now * record_bytes_, vertex_offset_ + next_ * record_bytes_);
            next_ += now;
        } else {
            for (std::size_t i = 0; i < now; ++i, ++next_) {
                std::byte* record = buffer_.data() + i * record_bytes_;
                if (ascii())
                    read_line(record);
                else
                    read_lists_of(vertices(), next_, record);
            }
        }
        unpack(buffer_.data(), now, batch, done);
        done += now;
    }
    return true;
}

void PlyReader::seek(std::uint64_t index)
{
    if (!addressable_) return PointReader::seek(index);
    if (index > info_.points)
        fail(ErrorCode::invalid_argument,
             "point " + std::to_string(index) + " was requested, the file has " + std::to_string(info_.points));
    next_ = index;
}

double PlyReader::fraction_read() const
{
    if (next_ == info_.points) return 1.0;
    if (addressable_) return static_cast<double>(next_) / static_cast<double>(info_.points);
    const std::uint64_t consumed = lines_ ? lines_->bytes_consumed() : bytes_ ? bytes_->position() : 0;
    return file_size_ ? static_cast<double>(consumed) / static_cast<double>(file_size_) : 1.0;
}

}  // namespace

std::unique_ptr<PointReader> open_ply(const std::filesystem::path& path, const ReadOptions&)
{
    return std::make_unique<PlyReader>(path);
}

bool ply_only_points(const std::filesystem::path& path)
{
    const PlyHeader header = read_ply_header(File(path, File::Mode::read));
    return std::all_of(header.elements.begin(), header.elements.end(),
                       [](const PlyElement& element) { return element.name == "vertex" || element.count == 0; });
}

}  // namespace pcm
