#include "pcm/io/xyz/xyz_writer.h"

#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/file_text.h"
#include "pcm/io/metadata_text.h"
#include "pcm/io/text/text_output.h"

#include <algorithm>
#include <string_view>

namespace pcm {
namespace {

// A name for one more column, different from all others regardless of case, of letters, digits and signs; with `quoted`
// also blanks.
std::string column_name(std::string_view raw, bool quoted, const std::vector<std::string>& taken)
{
    std::string name = printable_name(raw);
    for (char& c : name)
        if (!quoted && std::string_view(" ,;\"'#").find(c) != std::string_view::npos) c = '_';
    if (name.empty() || name == "-") name = "_";  // "-" means that a column is to be skipped
    std::string candidate = name;
    const auto is_taken = [&](const std::string& other) { return lower_case(other) == lower_case(candidate); };
    for (int number = 2; std::any_of(taken.begin(), taken.end(), is_taken); ++number)
        candidate = name + "_" + std::to_string(number);
    return candidate;
}

std::vector<std::string> column_names(const Schema& schema, bool quoted)
{
    std::vector<std::string> names = {"x", "y", "z"};
    for (const Attribute& attribute : schema) {
        const bool three = attribute.components == 3;
        for (std::uint32_t k = 0; k < attribute.components; ++k) {
            static constexpr const char* colours[] = {"r", "g", "b"};
            static constexpr const char* normals[] = {"nx", "ny", "nz"};
            const std::string name = three && attribute.name == attribute_name::rgb      ? colours[k]
                                     : three && attribute.name == attribute_name::normal ? normals[k]
                                     : attribute.components == 1                         ? attribute.name
                                                                 : attribute.name + "_" + std::to_string(k);
            names.push_back(column_name(name, quoted, names));
        }
    }
    return names;
}

std::string csv_field(const std::string& name)
{
    if (name.find_first_of(",;\"' #\t") == std::string::npos) return name;
    std::string field = "\"";
    for (const char c : name) field += c == '"' ? std::string("\"\"") : std::string(1, c);
    return field + '"';
}

class XyzWriter final : public PointWriter {
public:
    XyzWriter(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options)
        : schema_(cloud.schema), separator_(extension_of(path) == "csv" ? ',' : ' '), out_(path, cloud, options)
    {
        const bool csv = separator_ == ',';
        const std::vector<std::string> names = column_names(schema_, csv);
        std::string header = csv ? "" : "#";
        for (std::size_t i = 0; i < names.size(); ++i) {
            if (!csv || i) header += separator_;
            header += csv ? csv_field(names[i]) : names[i];
        }
        out_.put(header + "\n");
        const std::string system = crs_comment_line(cloud.metadata);
        // Readers of .csv know no comments.
        if (!system.empty() && !csv) out_.put("# " + system + "\n");
        if (!system.empty() && csv) notes_.push_back("CSV has no place for the coordinate system (" + system + ")");
        if (std::string note = unwritten_note("text", cloud.metadata); !note.empty()) notes_.push_back(std::move(note));
    }

    void write(const PointBatch& batch) override
    {
        out_.check(batch);
        for (std::size_t point = 0; point < batch.size; ++point) {
            out_.put_position(batch, point, separator_);
            for (std::size_t i = 0; i < schema_.size(); ++i) {
                const std::uint32_t components = schema_[i].components;
                for (std::uint32_t k = 0; k < components; ++k) {
                    out_.put(separator_);
                    out_.put_scalar(schema_[i], batch.attributes[i], point * components + k);
                }
            }
            out_.put('\n');
        }
    }

    void finish() override
    {
        out_.flush();
        out_.file().finish();
    }

    double position_error() const override { return out_.position_error(); }
    std::vector<std::string> notes() const override { return notes_; }

private:
    const Schema schema_;
    const char separator_;
    TextOutput out_;
    std::vector<std::string> notes_;
};

}  // namespace

std::unique_ptr<PointWriter> create_xyz(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options)
{
    return std::make_unique<XyzWriter>(path, cloud, options);
}

}  // namespace pcm
