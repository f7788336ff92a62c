#include "pcm/io/pipe/merged_reader.h"

#include "pcm/io/pipe/batch_shape.h"
#include "pcm/io/pipe/file_notes.h"
#include "pcm/io/pipe/grid_move.h"
#include "pcm/io/pipe/grid_steps.h"
#include "pcm/io/pipe/system_check.h"
#include "pcm/io/record_batch.h"
#include "pcm/io/scans.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t max_metadata_bytes = std::uint64_t{64} << 20;

// Attributes that differ only in their description are the same.
bool same_kind(const Attribute& a, const Attribute& b)
{
    return a.type == b.type && a.components == b.components && a.scale == b.scale && a.offset == b.offset;
}

// Whether an error is about one file, so that others can be read without it.
bool is_of_a_file(const Error& error)
{
    return error.code() != ErrorCode::cancelled && error.code() != ErrorCode::invalid_argument &&
           error.code() != ErrorCode::no_space;
}

double size_in_bytes(const fs::path& path)
{
    std::error_code error;
    const std::uintmax_t bytes = fs::is_regular_file(path, error) ? fs::file_size(path, error) : 0;
    return error || bytes == 0 ? 1.0 : static_cast<double>(bytes);
}

}  // namespace

void MergedReader::Inputs::add(const fs::path& input, const ReadOptions& options)
{
    skip_bad_files = options.skip_bad_files;
    ignore_crs = options.ignore_crs;
    std::vector<fs::path> files;
    try {
        files = expand_inputs({input}, &notes, skip_bad_files);
    } catch (const Error& error) {
        if (!skip_bad_files || !is_of_a_file(error)) throw;
        left_out.push_back(error);
    }
    for (const fs::path& path : files)
        sources.push_back({path, [path, options] { return open_reader(path, options); }});
}

MergedReader::MergedReader(Inputs inputs) : skip_bad_files_(inputs.skip_bad_files) { look_at_headers(inputs); }

MergedReader::MergedReader(const std::vector<fs::path>& paths, const ReadOptions& options)
{
    Inputs inputs;
    for (const fs::path& path : paths) inputs.add(path, options);
    skip_bad_files_ = options.skip_bad_files;
    inputs.ignore_crs = options.ignore_crs;
    look_at_headers(inputs);
}

void MergedReader::look_at_headers(Inputs& inputs)
{
    if (inputs.sources.empty() && inputs.left_out.empty())
        throw Error(ErrorCode::invalid_argument, {}, "no input files were given");
    FileNotes notes(inputs.sources.size());
    std::vector<Error> errors = std::move(inputs.left_out);
    SystemCheck systems(inputs.ignore_crs);
    std::vector<fs::path> without_system;
    for (Source& source : inputs.sources) {
        std::unique_ptr<PointReader> reader;
        try {
            reader = source.open();
        } catch (const Error& error) {
            if (!skip_bad_files_ || !is_of_a_file(error)) throw;
            errors.push_back(error);
            continue;
        }
        for (const std::string& note : systems.add(reader->info(), source.path)) notes.add(note, source.path);
        if (systems.is_without_system()) without_system.push_back(source.path);
        look_at_header(source, *reader, notes);
        take_metadata(reader->info(), parts_.back().scans_before, systems.gives_the_system(), notes);
        sources_.push_back(std::move(source));
    }
    if (sources_.empty()) throw errors[0];
    info_.skipped.files = errors.size();
    if (!boxes_known_ || (info_.promised_box && info_.promised_box->empty())) info_.promised_box.reset();
    if (systems.system())
        for (const fs::path& path : without_system)
            notes.add("no coordinate system is stated; it is taken to be that of the other files, " +
                          describe(*systems.system()),
                      path);
    settle_positions();
    if (std::count_if(parts_.begin(), parts_.end(), [](const Part& part) { return part.scans > 0; }) > 1)
        scan_place_ = place_for_scan_numbers(info_.schema);
    describe_missing(notes);
    settle_records();
    info_.notes = std::move(inputs.notes);
    if (!errors.empty()) info_.notes.push_back(note_of_left_out(errors));
    for (std::string& note : notes.take()) info_.notes.push_back(std::move(note));
    end_ = parts_.size();
    std::map<std::string, std::size_t> formats;
    for (const Part& part : parts_) ++formats[part.format];
    info_.format = formats.size() == 1 ? formats.begin()->first : FileNotes::list_of(formats);
}

