#include "pcm/io/pipe/merged_reader.h"

#include "pcm/io/pipe/batch_shape.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_notes = 40;
constexpr std::size_t named_files = 3;  // per note; further files are only counted
constexpr std::uint64_t max_metadata_bytes = std::uint64_t{64} << 20;

std::string file_name(const fs::path& path)
{
    const fs::path name = path.filename().empty() ? path.parent_path().filename() : path.filename();
    return name.string();
}

// Attributes that differ only in their description are the same.
bool same_kind(const Attribute& a, const Attribute& b)
{
    return a.type == b.type && a.components == b.components && a.scale == b.scale && a.offset == b.offset;
}

double size_in_bytes(const fs::path& path)
{
    std::error_code error;
    const std::uintmax_t bytes = fs::is_regular_file(path, error) ? fs::file_size(path, error) : 0;
    return error || bytes == 0 ? 1.0 : static_cast<double>(bytes);
}

// Whether two grids of equal scale differ by whole steps, few enough that doubles keep their positions distinct.
bool steps_apart(const Grid& a, const Grid& b)
{
    if (a.scale != b.scale) return false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double steps = (b.offset[axis] - a.offset[axis]) / a.scale[axis];
        if (!(std::fabs(steps - std::round(steps)) <= 1e-6)) return false;
        const double largest =
            std::max(std::fabs(a.offset[axis]), std::fabs(b.offset[axis])) / std::fabs(a.scale[axis]);
        if (!(largest + 0x1p32 < 0x1p50)) return false;
    }
    return true;
}

}  // namespace

// Notes of many files: equal ones are merged.
class MergedReader::Notes {
public:
    explicit Notes(std::size_t files) : files_(files) {}

    void add(const std::string& text, const fs::path& file)
    {
        const auto [known, is_new] = index_.try_emplace(text, notes_.size());
        if (is_new) {
            if (notes_.size() == max_notes) {
                index_.erase(known);
                ++unnamed_;
                return;
            }
            notes_.push_back({text, {}, 0});
        }
        Note& note = notes_[known->second];
        if (note.names.size() < named_files) note.names.push_back(file_name(file));
        ++note.count;
    }
    void add(std::string text) { general_.push_back(std::move(text)); }

    // "a.las, b.las, c.las and 7 more"
    static std::string list_of(const std::vector<std::string>& names, std::size_t count)
    {
        std::string text;
        for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
        if (count > names.size()) text += " and " + grouped(count - names.size()) + " more";
        return text;
    }
    std::vector<std::string> take()
    {
        std::vector<std::string> all;
        for (const Note& note : notes_)
            all.push_back(files_ == 1 ? note.text : list_of(note.names, note.count) + ": " + note.text);
        if (unnamed_) all.push_back(grouped(unnamed_) + " more notes about files are not repeated here");
        all.insert(all.end(), general_.begin(), general_.end());
        return all;
    }

private:
    struct Note {
        std::string text;
        std::vector<std::string> names;
        std::size_t count;
    };
    std::size_t files_;
    std::vector<Note> notes_;
    std::map<std::string, std::size_t> index_;
    std::uint64_t unnamed_ = 0;
    std::vector<std::string> general_;
};

MergedReader::MergedReader(std::vector<Source> sources) : sources_(std::move(sources)) { look_at_headers(); }

MergedReader::MergedReader(const std::vector<fs::path>& inputs, const ReadOptions& options)
{
    for (const fs::path& path : expand_inputs(inputs))
        sources_.push_back({path, [path, options] { return open_reader(path, options); }});
    look_at_headers();
}

void MergedReader::look_at_headers()
{
    if (sources_.empty()) throw Error(ErrorCode::invalid_argument, {}, "no input files were given");
    Notes notes(sources_.size());
    std::vector<ScalarType> types;
    std::map<std::string, std::size_t> formats;
    Box3d box;
    bool boxes_known = true;
    for (const Source& source : sources_) {
        const auto reader = source.open();
        const FileInfo& info = reader->info();
        seekable_ = seekable_ && reader->seekable();
        for (const std::string& note : info.notes) notes.add(note, source.path);
        Part part;
        part.points = info.points;
        part.weight = size_in_bytes(source.path);
        part.shape = shape_of(info, source.path, notes);
        part.grid = info.grid;
        part.notes = info.notes.size();
        total_weight_ += part.weight;
        parts_.push_back(part);
        types.push_back(info.position_type);
        info_.points += info.points;
        info_.points_known = info_.points_known && info.points_known;
        if (info.promised_box)
            box.extend(*info.promised_box);
        else if (info.points || !info.points_known)
            boxes_known = false;
        take_metadata(info, notes);
        ++formats[info.format];
        if (sources_.size() == 1) info_.near_grid = info.near_grid;
    }
    if (boxes_known && !box.empty()) info_.promised_box = box;
    settle_positions(types);
    describe_missing(notes);
    info_.notes = notes.take();
    if (formats.size() == 1) {
        info_.format = formats.begin()->first;
    } else {
        for (const auto& [format, count] : formats)
            info_.format += (info_.format.empty() ? "" : "; ") + format + " (" + grouped(count) + ")";
    }
}

