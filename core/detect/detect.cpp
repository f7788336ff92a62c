// How primitives are found in a cloud that is larger than memory:
//
// 1. Survey (cloud_survey.h): spacing and noise at a few places. From them come the threshold, and the size of the
//    cells of which one point each is looked at: shapes need many points, but none nearer than their noise is wide.
//    A part of the cloud that has far less noise than the rest is searched by itself, with a survey of its own
//    (quiet_part()), and both results are joined (joined_report.h).
// 2. Search, from coarse to fine: at each resolution the cloud is divided into boxes of about as many sample points,
//    which are searched by all threads (shape_search.h), without points that coarser shapes explain. So a large shape
//    is found in one piece, and a small one at the density that shows it. Shapes of different boxes that are one
//    surface are brought together (hypotheses.h).
//    Pieces cut out of surfaces that are rougher than the cloud's noise get wider thresholds (wider_shapes.h).
// 3. Assignment (assign_points.h): box by box each point of the whole cloud is given to the nearest surface; connected
//    parts are found in each box and joined across borders. Parts of a plane that something before it divides are one,
//    as are pieces of a pipe that have too few points (part_joining.h), the two faces of a thin plate two
//    (whole_parts.h); other surfaces that are one plane or cylinder, but not connected, are two.
// 4. Two passes of least squares over all points of each part (fit/shape_sums.h), without those next to something else
//    where the rest is enough: by their neighbours, or by the outlines of narrow faces (face_interior.h). Labels of
//    points that are not within the threshold of the final shape are taken back. Where the threshold comes from the
//    noise, shapes whose bend it hides are refused (sagitta.h), so that
// 5. a second search of the points that belong to nothing, or to contested planes (final_fit.h), at half the threshold
// and without a coarser sample, finds thin pipes (pipe_search.h) and narrow planes.
#include "pcm/detect/detect.h"

#include "pcm/detect/assign_points.h"
#include "pcm/detect/cloud_survey.h"
#include "pcm/detect/errors_of_stations.h"
#include "pcm/detect/final_fit.h"
#include "pcm/detect/hypotheses.h"
#include "pcm/detect/joined_report.h"
#include "pcm/detect/pipe_search.h"
#include "pcm/detect/point_labels.h"
#include "pcm/detect/sample_units.h"
#include "pcm/detect/shape_search.h"
#include "pcm/detect/shared_points.h"
#include "pcm/detect/surface_sample.h"
#include "pcm/detect/tuning.h"
#include "pcm/detect/whole_parts.h"
#include "pcm/detect/wider_shapes.h"
#include "pcm/fit/models/shape_model.h"
#include "pcm/system/counted.h"
#include "pcm/system/error.h"
#include "pcm/system/progress_part.h"
#include "pcm/system/text.h"
#include "pcm/threads/for_each_index.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t most_unit_points = 220000;
constexpr std::uint64_t unit_bytes = std::uint64_t(72) << 20;  // memory of a thread for them
constexpr std::uint64_t survey_points = 5000;                  // points of a place
// Clouds of any size with the same surfaces have nearly the same medians over this number of places.
constexpr std::size_t survey_places = 96;
constexpr std::uint64_t region_points = 40000;  // points of a region whose noise is compared with the cloud's
constexpr double most_step_cells = 128;  // cells of the sample in a step: all within a step of a unit is in memory
constexpr double margin_cells = 8;

struct Resolution {
    SampleSettings sample;
    std::vector<Box3i> units;
};

// "plane, cylinder or sphere", "planes, cylinders and spheres"
std::string detected_names(const std::string& ending, const std::string& last)
{
    const std::vector<ShapeKind> kinds = detected_kinds();
    std::string names;
    for (std::size_t i = 0; i < kinds.size(); ++i)
        names += (i == 0 ? "" : i + 1 < kinds.size() ? ", " : last) + (traits_of(kinds[i]).name + ending);
    return names;
}

