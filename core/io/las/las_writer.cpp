#include "pcm/io/las/las_writer.h"

#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/file_text.h"
#include "pcm/io/las/las_encoding.h"
#include "pcm/io/las/las_header.h"
#include "pcm/io/las/las_layout.h"
#include "pcm/io/las/las_sink.h"
#include "pcm/io/las/las_write_plan.h"
#include "pcm/io/las_summary.h"
#include "pcm/io/metadata_text.h"
#include "pcm/io/pipe/grid_choice.h"
#include "pcm/system/error.h"
#include "pcm/system/output_file.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace pcm {
namespace {

namespace at = las::header;

constexpr std::size_t most_vlr_bytes = 65535;
constexpr std::uint64_t most_points_before_1_4 = std::numeric_limits<std::uint32_t>::max();
// Signatures of LAS 1.0: before a VLR and before the points.
constexpr std::uint16_t vlr_signature = 0xAABB;
constexpr std::array<std::uint8_t, 2> start_of_points{0xDD, 0xCC};

bool is(const las::Vlr& vlr, std::string_view user_id, std::uint16_t id)
{
    return vlr.user_id == user_id && vlr.id == id;
}

// A grid that a LAS header can hold.
Grid checked_grid(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options)
{
    if (!options.grid && !cloud.grid)
        throw Error(ErrorCode::invalid_argument, path,
                    "LAS stores positions as 32-bit integers, and this cloud has no grid for them",
                    "give the step of the coordinates, for example 0.001");
    const Grid grid = options.grid ? *options.grid : *cloud.grid;
    for (std::size_t a = 0; a < 3; ++a)
        if (!(grid.scale[a] > 0) || !std::isfinite(grid.scale[a]) || !std::isfinite(grid.offset[a]))
            throw Error(ErrorCode::invalid_argument, path,
                        "a LAS grid needs positive steps and finite offsets, found step " + exact(grid.scale[a]) +
                            " and offset " + exact(grid.offset[a]));
    return grid;
}

class LasWriter final : public PointWriter {
public:
    LasWriter(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options, bool compressed)
        : cloud_(cloud),
          grid_(checked_grid(path, cloud, options)),
          copies_positions_(cloud.grid && *cloud.grid == grid_),
          compressed_(compressed),
          plan_(las::plan_writing(path, cloud, options)),
          minor_(plan_.target.minor),
          laszip_vlr_(compressed ? las::make_laszip_vlr(path, plan_.target.format, plan_.record_length)
                                 : std::vector<std::byte>()),
          notes_(plan_.notes),
          cut_(plan_.columns.size()),
          out_(path)
    {
        choose_vlrs();
        choose_time_shift();
        choose_version();
        header_.resize(at::size_of_version(minor_));
        out_.append(header_.data(), header_.size());
        for (const las::Vlr& vlr : vlrs_) append(vlr);
        if (minor_ == 0) out_.append(start_of_points.data(), start_of_points.size());
        if (out_.size() > std::numeric_limits<std::uint32_t>::max())
            throw Error(ErrorCode::invalid_argument, path, "the VLRs take more than 4 GB");
        point_offset_ = out_.size();
        sink_ = compressed ? las::laz_sink(out_, plan_.record_length, laszip_vlr_, options.threads)
                           : las::plain_sink(out_, plan_.record_length);
    }

    void write(const PointBatch& batch) override;
    void finish() override;
    double position_error() const override { return error_; }
    std::vector<std::string> notes() const override;

private:
    void choose_vlrs();
    void choose_time_shift();
    void choose_version();
    void append(const las::Vlr& vlr);
    void check(const PointBatch& batch) const;
    void round_positions(const PointBatch& batch);
    void write_points(const PointBatch& batch);
    void count_returns(std::byte* records, std::size_t count);
    void fill_header(std::uint64_t evlr_start);
    unsigned copy_from_source(const std::vector<std::byte>& source);

    FileInfo cloud_;
    Grid grid_;
    bool copies_positions_;
    bool compressed_;
    las::WritePlan plan_;
    unsigned minor_;  // minor version number
    std::vector<std::byte> laszip_vlr_;
    std::vector<std::string> notes_;
    std::vector<std::uint64_t> cut_;  // number of values, by column
    OutputFile out_;
    std::vector<las::Vlr> vlrs_, evlrs_;
    std::vector<std::byte> header_;
    std::uint64_t point_offset_ = 0;
    std::unique_ptr<las::RecordSink> sink_;  // uses out_