std::size_t MergedReader::shape_of(const FileInfo& info, const fs::path& path, Notes& notes)
{
    for (std::size_t s = shapes_.size(); s-- > 0;)
        if (shapes_[s].schema == info.schema) return s;
    Shape shape;
    shape.schema = info.schema;
    for (Attribute attribute : info.schema) {
        const std::string name = attribute.name;
        std::vector<bool> taken(info_.schema.size(), false);
        for (const std::size_t slot : shape.places) taken[slot] = true;
        auto slot = info_.schema.find(name);
        for (unsigned n = 1; slot && (!same_kind(info_.schema[*slot], attribute) || taken[*slot]); ++n) {
            attribute.name = name + "_" + std::string(name_of(attribute.type)) + (n > 1 ? "_" + std::to_string(n) : "");
            slot = info_.schema.find(attribute.name);
        }
        if (attribute.name != name)
            notes.add("attribute '" + name + "' differs from that of the previous files and is kept as '" +
                          attribute.name + "'",
                      path);
        if (!slot) {
            slot = info_.schema.size();
            info_.schema.add(attribute);
        }
        shape.places.push_back(*slot);
    }
    shapes_.push_back(std::move(shape));
    return shapes_.size() - 1;
}

void MergedReader::take_metadata(const FileInfo& info, Notes& notes)
{
    for (const Metadata& block : info.metadata) {
        if (metadata_bytes_ == max_metadata_bytes) return;  // noted already
        if (std::find(info_.metadata.begin(), info_.metadata.end(), block) != info_.metadata.end()) continue;
        constexpr std::uint64_t overhead = 128;
        const std::uint64_t bytes = block.value.size() + block.key.size() + overhead;
        if (bytes > max_metadata_bytes - metadata_bytes_) {
            notes.add("metadata beyond " + bytes_text(max_metadata_bytes) + " for all files together are not kept");
            metadata_bytes_ = max_metadata_bytes;
            return;
        }
        metadata_bytes_ += bytes;
        info_.metadata.push_back(block);
    }
}

void MergedReader::settle_positions(const std::vector<ScalarType>& types)
{
    bool one_grid = true, near = true;
    for (const Part& part : parts_) {
        one_grid = one_grid && part.grid && *part.grid == *parts_[0].grid;
        near = near && part.grid && steps_apart(*parts_[0].grid, *part.grid);
    }
    if (one_grid) {
        info_.grid = parts_[0].grid;
        info_.position_type = ScalarType::i32;
        return;
    }
    if (near) info_.near_grid = parts_[0].grid;
    const bool all_f32 = std::all_of(types.begin(), types.end(), [](ScalarType t) { return t == ScalarType::f32; });
    info_.position_type = all_f32 ? ScalarType::f32 : ScalarType::f64;
}

// Notes and metadata that a reader added while it read a file.
void MergedReader::take_late(const FileInfo& info, const Part& part, const fs::path& path)
{
    Notes late(sources_.size());
    for (std::size_t i = part.notes; i < info.notes.size(); ++i) late.add(info.notes[i], path);
    take_metadata(info, late);
    info_.points_left_out += info.points_left_out;
    for (std::string& note : late.take())
        if (info_.notes.size() < 2 * max_notes &&
            std::find(info_.notes.begin(), info_.notes.end(), note) == info_.notes.end())
            info_.notes.push_back(std::move(note));
}