void MergedReader::look_at_header(const Source& source, const PointReader& reader, FileNotes& notes)
{
    const FileInfo& info = reader.info();
    seekable_ = seekable_ && reader.seekable();
    for (const std::string& note : info.notes) notes.add(note, source.path);
    Part part;
    part.points = info.points;
    part.points_before = info_.points;
    part.weight = size_in_bytes(source.path);
    part.weight_before = total_weight_;
    part.shape = shape_of(info, source.path, notes);
    part.grid = info.grid;
    part.notes = info.notes.size();
    part.format = info.format;
    part.points_known = info.points_known;
    part.has_records = reader.has_records();
    part.position_type = info.position_type;
    part.scans = scans_of(info.metadata, info.schema);
    part.scans_before = scans_;
    const std::optional<Grid>& first = parts_.empty() ? info.grid : parts_[0].grid;
    part.keeps_integers =
        first && info.grid &&
        (info.points == 0 || (info.promised_box && GridMove(*info.grid, *first).fits(*info.promised_box)));
    scans_ += std::min(part.scans, std::numeric_limits<std::uint32_t>::max() - scans_);
    total_weight_ += part.weight;
    info_.near_grid = parts_.empty() ? info.near_grid : std::nullopt;
    parts_.push_back(part);
    info_.points += info.points;
    info_.points_known = info_.points_known && info.points_known;
    if (info.promised_box) {
        Box3d box = info_.promised_box.value_or(Box3d());
        box.extend(*info.promised_box);
        info_.promised_box = box;
    } else if (info.points || !info.points_known) {
        boxes_known_ = false;
    }
}

std::size_t MergedReader::shape_of(const FileInfo& info, const fs::path& path, FileNotes& notes)
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

// `with_system`: the file states the cloud's coordinate system; records of an earlier file that nobody could decode
// make place for it.
void MergedReader::take_metadata(const FileInfo& info, std::uint32_t scans_before, bool with_system, FileNotes& notes)
{
    std::vector<Metadata>& all = info_.metadata;
    if (with_system) all.erase(std::remove_if(all.begin(), all.end(), is_crs_block), all.end());
    for (Metadata block : info.metadata) {
        if (!with_system && is_crs_block(block)) continue;
        if (scans_before > 0) block.key = renumbered(block.key, scans_before);
        if (metadata_bytes_ == max_metadata_bytes) return;  // noted already
        if (std::find(all.begin(), all.end(), block) != all.end()) continue;
        constexpr std::uint64_t overhead = 128;
        const std::uint64_t bytes = block.value.size() + block.key.size() + overhead;
        if (bytes > max_metadata_bytes - metadata_bytes_) {
            notes.add("metadata beyond " + bytes_text(max_metadata_bytes) + " for all files together are not kept");
            metadata_bytes_ = max_metadata_bytes;
            return;
        }
        metadata_bytes_ += bytes;
        all.push_back(std::move(block));
    }
}

void MergedReader::settle_positions()
{
    bool one_grid = true, near = true, keep = true;
    for (const Part& part : parts_) {
        one_grid = one_grid && part.grid && *part.grid == *parts_[0].grid;
        near = near && part.grid && steps_apart(*parts_[0].grid, *part.grid);
        keep = keep && part.keeps_integers;
    }
    keeps_integers_ = near && keep && !one_grid;
    if (one_grid) {
        info_.grid = parts_[0].grid;
        info_.position_type = ScalarType::i32;
        return;
    }
    if (near) info_.near_grid = parts_[0].grid;
    const bool all_f32 = std::all_of(parts_.begin(), parts_.end(),
                                     [](const Part& part) { return part.position_type == ScalarType::f32; });
    info_.position_type = all_f32 ? ScalarType::f32 : ScalarType::f64;
}

