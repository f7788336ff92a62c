#include "pcm/cluster/spool_jobs.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/bins/distribute.h"
#include "pcm/build/bins/divide_bins.h"
#include "pcm/build/bins/doubles.h"
#include "pcm/build/bins/ingest.h"
#include "pcm/build/bins/partition.h"
#include "pcm/build/bins/position_grid.h"
#include "pcm/build/bins/reader_facts.h"
#include "pcm/build/bins/spool.h"
#include "pcm/build/bins/strided_sample.h"
#include "pcm/build/build_checkpoint.h"
#include "pcm/cloud/vector.h"
#include "pcm/cluster/batch_files.h"
#include "pcm/cluster/batches.h"
#include "pcm/cluster/division_jobs.h"
#include "pcm/cluster/share_jobs.h"
#include "pcm/cluster/shared_record.h"
#include "pcm/cluster/stages.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <utility>

namespace pcm {
namespace {

constexpr JobFolder::Key cuts_job{stage::cuts};

// What a part of the cloud, or all of it, has in common.
struct SpoolFacts {
    std::uint64_t points_in = 0, skipped = 0, rows = 0;
    FarPoints positions;
    std::array<DecimalCount, 3> decimals;
    LateFacts late;

    std::vector<std::byte> bytes() const
    {
        ByteWriter out;
        for (const std::uint64_t number : {points_in, skipped, rows}) out.put(number);
        positions.save(out);
        for (const DecimalCount& count : decimals) count.save(out);
        late.save(out);
        return std::move(out.bytes());
    }
    // Adds those of the part that follows.
    void add(ByteReader& in, FileInfo& info)
    {
        for (std::uint64_t* number : {&points_in, &skipped, &rows}) *number += in.get<std::uint64_t>();
        positions.merge(FarPoints::load(in));
        for (DecimalCount& count : decimals) count.merge(DecimalCount::load(in));
        LateFacts::load(in).add_to(info);
    }
};

class SpoolJobs {
public:
    SpoolJobs(const TeamWork& all, MergedReader& cloud, const FileInfo& header, Ingested& found, BinRows& rows)
        : all_(all),
          cloud_(cloud),
          header_(header),
          found_(found),
          rows_(rows),
          layout_(header_.schema, true),
          parts_(list_parts(cloud))
    {
        found_.schema = header_.schema;
        found_.position_type = header_.position_type;
        for (const char* name : {stage::spools, stage::samples, stage::spooled, stage::cuts}) all_.jobs.begin(name);
    }

    AnyTop run()
    {
        share(stage::spools, count_spools, "Reading points", 0, 0.25, [this](std::size_t part) { spool(part); });
        take_facts();
        if (choose_grid(header_, facts_.positions, found_)) return put_in_bins<std::uint32_t>();
        return put_in_bins<std::uint64_t>();
    }

    // Points where the readers can seek, else sources.
    static std::vector<Batch> list_parts(const MergedReader& cloud)
    {
        const std::vector<std::uint64_t> points = cloud.points_of_sources();
        const std::uint64_t size = batch_size(cloud.info().points);
        if (cloud.seekable()) return batches_of(points, size);
        std::vector<Batch> parts;
        std::uint64_t in_part = size;
        for (std::uint64_t source = 0; source < points.size(); ++source) {
            if (in_part >= size) {
                parts.push_back({source, source});
                in_part = 0;
            }
            in_part += points[source];
            parts.back().end = source + 1;
        }
        return parts;
    }

private:
    template <class Work>
    void share(const char* of_stage, std::uint64_t counter, const char* what, double begin, double end,
               const Work& work)
    {
        share_jobs(
            all_.team, counter, parts_.size(), 1,
            [&](std::size_t part) {
                if (!all_.jobs.is_done({of_stage, part})) work(part);
            },
            [&](std::size_t begun) {
                all_.work.watch.report(what, begin + (end - begin) * static_cast<double>(begun) /
                                                         static_cast<double>(std::max<std::size_t>(1, parts_.size())));
            });
    }

    bool read_next(PointBatch& points, std::uint64_t& left)
    {
        if (left == 0) return false;
        if (!cloud_.read(points, static_cast<std::size_t>(std::min<std::uint64_t>(default_batch_points, left))))
            return false;
        left -= points.size;
        return true;
    }

