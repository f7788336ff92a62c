#include "pcm/fit/pcl_fit.h"

#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/pcl/pcl_module.h"
#include "pcm/fit/shape_sums.h"
#include "pcm/system/error.h"
#include "pcm/system/seconds.h"
#include "pcm/system/shared_module.h"

#include <algorithm>
#include <chrono>
#include <exception>

namespace pcm {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* module_file = "libpcm_pcl.so";

const SharedModule& module()
{
    static const SharedModule loaded = load_shared_module(module_file, pcl_module_symbol, pcl_module_version);
    return loaded;
}

struct Extent {
    Vec3d low{}, high{};

    Vec3d middle() const { return low + 0.5 * (high - low); }
    double half_diagonal() const { return 0.5 * length(high - low); }
    void add(const Vec3d& p)
    {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    }
};

// Ends PCL's search: at the time limit, or when the caller cancels or throws, which PCL must not see.
struct Stop {
    const ShapeFitOptions& options;
    Clock::time_point begin = Clock::now(), reported = begin;
    bool cancelled = false;
    std::exception_ptr thrown{};

    bool now()
    {
        if (options.seconds <= 0 && !options.progress) return false;
        const Clock::time_point time = Clock::now();
        if (options.seconds > 0 && std::chrono::duration<double>(time - begin).count() >= options.seconds) return true;
        if (!options.progress || time - reported < std::chrono::milliseconds(200)) return false;
        reported = time;
        try {
            cancelled = !options.progress({"Fitting with PCL", 0, -1});
        } catch (...) {
            thrown = std::current_exception();
        }
        return cancelled || thrown;
    }
};

void refuse(ShapeFit& fit, FitIssue issue, std::string message)
{
    fit.verdict = FitVerdict::refused;
    fit.issue = issue;
    fit.message = std::move(message);
}

bool takes_part(const FitPoints& points, std::size_t i, const Shape& shape, const ShapeFitOptions& options,
                double threshold)
{
    const Vec3d p = points.source(i);
    if (distance_to(shape, p) > threshold) return false;
    if (options.normal_angle >= pi / 2 || !points.has_normals()) return true;
    const Vec3d normal = points.normal(i);
    if (!(dot(normal, normal) > 0)) return true;  // it has none
    return std::fabs(dot(normal, normal_at(shape, p))) >= std::cos(options.normal_angle);
}

Extent extent_of(const FitPoints& points)
{
    Extent extent{points.at(0), points.at(0)};
    for (std::size_t i = 0; i < points.size(); ++i) extent.add(points.at(i));
    return extent;
}

}  // namespace

bool has_pcl() { return has_shared_module(module_file); }

std::string why_no_pcl() { return module().functions ? std::string() : module().missing; }

bool pcl_has(ShapeKind kind) { return model_of(kind).pcl; }

PclShape pcl_shape(const FitPoints& points, const ShapeFitOptions& options, const PclOptions& pcl)
{
    if (!module().functions)
        throw Error(ErrorCode::unsupported, {}, "the backend PCL is not here: " + module().missing,
                    "install libpcm_pcl.so (built where packaging/pcl-sdk has put PCL's headers) and PCL (Debian: "
                    "libpcl-sample-consensus1.13), or choose the backend own");
    if (!pcl_has(options.kind))
        throw Error(ErrorCode::unsupported, {}, "the backend PCL has no " + std::string(traits_of(options.kind).name),
                    "choose another shape, or the backend own");
    PclRequest request{};
    const ShapeModel& model = model_of(options.kind);
    request.model = model.pcl->model;
    request.estimator = options.estimator;
    Stop stop{options};
    if (points.size() == 0) return {};
    const bool with_normals = model.needs_normals;
    if (with_normals && !points.has_normals()) {
        FitPoints copy = points;
        estimate_normals(copy);
        return pcl_shape(copy, options, pcl);
    }

    const Extent extent = extent_of(points);
    const Vec3d middle = extent.middle();
    std::vector<float> xyz(3 * points.size()), normals(with_normals ? 3 * points.size() : 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3d p = points.at(i) - middle;
        for (std::size_t axis = 0; axis < 3; ++axis) xyz[3 * i + axis] = static_cast<float>(p[axis]);
        if (!with_normals) continue;
        const Vec3d n = points.normal(i);
        for (std::size_t axis = 0; axis < 3; ++axis) normals[3 * i + axis] = static_cast<float>(n[axis]);
    }
    request.xyz = xyz.data();
    request.normals = with_normals ? normals.data() : nullptr;
    request.points = points.size();
    request.threshold = options.threshold > 0 ? options.threshold : automatic_threshold(points);
    request.probability = options.probability;
    request.least_radius = options.least_radius;
    request.largest_radius = std::min(options.largest_radius, std::numeric_limits<double>::max());
    request.iterations = options.iterations;
    request.seed = static_cast<std::uint32_t>(options.seed);
    request.pretest = 100 * static_cast<double>(pcl.pretest) / static_cast<double>(points.size());
    request.optimise = pcl.optimise;
    request.stop = [](void* context) { return static_cast<Stop*>(context)->now(); };
    request.context = &stop;

    PclAnswer answer{};
    char message[pcl_message_bytes] = "";
    const bool found = static_cast<const PclFunctions*>(module().functions)->fit(request, answer, message);
    if (stop.thrown) std::rethrow_exception(stop.thrown);
    if (stop.cancelled) throw Error(ErrorCode::cancelled, {}, "the fit was cancelled");
    if (message[0]) throw Error(ErrorCode::invalid_argument, {}, std::string("PCL: ") + message);
    PclShape result;
    result.samples = answer.samples;
    if (!found) return result;
    result.shape = model.pcl->shape_of(answer.coefficients, points.origin + middle);
    result.found = is_proper(result.shape);
    return result;
}

ShapeFit pcl_fit(const FitPoints& points, const ShapeFitOptions& options)
{
    const Clock::time_point begin = Clock::now();
    ShapeFit fit;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (is_finite(points.at(i))) continue;
        refuse(fit, FitIssue::not_finite, "Point " + std::to_string(i) + " has a coordinate that is NaN or infinite.");
        return fit;
    }
    ShapeFitOptions with_threshold = options;
    if (options.threshold <= 0) with_threshold.threshold = automatic_threshold(points);
    const double threshold = with_threshold.threshold;
    const PclShape found = pcl_shape(points, with_threshold);
    std::vector<std::uint8_t> is_inlier(points.size());
    Extent extent;
    std::uint64_t inliers = 0;
    for (std::size_t i = 0; found.found && i < points.size(); ++i) {
        is_inlier[i] = takes_part(points, i, found.shape, options, threshold);
        if (!is_inlier[i]) continue;
        if (inliers++ == 0) extent = {points.at(i), points.at(i)};
        extent.add(points.at(i));
    }
    if (inliers == 0) {
        refuse(fit, FitIssue::no_consensus,
               "PCL found no shape that fits the points: choose a larger threshold or more iterations.");
    } else {
        ShapeSums sums(found.shape, points.origin + extent.middle(), extent.half_diagonal());
        for (std::size_t i = 0; i < points.size(); ++i)
            if (is_inlier[i]) sums.add(points.source(i));
        fit = sums.result(threshold);
        fit.is_inlier = std::move(is_inlier);
    }
    fit.threshold = threshold;
    fit.inliers = inliers;
    fit.iterations = found.samples;
    fit.seconds = seconds_since(begin);
    return fit;
}

}  // namespace pcm