    std::uint64_t points_ = 0, not_finite_ = 0;
    std::array<std::uint64_t, 16> returns_{};  // number of points by return number
    Box3i box_;
    double error_ = 0;
    bool finished_ = false;
    double time_shift_ = 0;
    std::optional<std::size_t> shifted_;  // the attribute that it is added to
    Column shifted_times_;
    std::array<std::vector<std::int32_t>, 3> rounded_;
    std::vector<std::byte> scratch_;
};

void LasWriter::choose_vlrs()
{
    const auto add = [&](las::Vlr vlr) {
        if (vlr.value.size() > most_vlr_bytes) vlr.extended = true;
        (vlr.extended ? evlrs_ : vlrs_).push_back(std::move(vlr));
    };
    const auto extra_bytes_vlr = [&](const std::string& description) {
        return las::Vlr{std::string(las::spec_user_id), las::extra_bytes_record_id, description, false,
                        plan_.extra_bytes_vlr};
    };
    bool copc = false, waveforms = las::has_waves(plan_.target.format), described = false;
    std::uint64_t indexes = 0;
    for (const Metadata& block : cloud_.metadata) {
        auto vlr = las::from_metadata(block);
        if (!vlr) continue;
        if (vlr->user_id == las::laszip_user_id) continue;
        if (is(*vlr, las::spec_user_id, las::extra_bytes_record_id)) {  // replaced by ours
            if (!described && !plan_.extra_bytes_vlr.empty()) add(extra_bytes_vlr(vlr->description));
            described = true;
            continue;
        }
        if (vlr->user_id == "copc") {
            copc = true;
            continue;
        }
        if (vlr->user_id == "LAStools" && vlr->id == 30) {
            ++indexes;
            continue;
        }
        if (is(*vlr, las::spec_user_id, las::waveforms_record_id)) {
            waveforms = true;
            continue;
        }
        add(std::move(*vlr));
    }
    if (!described && !plan_.extra_bytes_vlr.empty()) add(extra_bytes_vlr("Extra Bytes"));
    if (auto system = las::crs_vlr(cloud_, vlrs_, evlrs_, notes_)) add(std::move(*system));
    if (compressed_) add({std::string(las::laszip_user_id), las::laszip_record_id, "LASzip", false, laszip_vlr_});
    const auto is_record = [](const Metadata& block) {
        return las::from_metadata(block).has_value() || is_crs_block(block);
    };
    if (std::string note = unwritten_note("LAS", cloud_.metadata, is_record); !note.empty())
        notes_.push_back(std::move(note));
    if (copc)
        notes_.push_back("the octree of the cloud optimised source (COPC) is not copied: it does not fit the new file");
    if (indexes) notes_.push_back("the spatial index of LAStools is not copied: it does not fit the new file");
    if (waveforms)
        notes_.push_back(
            "waveforms are not copied; the points keep their wave packet fields, which point into the source's");
}

// Times of LAS 1.5 may be relative to another second than those of the written version.
void LasWriter::choose_time_shift()
{
    time_shift_ = las::gps_time_shift(cloud_);
    const auto time = cloud_.schema.find(attribute_name::gps_time);
    if (time_shift_ == 0 || !time) return;
    const Attribute& attribute = cloud_.schema[*time];
    if (attribute.type != ScalarType::f64 || attribute.components != 1 || attribute.scale != 1 || attribute.offset != 0)
        return;
    shifted_ = time;
    notes_.push_back(exact(time_shift_) + " seconds are added to the GPS times: those of the source (LAS 1.5) are " +
                     describe(*gps_time_of(cloud_.metadata)) + ", LAS 1.4 subtracts 1000 million");
}

// Raises the version where more is to be written than it holds, or leaves that out where the user wants the version.
void LasWriter::choose_version()
{
    const std::string version = "LAS 1." + std::to_string(minor_);
    const bool wkt = std::any_of(vlrs_.begin(), vlrs_.end(), [](const las::Vlr& vlr) {
        return is(vlr, las::projection_user_id, las::wkt_record_id);
    });
    const auto* const source = las::source_header(cloud_);
    const bool source_has_wkt = source && las::load<std::uint8_t>(&(*source)[at::version_minor]) < 4;
    if (minor_ >= 4) return;
    if (!plan_.target.minor_is_asked) {
        if (!evlrs_.empty() || cloud_.points > most_points_before_1_4 || (wkt && !source_has_wkt)) minor_ = 4;
        return;
    }
    if (wkt)
        notes_.push_back("the coordinate system is stated as WKT, which is not part of " + version +
                         ": other software may not find it");
    for (las::Vlr& vlr : evlrs_) {
        if (is(vlr, las::spec_user_id, las::extra_bytes_record_id))
            throw Error(ErrorCode::invalid_argument, out_.path(),
                        "the description of the extra bytes takes " + std::to_string(vlr.value.size()) + " bytes; " +
                            version + " allows 65535",
                        "write LAS 1.4, or fewer attributes");
        const std::string key = las::to_metadata(vlr).key;
        vlr.extended = false;
        if (vlr.value.size() <= most_vlr_bytes) {
            notes_.push_back("the extended VLR '" + key + "' is written as a VLR: " + version +
                             " has no extended ones");
            vlrs_.push_back(std::move(vlr));
        } else {
            notes_.push_back("the extended VLR '" + key + "' of " + std::to_string(vlr.value.size()) +
                             " bytes is left out: " + version + " allows 65535");
        }
    }
    evlrs_.clear();
}

void LasWriter::append(const las::Vlr& vlr)
{
    std::array<std::byte, las::evlr_header_bytes> head{};
    std::byte* to = head.data();
    if (minor_ == 0) las::store(to, vlr_signature);
    std::memcpy(to + 2, vlr.user_id.data(), std::min<std::size_t>(16, vlr.user_id.size()));
    las::store(to + 18, vlr.id);
    if (vlr.extended)
        las::store(to + 20, static_cast<std::uint64_t>(vlr.value.size()));
    else
        las::store(to + 20, static_cast<std::uint16_t>(vlr.value.size()));
    std::memcpy(to + (vlr.extended ? 28 : 22), vlr.description.data(),
                std::min<std::size_t>(32, vlr.description.size()));
    out_.append(head.data(), vlr.extended ? las::evlr_header_bytes : las::vlr_header_bytes);
    out_.append(vlr.value.data(), vlr.value.size());
}

void LasWriter::check(const PointBatch& batch) const
{
    bool same = batch.gridded == cloud_.grid.has_value() && batch.attributes.size() == cloud_.schema.size();
    for (std::size_t i = 0; same && i < cloud_.schema.size(); ++i)
        same = batch.attributes[i].type() == cloud_.schema[i].type &&
               batch.attributes[i].components() == cloud_.schema[i].components;
    if (!same)
        throw Error(ErrorCode::invalid_argument, out_.path(),
                    "the batch has other attributes than the writer was created for");
    if (finished_) throw Error(ErrorCode::invalid_argument, out_.path(), "points written after finish()");
    if (minor_ < 4 && batch.size > most_points_before_1_4 - points_)
        throw Error(ErrorCode::invalid_argument, out_.path(),
                    "LAS 1." + std::to_string(minor_) + " holds at most " + grouped(most_points_before_1_4) + " points",
                    "write LAS 1.4");
}

// Fills rounded_ with the positions on grid_.
void LasWriter::round_positions(const PointBatch& batch)
{
    for (std::size_t a = 0; a < 3; ++a) {
        rounded_[a].resize(batch.size);
        for (std::size_t i = 0; i < batch.size; ++i) {
            const double v = batch.gridded ? cloud_.grid->to_source(batch.grid_xyz[a][i], a) : batch.xyz[a][i];
            const std::int64_t q = nearest_on_grid(grid_, a, v);
            if (q < std::numeric_limits<std::int32_t>::min() || q > std::numeric_limits<std::int32_t>::max())
                throw Error(ErrorCode::invalid_argument, out_.path(),
                            std::string(1, "xyz"[a]) + " = " + exact(v) + " of point " +
                                std::to_string(points_ + i + 1) + " does not fit 32 bits on the grid with step " +
                                exact(grid_.scale[a]) + " and offset " + exact(grid_.offset[a]),
                            "give a larger step, or an offset nearer to the coordinates");
            error_ = std::max(error_, std::abs(grid_.to_source(q, a) - v));
            rounded_[a][i] = static_cast<std::int32_t>(q);
        }
    }
}

void LasWriter::write(const PointBatch& batch)
{
    check(batch);
    if (batch.gridded) return write_points(batch);
    const auto is_finite = [&](std::size_t i) {
        return std::isfinite(batch.xyz[0][i]) && std::isfinite(batch.xyz[1][i]) && std::isfinite(batch.xyz[2][i]);
    };
    std::size_t finite = 0;
    for (std::size_t i = 0; i < batch.size; ++i) finite += is_finite(i);
    if (finite == batch.size) return write_points(batch);
    not_finite_ += batch.size - finite;
    PointBatch rest;
    rest.reset(cloud_.schema, false, finite);
    std::size_t to = 0;
    for (std::size_t i = 0; i < batch.size; ++i) {
        if (!is_finite(i)) continue;
        for (std::size_t a = 0; a < 3; ++a) rest.xyz[a][to] = batch.xyz[a][i];
        for (std::size_t c = 0; c < batch.attributes.size(); ++c) {
            const std::size_t bytes = batch.attributes[c].point_bytes();
            std::memcpy(rest.attributes[c].data() + to * bytes, batch.attributes[c].data() + i * bytes, bytes);
        }
        ++to;
    }
    write_points(rest);
}

void LasWriter::write_points(const PointBatch& batch)
{
    if (!copies_positions_) round_positions(batch);
    if (shifted_) {
        shifted_times_ = batch.attributes[*shifted_];
        double* const times = shifted_times_.as<double>();
        for (std::size_t i = 0; i < batch.size; ++i) times[i] += time_shift_;
    }
    const auto& positions = copies_positions_ ? batch.grid_xyz : rounded_;
    const std::size_t stride = plan_.record_length;
    for (std::size_t done = 0; done < batch.size;) {
        const las::RecordRoom room = sink_->room(batch.size - done);
        for (std::size_t a = 0; a < 3; ++a) {
            const std::int32_t* q = positions[a].data() + done;
            las::scatter({4 * a, 4, 0, 0}, reinterpret_cast<const std::byte*>(q), room.count, room.records, stride);
            const auto [least, most] = std::minmax_element(q, q + room.count);
            box_.min[a] = std::min<std::int64_t>(box_.min[a], *least);
            box_.max[a] = std::max<std::int64_t>(box_.max[a], *most);
        }
        for (std::size_t c = 0; c < plan_.columns.size(); ++c) {
            const std::size_t attribute = plan_.columns[c].attribute;
            const Column& values = attribute == shifted_ ? shifted_times_ : batch.attributes[attribute];
            cut_[c] += las::fill(plan_.columns[c], values, done, room.count, room.records, stride, scratch_);
        }
        count_returns(room.records, room.count);
        done += room.count;
    }
    points_ += batch.size;
}

void LasWriter::count_returns(std::byte* records, std::size_t count)
{
    const std::size_t stride = plan_.record_length;
    const bool extended = las::is_extended(plan_.target.format);
    if (!plan_.has_returns) {
        returns_[1] += count;
        const auto only_return = static_cast<std::byte>(extended ? 1 | 1 << 4 : 1 | 1 << 3);
        for (std::size_t i = 0; i < count; ++i) records[i * stride + 14] = only_return;
        return;
    }
    const auto mask = static_cast<std::byte>(extended ? 15 : 7);
    for (std::size_t i = 0; i < count; ++i) ++returns_[std::to_integer<std::size_t>(records[i * stride + 14] & mask)];
}

std::vector<std::string> LasWriter::notes() const
{
    std::vector<std::string> all = notes_;
    for (std::size_t c = 0; c < cut_.size(); ++c)
        if (cut_[c])
            all.push_back(grouped(cut_[c]) + " values of '" + cloud_.schema[plan_.columns[c].attribute].name +
                          "' need more bits than point format " + std::to_string(plan_.target.format) +
                          " has for them; they are clamped to " + std::to_string(plan_.columns[c].field.mask));
    if (not_finite_)
        all.push_back(points_text(not_finite_) + " without a finite position left out: LAS cannot store them");
    return all;
}

// What the header states about the origin of the file. Returns its global encoding.
unsigned LasWriter::copy_from_source(const std::vector<std::byte>& source)
{
    std::byte* const to = header_.data();
    const auto copy = [&](std::size_t offset, std::size_t bytes) { std::memcpy(to + offset, &source[offset], bytes); };
    const auto minor = las::load<std::uint8_t>(&source[at::version_minor]);
    if (minor >= 1 && minor_ >= 1) copy(at::file_source_id, 2);
    unsigned encoding = minor >= 2 ? las::load<std::uint16_t>(&source[at::global_encoding]) : 0;
    // These bits say where waveforms are; they are not copied.
    encoding &= ~(las::encoding::waveforms_inside | las::encoding::waveforms_beside);
    copy(at::guid, 16);
    copy(at::system_identifier, 32);
    copy(at::generating_software, 32);
    copy(at::creation_day, 2);
    copy(at::creation_year, 2);
    return encoding;
}

void LasWriter::fill_header(std::uint64_t evlr_start)
{
    std::byte* const to = header_.data();
    std::memcpy(to, "LASF", 4);
    std::memcpy(to + at::system_identifier, "OTHER", 5);
    std::memcpy(to + at::generating_software, "pcm", 3);
    // A fixed date: the same points give the same bytes on any day.
    las::store(to + at::creation_day, std::uint16_t{1});
    las::store(to + at::creation_year, std::uint16_t{2025});
    // Point formats 6 and above state coordinate systems as WKT, or none.
    unsigned encoding = las::is_extended(plan_.target.format) ? las::encoding::wkt : 0;
    if (const auto* const source = las::source_header(cloud_)) encoding = copy_from_source(*source);
    encoding = las::encoding_of(encoding, cloud_, vlrs_, evlrs_) & las::encoding::bits_of_version(minor_);
    las::store(to + at::global_encoding, static_cast<std::uint16_t>(encoding));
    las::store(to + at::version_major, std::uint8_t{1});
    las::store(to + at::version_minor, static_cast<std::uint8_t>(minor_));
    las::store(to + at::header_size, static_cast<std::uint16_t>(header_.size()));
    las::store(to + at::point_offset, static_cast<std::uint32_t>(point_offset_));
    las::store(to + at::vlr_count, static_cast<std::uint32_t>(vlrs_.size()));
    las::store(to + at::point_format, static_cast<std::uint8_t>(plan_.target.format | (compressed_ ? 0x80u : 0u)));
    las::store(to + at::record_length, static_cast<std::uint16_t>(plan_.record_length));
    // The 32-bit counts serve readers of older versions; they are 0 where those cannot read the points anyway.
    if (!las::is_extended(plan_.target.format) && points_ <= std::numeric_limits<std::uint32_t>::max()) {
        las::store(to + at::point_count_32, static_cast<std::uint32_t>(points_));
        for (std::size_t r = 0; r < 5; ++r)
            las::store(to + at::return_counts_32 + 4 * r, static_cast<std::uint32_t>(returns_[r + 1]));
    }
    if (minor_ >= 4) {
        las::store(to + at::point_count_64, points_);
        for (std::size_t r = 0; r < 15; ++r) las::store(to + at::return_counts_64 + 8 * r, returns_[r + 1]);
        if (!evlrs_.empty()) {
            las::store(to + at::evlr_start, evlr_start);
            las::store(to + at::evlr_count, static_cast<std::uint32_t>(evlrs_.size()));
        }
    }
    const Box3d bounds = points_ ? grid_.to_source(box_) : Box3d{{0, 0, 0}, {0, 0, 0}};
    for (std::size_t a = 0; a < 3; ++a) {
        las::store(to + at::scale + 8 * a, grid_.scale[a]);
        las::store(to + at::offset + 8 * a, grid_.offset[a]);
        las::store(to + at::box + 16 * a, bounds.max[a]);
        las::store(to + at::box + 16 * a + 8, bounds.min[a]);
    }
}

void LasWriter::finish()
{
    if (finished_) throw Error(ErrorCode::invalid_argument, out_.path(), "finish() called twice");
    sink_->finish();
    const std::uint64_t evlr_start = out_.size();
    for (const las::Vlr& vlr : evlrs_) append(vlr);
    fill_header(evlr_start);
    out_.rewrite(header_.data(), header_.size(), 0);
    out_.finish();
    finished_ = true;
}

}  // namespace

std::unique_ptr<PointWriter> create_las(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options)
{
    return std::make_unique<LasWriter>(path, cloud, options, extension_of(path) == "laz");
}

SurveyQuestions las_questions(const FileInfo& cloud, const WriteOptions& options)
{
    return las::questions_about(cloud, options);
}

}  // namespace pcm