void check(const DetectOptions& options, const std::filesystem::path& tree)
{
    const auto refuse = [&](const std::string& what) { throw Error(ErrorCode::invalid_argument, tree, what); };
    if (options.kinds.empty()) refuse("no kind of shape is to be detected; choose " + detected_names("", " or "));
    for (const ShapeKind kind : options.kinds)
        if (!model_of(kind).like)
            refuse("detection finds " + detected_names("s", " and ") + "; a " + traits_of(kind).name +
                   " is found at a picked place (pcmlab fit)");
    const auto distance = [&](double value, const char* name) {
        if (!(value >= 0) || !std::isfinite(value))
            refuse("the " + std::string(name) + " is " + exact(value) +
                   "; it is a positive number of source units, or 0 to be found");
    };
    distance(options.threshold, "threshold");
    distance(options.step, "step");
    if (!(options.normal_angle > 0) || !std::isfinite(options.normal_angle))
        refuse("the largest angle of normals is " + exact(options.normal_angle) + "; it is above 0, in radians");
    if (!(options.registration >= 0) || !std::isfinite(options.registration))
        refuse("the registration is within " + exact(options.registration) +
               "; it is a positive number of millimetres");
    if (options.least_points < 20)
        refuse("primitives of " + std::to_string(options.least_points) +
               " points cannot be detected; 20 are the least");
}

struct Found {
    DetectReport report;
    std::vector<bool> contested;  // keyed by label - 1, see FinalFit
    StationShifts shifts;

    // Number of points that a second search looks at.
    std::uint64_t left() const
    {
        std::uint64_t count = report.outcome.points_in - report.outcome.points_out;
        for (std::size_t i = 0; i < contested.size(); ++i)
            if (contested[i]) count += report.primitives[i].points;
        return count;
    }
};

class Detection {
public:
    // `first`: what was found in this part; those points are searched again that belong to none of it, or to what is
    // contested. Null: all are.
    Detection(const std::shared_ptr<const Tree>& tree, const DetectOptions& options, CloudPart part = {},
              const Found* first = nullptr)
        : tree_(tree),
          options_(options),
          points_(tree, options.limit, std::move(part),
                  first ? TakenPoints{first->report.labels, first->contested} : TakenPoints()),
          units_(points_, first ? left_share(*first, *tree) : 1),
          watch_(options.progress),
          is_again_(first != nullptr)
    {
        const std::uint64_t most = std::max<std::uint64_t>(1, options.memory_bytes / unit_bytes);
        threads_ = static_cast<unsigned>(std::min<std::uint64_t>(thread_count(options.threads), most));
        if (!first) return;
        set_finer_than(first->report);
        shifts_ = first->shifts;
    }

    // The part that has to be searched by itself; the whole: none has.
    CloudPart quiet()
    {
        if (!survey() || !is_automatic()) return {};
        return quiet_part(points_, units_.with_points(region_points), units_.with_points(4 * region_points), survey_,
                          repeated_, [&] { watch_.report("Looking at the cloud", 0.01); });
    }

    // After quiet(), or for a part.
    Found run()
    {
        report_.labels = std::make_shared<PointLabels>(*tree_);
        if (survey()) {
            for (Resolution& resolution : resolutions()) search(resolution);
            if (is_automatic() && !is_again_) widen();
            settle();
        }
        report_.outcome.seconds = watch_.seconds();
        report_.outcome.error = report_.threshold;
        for (const Primitive& one : report_.primitives)
            report_.outcome.error = std::max(report_.outcome.error, one.fit.threshold);
        report_.outcome.error_meaning = "largest distance of a point from its primitive, source units";
        watch_.finish("Done");
        return {std::move(report_), std::move(contested_), std::move(shifts_)};
    }

private:
    // Whether thresholds come from the noise.
    bool is_automatic() const { return !(options_.threshold > 0); }

    static double left_share(const Found& first, const Tree& tree)
    {
        return std::max(1.0, static_cast<double>(first.left())) /
               static_cast<double>(std::max<std::uint64_t>(1, tree.info().points));
    }

    void set_finer_than(const DetectReport& first)
    {
        is_surveyed_ = true;
        report_.spacing = first.spacing;
        report_.noise = first.noise;
        report_.threshold = detect_tuning().pipes.threshold_share * first.threshold;
        report_.step = options_.step;
        report_.sample = detect_tuning().pipes.cell * report_.threshold;
        if (options_.step > 0) report_.sample = std::min(report_.sample, options_.step / 2);
    }

