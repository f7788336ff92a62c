// Sums over the points of a set with the stations that they were measured from.
#pragma once

#include "pcm/place/point_stations.h"
#include "pcm/query/point_set.h"
#include "pcm/select/point_scan.h"
#include "pcm/system/progress.h"
#include "pcm/tree/source_rounding.h"

#include <cstdint>
#include <map>
#include <mutex>
#include <utility>

namespace pcm {

class StationScan {
public:
    struct Options {
        unsigned threads = 0;  // 0: one per processor
        ProgressFunction progress;
        int passes = 1;  // number of calls of sums() that are expected, for the progress
    };

    // Keeps references.
    StationScan(const PointSet& points, const PointStations& stations, Options options)
        : points_(points),
          tree_(points.tree()),
          rounding_(tree_.info()),
          stations_(stations),
          options_(std::move(options))
    {
    }

    // Calls see(part, place, station) for each point with a part of its node, which begins as a copy of `empty`, and
    // adds the parts in the nodes' order.
    template <class Part, class See>
    Part sums(const Part& empty, const See& see)
    {
        std::map<NodeId, Part> parts;
        std::mutex mutex;
        ScanOptions scan;
        scan.within = &points_;
        scan.columns = stations_.columns();
        scan.select.threads = options_.threads;
        scan.select.progress = options_.progress;
        scan.stage = "Comparing stations";
        scan.begin = static_cast<double>(passes_++) / options_.passes;
        scan.end = static_cast<double>(passes_) / options_.passes;
        scan_points(tree_, {}, scan, [&](const ScannedPoints& found) {
            Part part = empty;
            for (const std::uint32_t i : found.indices)
                see(part, rounding_(tree_.info().grid.to_source(found.part.chunk.positions->grid(i))),
                    stations_.at(found.part.chunk, i));
            const std::lock_guard lock(mutex);
            parts.emplace(found.node, std::move(part));
        });
        Part all = empty;
        for (const auto& [node, part] : parts) add(all, part);
        return all;
    }

private:
    static void add(Box3d& to, const Box3d& from) { to.extend(from); }
    template <class Part>
    static void add(Part& to, const Part& from)
    {
        to.add(from);
    }

    const PointSet& points_;
    const Tree& tree_;
    const SourceRounding rounding_;
    const PointStations& stations_;
    const Options options_;
    int passes_ = 0;
};

}  // namespace pcm
