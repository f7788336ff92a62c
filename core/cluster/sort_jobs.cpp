#include "pcm/cluster/sort_jobs.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/levels/morton_sort.h"
#include "pcm/cluster/share_jobs.h"

namespace pcm {
namespace {

constexpr const char* bins_stage = "bins";

}  // namespace

template <class Coord>
BinFiles<Coord>::BinFiles(const TeamWork& team_work, const Ingested& cloud, std::size_t bins)
    : all_(team_work),
      cloud_(cloud),
      finer_(axis_shift(cloud.grid)),
      sorted_(
          [&jobs = team_work.jobs](std::size_t bin) {
              return File(jobs.file({bins_stage, bin}), File::Mode::read);
          },
          cloud.layout, cloud.schema, team_work.work.space),
      count_(bins)
{
    sorted_.resize(bins);
}

template <class Coord>
void BinFiles<Coord>::sort(const BinRows& rows)
{
    all_.jobs.begin(bins_stage);
    std::vector<std::size_t> filled;
    for (std::size_t bin = 0; bin < count_; ++bin)
        if (rows.rows(bin) > 0) filled.push_back(bin);
    share_jobs(
        all_.team, count_bins, filled.size(), all_.work.bin_threads(cloud_.layout, cloud_.observed.points),
        [&](std::size_t i) {
            if (!all_.jobs.is_done({bins_stage, filled[i]})) sort_bin(filled[i], rows);
        },
        [&](std::size_t begun) {
            all_.work.watch.report("Sorting points",
                                   0.4 + 0.1 * static_cast<double>(begun) / static_cast<double>(filled.size() + 1));
        });
    // Each rank reads the boxes of some.
    ByteWriter boxes;
    for (std::size_t i = all_.team.rank(); i < filled.size(); i += all_.team.size()) {
        load(filled[i]);
        const auto& box = sorted_.points().box(filled[i]);
        boxes.put(box.points);
        for (const Point<Coord>* p : {&box.low, &box.high})
            for (const Coord c : *p) boxes.put(c);
    }
    const std::vector<Team::Bytes> all = all_.team.gather(std::move(boxes.bytes()));
    std::vector<ByteReader> in;
    for (const Team::Bytes& bytes : all) in.emplace_back(bytes.data(), bytes.size(), all_.work.folder);
    for (std::size_t i = 0; i < filled.size(); ++i) {
        ByteReader& from = in[i % all_.team.size()];
        typename SortedPoints<Coord>::Box box;
        box.points = from.template get<std::uint64_t>();
        for (Point<Coord>* p : {&box.low, &box.high})
            for (Coord& c : *p) c = from.template get<Coord>();
        if (box.points != rows.rows(filled[i]))
            throw Error(ErrorCode::corrupt, all_.jobs.file({bins_stage, filled[i]}),
                        "the bin has " + std::to_string(box.points) + " points, " +
                            std::to_string(rows.rows(filled[i])) + " were expected",
                        "remove " + all_.work.folder.string() + " and build again");
        sorted_.set_box(filled[i], box);
    }
}

template <class Coord>
void BinFiles<Coord>::sort_bin(std::size_t bin, const BinRows& rows)
{
    const std::vector<std::byte> unsorted = rows.read(bin);
    const std::size_t count = unsorted.size() / cloud_.layout.bytes;
    const std::vector<std::byte> data =
        sorted_.packed(bin, unsorted, morton_order<Coord>(unsorted.data(), count, cloud_.layout, finer_));
    ByteWriter record;
    sorted_.save(bin, record);
    all_.jobs.write({bins_stage, bin}, data, record.bytes());
}

template <class Coord>
void BinFiles<Coord>::load(std::size_t bin)
{
    const std::vector<std::byte> record = all_.jobs.record({bins_stage, bin});
    ByteReader in(record.data(), record.size(), all_.work.folder);
    sorted_.load(bin, in);
}

template class BinFiles<std::uint32_t>;
template class BinFiles<std::uint64_t>;

}  // namespace pcm
