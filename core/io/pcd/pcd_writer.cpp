#include "pcm/io/pcd/pcd_writer.h"

#include "pcm/io/file_text.h"
#include "pcm/io/pcd/pcd_header.h"
#include "pcm/io/records/carried_comments.h"
#include "pcm/io/records/line_words.h"
#include "pcm/io/records/record_encoder.h"
#include "pcm/system/output_file.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace pcm {
namespace {

struct Field {
    std::string name;
    char kind = 'F';
    std::size_t size = 4;
    std::uint32_t count = 1;
};

char kind_of(ScalarType type)
{
    switch (type) {
        case ScalarType::f32:
        case ScalarType::f64:
            return 'F';
        case ScalarType::i8:
        case ScalarType::i16:
        case ScalarType::i32:
        case ScalarType::i64:
            return 'I';
        default:
            return 'U';
    }
}

// Names with a special meaning for pcd_reader.
bool has_a_meaning(const std::string& lower_name)
{
    static constexpr std::string_view names[] = {"x",        "y",        "z",        "rgb", "rgba",  "red", "green",
                                                 "blue",     "r",        "g",        "b",   "nx",    "ny",  "nz",
                                                 "normal_x", "normal_y", "normal_z", "_",   "normal"};
    return std::find(std::begin(names), std::end(names), lower_name) != std::end(names);
}

class Plan {
public:
    Plan(const FileInfo& cloud, bool ascii)
    {
        const ScalarType position =
            cloud.position_type == ScalarType::f32 && !cloud.grid ? ScalarType::f32 : ScalarType::f64;
        for (std::size_t a = 0; a < 3; ++a) {
            fields.push_back({std::string(1, "xyz"[a]), 'F', size_of(position), 1});
            records.push_back(RecordField::axis(a, position));
        }
        if (position == ScalarType::f64)
            notes.push_back(
                "positions are in double precision (F 8), which PCL's own point types do not read: they need "
                "F 4");
        for (std::size_t i = 0; i < cloud.schema.size(); ++i) i += add(cloud.schema, i, ascii);
    }

    std::vector<Field> fields;
    std::vector<RecordField> records;
    std::vector<CarriedAttribute> carried;
    std::vector<std::string> notes;

private:
    static bool is_plain(const Attribute& attribute)
    {
        return attribute.scale == 1 && attribute.offset == 0 && attribute.description.empty();
    }

    // Returns how many of the following attributes were included.
    std::size_t add(const Schema& schema, std::size_t index, bool ascii)
    {
        const Attribute& attribute = schema[index];
        const std::size_t size = size_of(attribute.type);
        const bool triple = attribute.components == 3;
        std::vector<std::string> names;
        bool plain = is_plain(attribute);
        std::size_t more = 0;
        if (attribute.name == attribute_name::rgb && triple && attribute.type == ScalarType::u8) {
            RecordField packed{RecordField::Source::packed_rgb, ScalarType::u32, index, 0, 1, {}};
            if (index + 1 < schema.size()) {
                const Attribute& alpha = schema[index + 1];
                more =
                    alpha.name == "alpha" && alpha.type == ScalarType::u8 && alpha.components == 1 && is_plain(alpha);
                if (more) packed.alpha = index + 1;
            }
            // As PCL writes it: the bits stored as a float; in text as an integer, because floats would lose bits.
            names = {more ? "rgba" : "rgb"};
            fields.push_back({names[0], more || ascii ? 'U' : 'F', 4, 1});
            records.push_back(packed);
            if (more) used_.insert("alpha");
        } else if (triple && (attribute.name == attribute_name::rgb || attribute.name == attribute_name::normal)) {
            if (attribute.name == attribute_name::rgb) {
                names = {"red", "green", "blue"};
                notes.push_back("colours of type " + std::string(name_of(attribute.type)) +
                                " are kept as fields red, green, blue: PCL shows packed colours of 8 bits");
            } else {
                names = {"normal_x", "normal_y", "normal_z"};
            }
            for (std::size_t c = 0; c < 3; ++c) {
                fields.push_back({names[c], kind_of(attribute.type), size, 1});
                records.push_back(RecordField::scalars(index, c * size, attribute.type));
            }
        } else {
            names = {name_of_field(attribute)};
            plain = plain && pcd_attribute_name(names[0]) == attribute.name;
            fields.push_back({names[0], kind_of(attribute.type), size, attribute.components});
            records.push_back(RecordField::scalars(index, 0, attribute.type, attribute.components));
        }
        for (const std::string& name : names) used_.insert(lower_case(name));
        if (!plain) carried.push_back({names[0], attribute});
        return more;
    }