    bool survey()
    {
        if (is_surveyed_) return report_.spacing > 0;
        is_surveyed_ = true;
        watch_.report("Looking at the cloud", 0, true);
        const std::vector<Box3i> all = units_.with_points(survey_points);
        std::vector<Box3i> places;
        const std::size_t count = std::min(all.size(), survey_places);
        for (std::size_t i = 0; i < count; ++i) places.push_back(all[(2 * i + 1) * all.size() / (2 * count)]);
        const CloudSurvey& found = survey_ = survey_of(places);
        report_.spacing = found.spacing;
        report_.noise = found.noise;
        if (!(found.spacing > 0)) {
            report_.notes.push_back("there are too few points at different places to find shapes in");
            return false;
        }
        const Vec3d& step = tree_->info().grid.scale;
        const double resolution = std::max(2 * largest_magnitude(step), 0.02 * found.spacing);
        const double noises = detect_tuning().survey.threshold_noises;
        report_.threshold = options_.threshold > 0 ? options_.threshold : std::max(noises * found.noise, resolution);
        report_.step = options_.step;
        const double noise = options_.threshold > 0 ? std::min(found.noise, options_.threshold / noises) : found.noise;
        report_.sample = std::max(tuned_.cell_spacings * found.spacing, tuned_.cell_noises * noise);
        if (options_.step > most_step_cells * report_.sample)
            throw Error(ErrorCode::invalid_argument, tree_->folder(),
                        "the longest step of " + exact(options_.step) + " is far above the cloud's spacing of " +
                            brief(found.spacing) + ": points are connected by steps of up to " +
                            brief(most_step_cells * report_.sample),
                        "give a shorter step, or 0 for what the spacing allows; or detect in a thinner cloud (pcmlab "
                        "subsample)");
        if (options_.step > 0) report_.sample = std::min(report_.sample, options_.step / 2);
        return true;
    }

    // The spacing of points that are repeated several times is 0.
    CloudSurvey survey_of(const std::vector<Box3i>& places)
    {
        const auto check = [&] { watch_.report("Looking at the cloud", 0.01); };
        const CloudSurvey found = survey_cloud(points_, places, repeated_, check);
        if (found.spacing > 0) return found;
        repeated_ = Repeated::once;
        return survey_cloud(points_, places, repeated_, check);
    }

    std::vector<Resolution> resolutions() const
    {
        std::vector<Resolution> all;
        double cell = report_.sample;
        for (;; cell *= tuned_.coarser) {
            Resolution resolution;
            resolution.sample = {units_.level_of(all.empty() ? 0 : cell), cell, margin_cells * cell, options_.step,
                                 most_unit_points};
            resolution.units = units_.with_cell(cell);
            all.push_back(std::move(resolution));
            if (is_again_ || all.back().units.size() <= 1 || cell > tree_->info().bounds().diagonal()) break;
        }
        std::reverse(all.begin(), all.end());
        return all;
    }

    void search(Resolution& resolution)
    {
        std::vector<std::vector<Hypothesis>> found(resolution.units.size());
        const double end = progress_ + 0.3 * (0.6 - progress_) + (resolution.units.size() > 1 ? 0.2 : 0);
        const double part = (std::min(0.6, end) - progress_) / static_cast<double>(found.size());
        for_each_index(
            found.size(), threads_,
            [&](std::size_t u, const Stop& stop) { found[u] = search_unit(resolution, resolution.units[u], stop); },
            [&](std::size_t begun) {
                watch_.report("Searching shapes", progress_ + part * static_cast<double>(begun));
            });
        progress_ = std::min(0.6, end);
        for (std::vector<Hypothesis>& some : found)
            for (Hypothesis& one : some) hypotheses_.push_back(std::move(one));
        hypotheses_ = merged(std::move(hypotheses_), merge_options(resolution.sample.cell));
    }

    MergeOptions merge_options(double cell) const
    {
        MergeOptions merge;
        merge.gap = std::max(tuned_.reach_cells * cell, options_.step);
        merge.normal_angle = options_.normal_angle;
        return merge;
    }

    AssignOptions assign_options(double cell, double begin, double end)
    {
        AssignOptions assign;
        assign.sample = {units_.level_of(cell > report_.sample ? cell : 0), cell,
                         std::max(margin_cells * cell, 1.01 * options_.step), options_.step, most_unit_points};
        assign.normal_angle = options_.normal_angle;
        assign.reach = tuned_.reach_cells * cell;
        assign.least_points = options_.least_points;
        assign.threads = threads_;
        assign.progress = [this, begin, end](double fraction) {
            watch_.report("Assigning points", begin + (end - begin) * fraction);
        };
        return assign;
    }

    void widen()
    {
        const auto sample = [&](double cells) {
            const double cell = cells * report_.sample;
            return WidenSample{assign_options(cell, 0.6, 0.65), units_.with_cell(cell)};
        };
        WidenOptions widen;
        widen.fine = sample(detect_tuning().widening.cells);
        widen.coarse = sample(detect_tuning().widening.coarse_cells);
        widen.merge = merge_options(detect_tuning().widening.cells * report_.sample);
        hypotheses_ = with_wider_shapes(points_, std::move(hypotheses_), widen);
    }

