#include "pcm/io/ply/ply_writer.h"

#include "pcm/io/file_text.h"
#include "pcm/io/ply/ply_header.h"
#include "pcm/io/records/carried_comments.h"
#include "pcm/io/records/record_encoder.h"
#include "pcm/system/error.h"
#include "pcm/system/output_file.h"

#include <algorithm>
#include <set>
#include <utility>

namespace pcm {
namespace {

// The PLY properties of one attribute of the cloud, or of an axis.
struct Property {
    std::string name;
    RecordField field;
};

std::string_view ply_name(ScalarType type)
{
    switch (type) {
        case ScalarType::i8:
            return "char";
        case ScalarType::u8:
            return "uchar";
        case ScalarType::i16:
            return "short";
        case ScalarType::u16:
            return "ushort";
        case ScalarType::i32:
            return "int";
        case ScalarType::u32:
            return "uint";
        case ScalarType::f32:
            return "float";
        default:
            return "double";
    }
}

// Names with a special meaning for ply_reader.
bool has_a_meaning(const std::string& lower_name)
{
    static constexpr std::string_view names[] = {"x",
                                                 "y",
                                                 "z",
                                                 "red",
                                                 "green",
                                                 "blue",
                                                 "r",
                                                 "g",
                                                 "b",
                                                 "nx",
                                                 "ny",
                                                 "nz",
                                                 "diffuse_red",
                                                 "diffuse_green",
                                                 "diffuse_blue",
                                                 "normal_x",
                                                 "normal_y",
                                                 "normal_z",
                                                 "rgb",
                                                 "normal",
                                                 "scalar_intensity"};
    return std::find(std::begin(names), std::end(names), lower_name) != std::end(names);
}

class Plan {
public:
    Plan(const std::filesystem::path& path, const FileInfo& cloud)
    {
        // Checked before names are made for each of a million components.
        constexpr std::size_t shortest_line = 16;
        std::uint64_t components = 0;
        for (const Attribute& attribute : cloud.schema) components += attribute.components;
        if (components > longest_ply_header / shortest_line)
            throw Error(
                ErrorCode::invalid_argument, path,
                "a PLY header has no room for the " + std::to_string(components) + " components of the attributes");
        const ScalarType position =
            cloud.position_type == ScalarType::f32 && !cloud.grid ? ScalarType::f32 : ScalarType::f64;
        for (std::size_t a = 0; a < 3; ++a)
            properties.push_back({std::string(1, "xyz"[a]), RecordField::axis(a, position)});
        for (std::size_t i = 0; i < cloud.schema.size(); ++i) add(cloud.schema[i], i);
    }

    std::vector<Property> properties;
    std::vector<CarriedAttribute> carried;

private:
    using Names = std::vector<std::string>;

    void add(const Attribute& attribute, std::size_t index)
    {
        const bool wide = attribute.type == ScalarType::i64 || attribute.type == ScalarType::u64;
        Names names;
        bool plain = true;  // read back the same without a comment
        if (attribute.name == attribute_name::rgb && attribute.components == 3 && !wide) {
            names = {"red", "green", "blue"};
        } else if (attribute.name == attribute_name::normal && attribute.components == 3 && !wide) {
            names = {"nx", "ny", "nz"};
        } else {
            names = names_of(attribute, wide);
            plain = names.size() == 1 && names[0] == attribute.name;
        }
        for (const std::string& name : names) used_.insert(lower_case(name));
        if (!plain || attribute.scale != 1 || attribute.offset != 0 || !attribute.description.empty())
            carried.push_back({names[0], attribute});

        const ScalarType type = wide ? ScalarType::u32 : attribute.type;
        for (std::size_t k = 0; k < names.size(); ++k) {
            // The upper half has the sign.
            const ScalarType half = attribute.type == ScalarType::i64 && k % 2 == 1 ? ScalarType::i32 : type;
            properties.push_back({names[k], RecordField::scalars(index, k * size_of(type), half)});
        }
    }

    Names names_of(const Attribute& attribute, bool wide) const
    {
        std::string base = field_name(attribute.name);
        if (has_a_meaning(lower_case(base))) base = "attribute_" + base;
        for (int number = 1;; ++number) {
            const std::string stem = number == 1 ? base : base + "_" + std::to_string(number);
            Names names;
            for (std::uint32_t c = 0; c < attribute.components; ++c) {
                const std::string name = attribute.components == 1 ? stem : stem + "_" + std::to_string(c);
                if (wide) {
                    names.push_back(name + "_low");
                    names.push_back(name + "_high");
                } else {
                    names.push_back(name);
                }
            }
            const bool free = std::none_of(names.begin(), names.end(), [&](const std::string& name) {
                return used_.count(lower_case(name)) || has_a_meaning(lower_case(name));
            });
            if (free) return names;
        }
    }

    std::set<std::string> used_;  // lower case
};

std::vector<RecordField> fields_of(const Plan& plan)
{
    std::vector<RecordField> fields;
    for (const Property& property : plan.properties) fields.push_back(property.field);
    return fields;
}

class PlyWriter final : public PointWriter {
public:
    PlyWriter(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options)
        : ascii_(options.ascii), plan_(path, cloud), records_(cloud, options, fields_of(plan_)), file_(path)
    {
        Carried carried{plan_.carried, cloud.metadata};
        add_grid(cloud, carried.metadata);
        comments_ = carried_comments(carried, notes_);
        const std::string text = header();
        if (text.size() > longest_ply_header)
            throw Error(ErrorCode::invalid_argument, path,
                        "the cloud's attributes need a header of " + std::to_string(text.size()) +
                            " bytes, readers of PLY take at most " + std::to_string(longest_ply_header));
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
    std::vector<std::string> notes() const override { return notes_; }

private:
    // Its length does not depend on the number of points.
    std::string header() const
    {
        const std::string count = std::to_string(records_.points());
        std::string text = ascii_ ? "ply\nformat ascii 1.0\n" : "ply\nformat binary_little_endian 1.0\n";
        text += "comment pcm " + std::string(20 - count.size(), '.') + "\n";
        for (const std::string& line : comments_) text += "comment " + line + "\n";
        text += "element vertex " + count + "\n";
        for (const Property& property : plan_.properties)
            text += "property " + std::string(ply_name(property.field.type)) + " " + property.name + "\n";
        return text + "end_header\n";
    }

    bool ascii_;
    Plan plan_;
    RecordEncoder records_;
    OutputFile file_;
    std::vector<std::string> comments_;
    std::vector<std::string> notes_;
};

}  // namespace

std::unique_ptr<PointWriter> create_ply(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options)
{
    return std::make_unique<PlyWriter>(path, cloud, options);
}

}  // namespace pcm