// Records are those of the files where no value of them is changed, added or moved.
void MergedReader::settle_records()
{
    has_records_ = info_.grid && !scan_place_;
    for (const Part& part : parts_) has_records_ = has_records_ && part.has_records && shapes_[part.shape].same;
}

// Notes and metadata that a reader added while it read a file.
void MergedReader::take_late(const FileInfo& info, const Part& part, const fs::path& path)
{
    FileNotes late(sources_.size());
    for (std::size_t i = part.notes; i < info.notes.size(); ++i) late.add(info.notes[i], path);
    take_metadata(info, part.scans_before, false, late);
    info_.points_left_out += info.points_left_out;
    for (std::string& note : late.take())
        if (info_.notes.size() < 2 * FileNotes::max_notes &&
            std::find(info_.notes.begin(), info_.notes.end(), note) == info_.notes.end())
            info_.notes.push_back(std::move(note));
}

void MergedReader::put_scan_numbers(PointBatch& batch) const
{
    const Part& part = parts_[current_];
    if (!scan_place_ || part.scans == 0) return;
    const std::vector<std::size_t>& missing = shapes_[part.shape].missing;
    number_scans(batch.attributes[*scan_place_], batch.size, part.scans_before,
                 !std::binary_search(missing.begin(), missing.end(), *scan_place_));
}

void MergedReader::note_missing(const std::string& what, const std::vector<std::size_t>& parts, FileNotes& notes) const
{
    if (parts.empty()) return;
    std::vector<std::string> names;
    for (const std::size_t p : parts)
        if (names.size() < FileNotes::named_files) names.push_back(FileNotes::name_of(sources_[p].path));
    notes.add(what + " not in " + grouped(parts.size()) + " of " + grouped(parts_.size()) +
              " files and zero there: " + FileNotes::list_of(names, parts.size()));
}

void MergedReader::describe_missing(FileNotes& notes)
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
        if (scan_place_ == k) continue;
        std::vector<bool> shapes(shapes_.size());
        for (std::size_t s = 0; s < shapes_.size(); ++s) {
            const std::vector<std::size_t>& missing = shapes_[s].missing;
            shapes[s] = std::binary_search(missing.begin(), missing.end(), k);
        }
        lacked_by[shapes].push_back(k);
    }
    for (const auto& [shapes, attributes] : lacked_by) {
        std::vector<std::size_t> parts;
        for (std::size_t p = 0; p < parts_.size(); ++p)
            if (shapes[parts_[p].shape]) parts.push_back(p);
        std::string text = attributes.size() == 1 ? "attribute " : "attributes ";
        for (std::size_t i = 0; i < attributes.size(); ++i)
            text += (i ? ", '" : "'") + info_.schema[attributes[i]].name + "'";
        note_missing(text + (attributes.size() == 1 ? " is" : " are"), parts, notes);
    }
    if (!scan_place_) return;
    std::vector<std::size_t> without;
    for (std::size_t p = 0; p < parts_.size(); ++p)
        if (parts_[p].scans == 0) without.push_back(p);
    note_missing("attribute 'scan' is", without, notes);
}

std::vector<std::uint64_t> MergedReader::points_of_sources() const
{
    std::vector<std::uint64_t> points;
    for (const Part& part : parts_) points.push_back(part.points);
    return points;
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
    if (read_next(batch, max_points)) return true;
    shape_batch(batch, info_.schema, info_.grid.has_value(), 0);
    return false;
}

bool MergedReader::read_records(RecordBatch& batch, std::size_t max_points)
{
    if (!has_records_) return PointReader::read_records(batch, max_points);
    if (read_next(batch, max_points)) return true;
    batch.size = 0;
    return false;
}

template <class Batch>
bool MergedReader::read_next(Batch& batch, std::size_t max_points)
{
    while (current_ < end_) {
        try {
            if (read_part(batch, max_points)) {
                part_points_ += batch.size;
                return true;
            }
        } catch (const Error& error) {
            if (!skip_bad_files_ || !is_of_a_file(error)) throw;
            give_up(error);
        }
        end_part();
    }
    if (!finished_) finish();
    return false;
}