    std::vector<Hypothesis> search_unit(const Resolution& resolution, const Box3i& box, const Stop& stop) const
    {
        std::vector<Hypothesis> found;
        SampleSettings settings = resolution.sample;
        settings.check = [&] { stop.check(); };
        for_each_sample(points_, box, settings, [&](const Box3i&, const SurfaceSample& sample) {
            search_sample(resolution, sample, settings.check, found);
        });
        return found;
    }

    void search_sample(const Resolution& resolution, const SurfaceSample& sample, const std::function<void()>& check,
                       std::vector<Hypothesis>& found) const
    {
        std::vector<std::uint8_t> taken(sample.size(), 0);
        ExplainedLimits explained;
        explained.threshold = detect_tuning().search.shadow * report_.threshold;
        explained.reach = tuned_.reach_cells * resolution.sample.cell;
        explained.normal_angle = options_.normal_angle;
        mark_explained(sample, hypotheses_, explained, taken);
        if (is_again_ && wants(ShapeKind::cylinder)) {
            PipeSearchOptions pipes;
            pipes.threshold = report_.threshold;
            pipes.noise = report_.noise;
            pipes.least = least_sampled(resolution);
            pipes.seed = options_.seed;
            pipes.check = check;
            for (const FoundShape& pipe : search_pipes(sample, pipes, taken))
                found.push_back(hypothesis_of(pipe, sample, resolution.sample.cell));
        }
        ShapeSearchOptions search;
        // What is round and left is a part of cones, elbows and edges, but for thin pipes.
        for (const ShapeKind kind : options_.kinds)
            if (!is_again_ || traits_of(kind).is_flat()) search.kinds.push_back(kind);
        if (search.kinds.empty()) return;
        search.pipes_of_strips = wants(ShapeKind::cylinder);
        search.threshold = report_.threshold;
        search.normal_angle = options_.normal_angle;
        search.seed = options_.seed;
        if (is_automatic()) search.least_sagitta = detect_tuning().search.sagitta_thresholds * report_.threshold;
        search.least = least_sampled(resolution);
        search.check = check;
        for (const FoundShape& shape : search_shapes(sample, search, taken))
            found.push_back(hypothesis_of(shape, sample, resolution.sample.cell));
    }

    bool wants(ShapeKind kind) const
    {
        return std::find(options_.kinds.begin(), options_.kinds.end(), kind) != options_.kinds.end();
    }

    std::size_t least_sampled(const Resolution& resolution) const
    {
        return resolution.sample.cell > report_.sample
                   ? tuned_.min_coarse_points
                   : std::max<std::size_t>(20, static_cast<std::size_t>(options_.least_points / 8));
    }

    Hypothesis hypothesis_of(const FoundShape& shape, const SurfaceSample& sample, double cell) const
    {
        Hypothesis one;
        one.shape = shape.shape;
        one.shape.point = one.shape.point + sample.origin;
        one.area = static_cast<double>(shape.points.size()) * cell * cell;
        one.rms = shape.rms;
        one.threshold = shape.threshold;
        one.thin = one.whole = shape.thin;
        one.of_strip = shape.of_strip;
        one.reach = tuned_.edge_cells * cell;
        for (const std::uint32_t i : shape.points) one.box.extend(sample.origin + sample.at[i]);
        const std::size_t some = std::min(hypothesis_points, shape.points.size());
        for (std::size_t i = 0; i < some; ++i)
            one.some.push_back(sample.origin + sample.at[shape.points[i * shape.points.size() / some]]);
        return one;
    }

    // Which points belong to which primitive, and what these are.
    void settle()
    {
        const std::vector<Box3i> units = units_.with_cell(report_.sample);
        auto labels = std::make_shared<PointLabels>(*tree_);
        const AssignOptions assign = assign_options(report_.sample, 0.65, 0.85);
        WholePartOptions whole{report_.spacing, report_.noise, report_.threshold, is_automatic(), !is_again_, {}};
        whole.check = [&] { watch_.report("Assigning points", 0.85); };
        const AssignedPoints assigned = assign_whole(points_, units, hypotheses_, assign, whole, shifts_, *labels);
        FinalFitOptions fit;
        fit.least_points = options_.least_points;
        fit.keep_pieces = options_.pieces;
        fit.is_automatic = is_automatic();
        fit.noise = report_.noise;
        fit.cell = report_.sample;
        fit.only_good = is_again_;
        fit.shifts = shifts_;
        fit.threads = threads_;
        fit.progress = [&](double fraction) { watch_.report("Fitting primitives", 0.85 + 0.14 * fraction); };
        FinalFit result = fit_parts(points_, hypotheses_, assigned, *labels, fit);
        if (result.pieces > 0 && !options_.pieces)
            report_.notes.push_back(grouped(result.piece_points) + " points lie on " + counted(result.pieces, "piece") +
                                    " of surfaces that continue smoothly beyond the threshold (ground, or what the "
                                    "threshold is too small for); they were left out");
        if (result.other_kinds > 0)
            report_.notes.push_back(grouped(result.other_points) + " points lie on " +
                                    counted(result.other_kinds, "piece") +
                                    " of cones or the like, left out; fit there");
        if (result.unbounded > 0)
            report_.notes.push_back(counted(result.unbounded, "primitive", "has", "have") +
                                    " no outline: the points are all on one line");
        report_.primitives = std::move(result.primitives);
        report_.agreement = std::move(result.agreement);
        contested_ = std::move(result.contested);
        report_.labels = labels;
        report_.outcome.points_in = assigned.looked_at;
        for (const Primitive& primitive : report_.primitives) report_.outcome.points_out += primitive.points;
    }