void MergedReader::describe_missing(Notes& notes)
{
    for (Shape& shape : shapes_) {
        std::vector<bool> has(info_.schema.size(), false);
        for (const std::size_t slot : shape.places) has[slot] = true;
        for (std::size_t k = 0; k < has.size(); ++k)
            if (!has[k]) shape.missing.push_back(k);
        shape.same = shape.missing.empty() && std::is_sorted(shape.places.begin(), shape.places.end());
    }
    // Attributes missing from the same files are one note.
    std::map<std::vector<bool>, std::vector<std::size_t>> lacked_by;
    for (std::size_t k = 0; k < info_.schema.size(); ++k) {
        std::vector<bool> shapes(shapes_.size());
        for (std::size_t s = 0; s < shapes_.size(); ++s) {
            const std::vector<std::size_t>& missing = shapes_[s].missing;
            shapes[s] = std::binary_search(missing.begin(), missing.end(), k);
        }
        lacked_by[shapes].push_back(k);
    }
    for (const auto& [shapes, attributes] : lacked_by) {
        std::vector<std::string> names;
        std::size_t count = 0;
        for (std::size_t p = 0; p < parts_.size(); ++p) {
            if (!shapes[parts_[p].shape]) continue;
            if (names.size() < named_files) names.push_back(file_name(sources_[p].path));
            ++count;
        }
        if (count == 0) continue;
        std::string text = attributes.size() == 1 ? "attribute " : "attributes ";
        for (std::size_t i = 0; i < attributes.size(); ++i)
            text += (i ? ", '" : "'") + info_.schema[attributes[i]].name + "'";
        notes.add(text + (attributes.size() == 1 ? " is" : " are") + " not in " + grouped(count) + " of " +
                  grouped(parts_.size()) + " files and zero there: " + Notes::list_of(names, count));
    }
}

PointReader& MergedReader::open(std::size_t part)
{
    if (!open_ || open_part_ != part) {
        open_.reset();
        open_ = sources_[part].open();
        open_part_ = part;
        const FileInfo& now = open_->info();
        const Part& before = parts_[part];
        if (now.points != before.points || !(now.schema == shapes_[before.shape].schema) || !(now.grid == before.grid))
            throw Error(ErrorCode::io, sources_[part].path, "the file has changed while it was being read",
                        "read it again");
    }
    return *open_;
}

bool MergedReader::read(PointBatch& batch, std::size_t max_points)
{
    const bool gridded = info_.grid.has_value();
    for (; current_ < parts_.size(); ++current_) {
        const Part& part = parts_[current_];
        const Shape& shape = shapes_[part.shape];
        PointReader& reader = open(current_);
        if (shape.same && part.grid.has_value() == gridded) {
            if (reader.read(batch, max_points)) return true;
        } else if (reader.read(part_batch_, max_points)) {
            shape_batch(batch, info_.schema, gridded, part_batch_.size);
            for (std::size_t a = 0; a < 3; ++a) {
                if (part_batch_.gridded && !gridded)
                    for (std::size_t i = 0; i < batch.size; ++i)
                        batch.xyz[a][i] = part.grid->to_source(part_batch_.grid_xyz[a][i], a);
                else if (gridded)
                    std::swap(batch.grid_xyz[a], part_batch_.grid_xyz[a]);
                else
                    std::swap(batch.xyz[a], part_batch_.xyz[a]);
            }
            for (std::size_t k = 0; k < shape.places.size(); ++k)
                std::swap(batch.attributes[shape.places[k]], part_batch_.attributes[k]);
            for (const std::size_t k : shape.missing)
                if (Column& column = batch.attributes[k]; column.bytes()) std::memset(column.data(), 0, column.bytes());
            return true;
        }
        take_late(reader.info(), part, sources_[current_].path);
        weight_before_ += part.weight;
        open_.reset();
    }
    shape_batch(batch, info_.schema, gridded, 0);
    return false;
}

void MergedReader::seek(std::uint64_t index)
{
    if (!seekable_) return PointReader::seek(index);
    if (index > info_.points)
        throw Error(ErrorCode::invalid_argument, sources_[0].path,
                    "point " + std::to_string(index) + " was requested, the cloud has " + std::to_string(info_.points));
    weight_before_ = 0;
    for (current_ = 0; current_ < parts_.size(); ++current_) {
        if (index < parts_[current_].points) {
            open(current_).seek(index);
            return;
        }
        index -= parts_[current_].points;
        weight_before_ += parts_[current_].weight;
    }
}

double MergedReader::fraction_read() const
{
    if (current_ == parts_.size()) return 1.0;
    double done = weight_before_;
    if (open_ && open_part_ == current_) done += parts_[current_].weight * open_->fraction_read();
    return std::clamp(done / total_weight_, 0.0, 1.0);
}

}  // namespace pcm