    void spool(std::size_t part)
    {
        const JobFolder::Key job{stage::spools, part};
        const std::filesystem::path path = all_.jobs.unfinished(job);
        const std::size_t notes = cloud_.info().notes.size(), blocks = cloud_.info().metadata.size();
        std::uint64_t left = ~std::uint64_t(0), bytes = 0;
        if (cloud_.seekable()) {
            cloud_.seek(parts_[part].first);
            left = parts_[part].end - parts_[part].first;
        } else {
            cloud_.keep_sources(parts_[part].first, parts_[part].end);
        }
        SpoolFacts facts;
        ByteWriter blocks_of_rows;
        {
            Spool spool(path, layout_, header_.schema, true, all_.work.space);
            Spool::Writer writer(spool);
            DoubleRows maker(layout_, counts_decimals(header_));
            std::vector<std::byte> rows;
            for (PointBatch points; read_next(points, left); facts.points_in += points.size) {
                look_at(points, facts);
                const std::size_t kept = maker.put(points, rows);
                writer.append(rows.data(), kept);
            }
            if (cloud_.seekable() && left > 0)
                throw Error(ErrorCode::truncated, {},
                            "the input ends at point " + std::to_string(parts_[part].end - left) + ", " +
                                std::to_string(header_.points) + " were expected");
            spool.keep();
            spool.save(blocks_of_rows);
            facts.rows = spool.rows();
            facts.decimals = maker.decimals();
            bytes = spool.bytes();
        }
        facts.late = LateFacts::since(cloud_.info(), notes, blocks);
        ByteWriter record;
        const std::vector<std::byte> head = facts.bytes();
        for (const std::vector<std::byte>& piece : {head, blocks_of_rows.bytes()}) {
            record.put(static_cast<std::uint64_t>(piece.size()));
            record.put_bytes(piece.data(), piece.size());
        }
        all_.jobs.finish(job, path, bytes, record.bytes());
    }

    static void look_at(const PointBatch& points, SpoolFacts& facts)
    {
        for (std::size_t i = 0; i < points.size; ++i) {
            const Vec3d p{points.xyz[0][i], points.xyz[1][i], points.xyz[2][i]};
            if (is_finite(p))
                facts.positions.watch(p);
            else
                ++facts.skipped;
        }
    }

    // Calls see(rows) with the rows of a spool, block by block in the order in which they were read.
    template <class See>
    void read_spool(std::size_t part, const See& see) const
    {
        const std::vector<std::byte> blocks = piece_of(part, blocks_piece);
        const std::filesystem::path path = all_.jobs.file({stage::spools, part});
        ByteReader in(blocks.data(), blocks.size(), path);
        const Spool spool(path, layout_, header_.schema, true, all_.work.space, in);
        std::vector<std::byte> rows;
        for (std::size_t piece = 0; piece < spool.pieces(); ++piece) {
            rows.clear();
            spool.read(piece, rows);
            see(rows);
        }
    }

    enum Piece : std::uint8_t { facts_piece, blocks_piece };
    std::vector<std::byte> piece_of(std::size_t part, Piece piece) const
    {
        const std::vector<std::byte> record = all_.jobs.record({stage::spools, part});
        ByteReader in(record.data(), record.size(), all_.jobs.file({stage::spools, part}));
        for (int before = 0; before < piece; ++before) in.get_bytes(in.get<std::uint64_t>());
        const auto bytes = in.get<std::uint64_t>();
        const std::byte* const from = in.get_bytes(bytes);
        return {from, from + bytes};
    }

    // Collective.
    void take_facts()
    {
        Team& team = all_.team;
        ByteWriter mine;
        for (std::size_t part = team.rank(); part < parts_.size(); part += team.size()) {
            const std::vector<std::byte> head = piece_of(part, facts_piece);
            mine.put_bytes(head.data(), head.size());
        }
        const std::vector<Team::Bytes> all = team.gather(std::move(mine.bytes()));
        std::vector<ByteReader> in;
        for (const Team::Bytes& bytes : all) in.emplace_back(bytes.data(), bytes.size(), all_.work.folder);
        FileInfo info = header_;
        for (std::size_t part = 0; part < parts_.size(); ++part) {
            rows_before_.push_back(facts_.rows);
            facts_.add(in[part % team.size()], info);
        }
        found_.points_in = facts_.points_in;
        found_.points_skipped = facts_.skipped;
        if (facts_.skipped) found_.notes.push_back(note_of_skipped(facts_.skipped));
        for (std::size_t a = 0; a < 3 && counts_decimals(header_); ++a)
            found_.decimals[a] = facts_.decimals[a].places();
        info_ = std::move(info);
    }

    template <class Coord>
    AnyTop put_in_bins()
    {
        found_.layout = RowLayout(found_.schema, sizeof(Coord) == 8);
        const GridRows<Coord> on_grid(found_.grid, found_.decimals);
        const std::vector<std::byte> cuts =
            find_or_make(all_.team, all_.jobs, cuts_job, [&] { return choose_cuts<Coord>(on_grid); });
        ByteReader in(cuts.data(), cuts.size(), all_.jobs.file(cuts_job));
        const auto bins = in.get<std::uint64_t>();
        TopTree<Coord> top = load_top<Coord>(in);
        share(stage::spooled, count_spooled, "Sorting points into bins", 0.25, 0.4,
              [&](std::size_t part) { distribute_spool<Coord>(part, on_grid, top, bins); });
        buffer_ = {};
        const BatchFacts facts = take_batches(all_.team, all_.jobs, stage::spooled, parts_.size(), bins, rows_, info_);
        found_.observed = facts.observed;
        if (!facts.rounded) found_.decimals = {no_decimals, no_decimals, no_decimals};
        take_reader_facts(info_, found_);
        divide_bins<Coord>(all_, found_, top, rows_);
        return top;
    }