    const std::shared_ptr<const Tree> tree_;
    const DetectOptions& options_;
    const ResolutionTuning& tuned_ = detect_tuning().resolution;
    const ChosenPoints points_;
    const SampleUnits units_;
    Watch watch_;
    unsigned threads_ = 1;
    const bool is_again_ = false;  // the second search: finer, of points that are left
    bool is_surveyed_ = false;
    double progress_ = 0.02;
    std::vector<Hypothesis> hypotheses_;
    CloudSurvey survey_;
    Repeated repeated_ = Repeated::counted;
    DetectReport report_;
    std::vector<bool> contested_;
    StationShifts shifts_;
};

// What was found, and what a second search at a finer threshold finds among the points that are left: pipes that the
// first one is too coarse for.
DetectReport with_finer_shapes(const std::shared_ptr<const Tree>& tree, const DetectOptions& options,
                               const CloudPart& part, Found found)
{
    DetectReport& first = found.report;
    if (options.threshold > 0 || !(first.spacing > 0) || found.left() < options.least_points) {
        Watch watch(options.progress);
        watch.report("Searching shapes", 0, true);
        watch.finish("Done");
        return std::move(first);
    }
    DetectReport finer = Detection(tree, options, part, &found).run().report;
    finer.outcome.points_in = 0;  // they were counted
    finer.notes.clear();          // as were its pieces of surfaces
    return joined(*tree, std::move(first), std::move(finer), options.least_points);
}

// Options whose progress is a part of the whole one's.
DetectOptions within(const DetectOptions& options, double begin, double end)
{
    DetectOptions part = options;
    part.progress = part_of(options.progress, begin, end);
    return part;
}

DetectReport found_primitives(const std::shared_ptr<const Tree>& tree, const DetectOptions& options)
{
    const DetectOptions first = within(options, 0, 0.8), second = within(options, 0.8, 1);
    Detection whole(tree, first);
    const CloudPart quiet = whole.quiet();
    if (quiet.is_whole()) return with_finer_shapes(tree, second, {}, whole.run());
    const auto search = [&](const CloudPart& part, double begin, double end) {
        const double middle = begin + 0.8 * (end - begin);
        const DetectOptions coarse = within(options, begin, middle), fine = within(options, middle, end);
        return with_finer_shapes(tree, fine, part, Detection(tree, coarse, part).run());
    };
    DetectReport rest = search(quiet.others(), 0.02, 0.5);
    DetectReport found = search(quiet, 0.5, 1);
    rest.notes.push_back(grouped(found.outcome.points_in) +
                         " points have far less noise than the others; shapes there were searched by themselves: "
                         "threshold " +
                         brief(found.threshold) + ", noise " + brief(found.noise) + ", spacing " +
                         brief(found.spacing));
    return joined(*tree, std::move(rest), std::move(found), options.least_points);
}

}  // namespace

std::vector<ShapeKind> detected_kinds()
{
    std::vector<ShapeKind> kinds;
    for (const ShapeTraits& row : shape_kinds())
        if (model_of(row.kind).like) kinds.push_back(row.kind);
    return kinds;
}

DetectReport detect_primitives(const std::shared_ptr<const Tree>& tree, const DetectOptions& options)
{
    check(options, tree->folder());
    DetectReport found = found_primitives(tree, within(options, 0, 0.93));
    if (options.threshold == 0) doubt_shared_points(tree, within(options, 0.93, 0.95), found);
    add_errors_of_stations(tree, within(options, 0.95, 1), found);
    return found;
}

}  // namespace pcm