    std::string name_of_field(const Attribute& attribute) const
    {
        std::string base = field_name(attribute.name);
        if (has_a_meaning(lower_case(base))) base = "attribute_" + base;
        std::string name = base;
        for (int number = 2; used_.count(lower_case(name)); ++number) name = base + "_" + std::to_string(number);
        return name;
    }

    std::set<std::string> used_;  // lower case
};

// The source's viewpoint if it is valid: a translation and a quaternion.
std::string viewpoint_of(std::vector<Metadata>& metadata)
{
    const auto found = std::find_if(metadata.begin(), metadata.end(),
                                    [](const Metadata& block) { return block.key == "pcd.viewpoint"; });
    std::string viewpoint = "0 0 0 1 0 0 0";
    if (found == metadata.end()) return viewpoint;
    const std::string text(reinterpret_cast<const char*>(found->value.data()), found->value.size());
    LineWords words(text);
    std::string_view word;
    double value = 0;
    std::size_t numbers = 0;
    while (words.next_number(ScalarType::f64, reinterpret_cast<std::byte*>(&value), word) && std::isfinite(value))
        ++numbers;
    if (numbers != 7 || !words.at_end() || printable_name(text) != text) return viewpoint;
    metadata.erase(found);
    return text;
}

class PcdWriter final : public PointWriter {
public:
    PcdWriter(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options)
        : ascii_(options.ascii), plan_(cloud, options.ascii), records_(cloud, options, plan_.records), file_(path)
    {
        Carried carried{plan_.carried, cloud.metadata};
        viewpoint_ = viewpoint_of(carried.metadata);
        add_grid(cloud, carried.metadata);
        comments_ = carried_comments(carried, plan_.notes);
        const std::string text = header();
        if (text.size() > longest_pcd_header || records_.record_bytes() > most_pcd_record_bytes)
            throw Error(ErrorCode::invalid_argument, path,
                        "the cloud's attributes need a header of " + std::to_string(text.size()) +
                            " bytes and points of " + std::to_string(records_.record_bytes()) +
                            ", readers take at most " + std::to_string(longest_pcd_header) + " and " +
                            std::to_string(most_pcd_record_bytes));
        file_.append(text);
    }

    void write(const PointBatch& batch) override { records_.append(batch, file_); }
    void finish() override
    {
        const std::string text = header();
        file_.rewrite(text.data(), text.size(), 0);
        file_.finish();
    }
    double position_error() const override { return records_.position_error(); }
    std::vector<std::string> notes() const override { return plan_.notes; }

private:
    // Its length does not depend on the number of points.
    std::string header() const
    {
        const std::string count = std::to_string(records_.points());
        std::string text = "# .PCD v0.7 - Point Cloud Data file format\n";
        text += "# pcm " + std::string(2 * (20 - count.size()) + 1, '.') + "\n";
        for (const std::string& line : comments_) text += "# " + line + "\n";
        std::string names, sizes, kinds, counts;
        for (const Field& field : plan_.fields) {
            names += " " + field.name;
            sizes += " " + std::to_string(field.size);
            kinds += std::string(" ") + field.kind;
            counts += " " + std::to_string(field.count);
        }
        text += "VERSION 0.7\nFIELDS" + names + "\nSIZE" + sizes + "\nTYPE" + kinds + "\nCOUNT" + counts + "\n";
        text += "WIDTH " + count + "\nHEIGHT 1\nVIEWPOINT " + viewpoint_ + "\nPOINTS " + count + "\n";
        return text + (ascii_ ? "DATA ascii\n" : "DATA binary\n");
    }

    bool ascii_;
    Plan plan_;
    RecordEncoder records_;
    OutputFile file_;
    std::string viewpoint_;
    std::vector<std::string> comments_;
};

}  // namespace

std::unique_ptr<PointWriter> create_pcd(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options)
{
    return std::make_unique<PcdWriter>(path, cloud, options);
}

}  // namespace pcm