    // The positions of every n-th row of the cloud, as one process samples them.
    void sample(std::size_t part)
    {
        const std::uint64_t stride = sample_stride(facts_.rows);
        const std::size_t bytes = 3 * sizeof(double);
        std::uint64_t row = rows_before_[part];
        ByteWriter positions;
        read_spool(part, [&](const std::vector<std::byte>& rows) {
            for (std::size_t at = 0; at < rows.size(); at += layout_.bytes, ++row)
                if (row % stride == 0) positions.put_bytes(rows.data() + at, bytes);
        });
        all_.jobs.write({stage::samples, part}, {}, positions.bytes());
    }

    // Collective; the cuts are rank 0's.
    template <class Coord>
    std::vector<std::byte> choose_cuts(const GridRows<Coord>& on_grid)
    {
        const std::uint64_t per_bin = all_.work.bin_points(facts_.rows);
        const bool is_sampled = facts_.rows > per_bin;
        if (is_sampled)
            share(stage::samples, count_samples, "Reading points", 0.25, 0.27,
                  [this](std::size_t part) { sample(part); });
        if (all_.team.rank() != 0) return {};
        typename TopPlanner<Coord>::Sample sample;
        for (std::size_t part = 0; is_sampled && part < parts_.size(); ++part) {
            const std::vector<std::byte> positions = all_.jobs.record({stage::samples, part});
            for (std::size_t at = 0; at < positions.size(); at += 3 * sizeof(double)) {
                Vec3d p;
                std::memcpy(p.data(), positions.data() + at, sizeof p);
                sample.push_back(on_grid.on_grid(p));
            }
        }
        TopTree<Coord> top;
        std::size_t bins = 1;
        if (!sample.empty())
            bins = TopPlanner<Coord>(top, axis_shift(found_.grid), per_bin).plan(0, sample, facts_.rows, 0);
        ByteWriter cuts;
        cuts.put(static_cast<std::uint64_t>(bins));
        save_top(top, cuts);
        return std::move(cuts.bytes());
    }

    template <class Coord>
    void distribute_spool(std::size_t part, const GridRows<Coord>& on_grid, const TopTree<Coord>& top, std::size_t bins)
    {
        const JobFolder::Key job{stage::spooled, part};
        const std::filesystem::path path = all_.jobs.unfinished(job);
        BatchFacts facts;
        ByteWriter record;
        std::uint64_t bytes = 0;
        {
            Scratch scratch(path, found_.layout, found_.schema, all_.work.space);
            scratch.add_bins(bins);
            Scratch::Writer writer(scratch, 0, bins, all_.work.memory_bytes / 4, std::move(buffer_));
            read_spool(part, [&](std::vector<std::byte>& rows) {
                for (std::size_t at = 0; at < rows.size(); at += layout_.bytes) {
                    const std::byte* const row =
                        on_grid.convert(rows.data() + at, found_.layout.bytes, facts.observed, facts.rounded);
                    writer.add(top.bin_of(coordinates_of<Coord>(row)), row);
                }
            });
            writer.flush();
            buffer_ = writer.take_buffer();
            bytes = scratch.bytes();
            save_batch(facts, scratch, record);
        }
        all_.jobs.finish(job, path, bytes, record.bytes());
    }

    const TeamWork& all_;
    MergedReader& cloud_;
    const FileInfo& header_;
    Ingested& found_;
    BinRows& rows_;
    const RowLayout layout_;  // spools' rows
    const std::vector<Batch> parts_;
    SpoolFacts facts_;                        // those of all parts
    std::vector<std::uint64_t> rows_before_;  // number of rows in the parts before each
    std::vector<std::byte> buffer_;           // memory of a Scratch::Writer
    FileInfo info_;                           // with what was found while points were read
};

}  // namespace

bool can_be_spooled(const MergedReader& cloud, const ReadOptions& options)
{
    if (options.skip_bad_files || options.skip_bad_lines || options.largest_coordinate) return false;
    if (cloud.info().grid) return false;
    return SpoolJobs::list_parts(cloud).size() > 1;
}

AnyTop spool_input(const TeamWork& team_work, MergedReader& cloud, const FileInfo& header, Ingested& found,
                   BinRows& rows)
{
    return SpoolJobs(team_work, cloud, header, found, rows).run();
}

}  // namespace pcm