// The next points of the current part.
bool MergedReader::read_part(RecordBatch& batch, std::size_t max_points)
{
    if (!open(current_).read_records(batch, max_points)) return false;
    move_to_grid(current_, batch);
    return true;
}

bool MergedReader::read_part(PointBatch& batch, std::size_t max_points)
{
    const bool gridded = info_.grid.has_value();
    const Part& part = parts_[current_];
    const Shape& shape = shapes_[part.shape];
    PointReader& reader = open(current_);
    if (shape.same && part.grid.has_value() == gridded) {
        if (!reader.read(batch, max_points)) return false;
        move_to_grid(current_, batch);
        put_scan_numbers(batch);
        return true;
    }
    if (!reader.read(part_batch_, max_points)) return false;
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
    move_to_grid(current_, batch);
    put_scan_numbers(batch);
    return true;
}

// The rest of the current part cannot be read.
void MergedReader::give_up(const Error& error)
{
    const Part& part = parts_[current_];
    faults_.give_up(FileNotes::name_of(sources_[current_].path) + " could be read in part: " + grouped(part_points_) +
                    " of its " + (part.points_known ? "" : "about ") + grouped(part.points) + " points were taken; " +
                    error.what());
    info_.skipped.incomplete_files = faults_.files();
}

void MergedReader::end_part()
{
    const Part& part = parts_[current_];
    if (open_ && open_part_ == current_) {
        const FileInfo& info = open_->info();
        faults_.end_file(info.skipped.lines);
        info_.skipped.lines = faults_.lines();
        take_late(info, part, sources_[current_].path);
    }
    open_.reset();
    part_points_ = 0;
    ++current_;
}

void MergedReader::finish()
{
    for (std::string& fault : faults_.notes())
        if (std::find(info_.notes.begin(), info_.notes.end(), fault) == info_.notes.end())
            info_.notes.push_back(std::move(fault));
    finished_ = true;
}

void MergedReader::seek(std::uint64_t index)
{
    if (!seekable_) return PointReader::seek(index);
    if (index > info_.points)
        throw Error(ErrorCode::invalid_argument, sources_[0].path,
                    "point " + std::to_string(index) + " was requested, the cloud has " + std::to_string(info_.points));
    rewind();
    const auto after = std::upper_bound(parts_.begin(), parts_.end(), index,
                                        [](std::uint64_t i, const Part& part) { return i < part.points_before; });
    current_ = index == info_.points ? parts_.size() : static_cast<std::size_t>(after - parts_.begin()) - 1;
    if (current_ == parts_.size()) return;
    part_points_ = index - parts_[current_].points_before;
    open(current_).seek(part_points_);
}

void MergedReader::keep_sources(std::size_t first, std::size_t end)
{
    rewind();
    open_.reset();
    current_ = first;
    end_ = end;
}

void MergedReader::rewind()
{
    current_ = 0;
    end_ = parts_.size();
    part_points_ = 0;
    info_.skipped.lines = info_.skipped.incomplete_files = 0;
    info_.move_error = 0;
    faults_ = ReadFaults();
    finished_ = false;
}

void MergedReader::keep_integers(bool keep)
{
    rewind();
    open_.reset();
    info_.grid = keep ? info_.near_grid : std::nullopt;
    info_.position_type = keep ? ScalarType::i32 : ScalarType::f64;
    settle_records();
}

// From the grid of a part to that of the cloud, where the cloud has one.
template <class... Points>
void MergedReader::move_to_grid(std::size_t part, Points&... points)
{
    if (!info_.grid || *parts_[part].grid == *info_.grid) return;
    GridMove move(*parts_[part].grid, *info_.grid);
    if (!move.move(points...)) throw IntegersLost();
    info_.move_error = std::max(info_.move_error, move.error());
}

double MergedReader::fraction_read() const
{
    if (current_ == parts_.size()) return 1.0;
    double done = parts_[current_].weight_before;
    if (open_ && open_part_ == current_) done += parts_[current_].weight * open_->fraction_read();
    return std::clamp(done / total_weight_, 0.0, 1.0);
}

}  // namespace pcm
